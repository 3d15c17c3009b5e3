"""Overload and soak, as short as shows it; `make overload` and `make soak` have the full length."""

from collections.abc import Callable

import pytest
from robustness import soak as soak_module
from robustness.overload import OverloadResult, clock_set, stopped, too_many_samples
from robustness.soak import soak

CASES: dict[str, Callable[[], OverloadResult]] = {
    "twice what it takes": lambda: too_many_samples(2.0, 1.0),
    "stopped": lambda: stopped(2.0),
    "the host's clock is set": clock_set,
}


@pytest.mark.promise("Samples")
@pytest.mark.parametrize("case", CASES)
def test_what_is_lost_is_counted_and_the_service_goes_on(case: str) -> None:
    """Every lost native sample is counted, at twice the possible rate and while the service is stopped."""
    result = CASES[case]()
    assert result.broken == [], result.text()


@pytest.mark.promise(
    "Memory and the end",
    "memory, descriptors and threads stay constant through reloads, unplugged cables and changing "
    "clients; yaw equals that of the filter alone",
)
def test_a_short_soak_leaves_no_sample_out_and_nothing_behind(monkeypatch: pytest.MonkeyPatch) -> None:
    often = {"RELOAD_EVERY_S": 4, "UNPLUG_EVERY_S": 9, "CLIENT_EVERY_S": 2, "LOOK_EVERY_S": 3, "WARM_S": 9}
    for name, seconds in often.items():
        monkeypatch.setattr(soak_module, name, seconds)
    result = soak(20, float("inf"))
    assert list(result.broken_promises()) == [], result.text()
    assert (result.reloads, result.reconnects, result.device_s) == (5, 2, 20)
    assert result.clients > 5
