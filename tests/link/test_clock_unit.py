"""A device clock that counts something else than microseconds: refused in its first seconds, with what to do."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from support import speaking_on

from gyrodrift.link.link import Link
from gyrodrift.link.options import LinkOptions
from gyrodrift.values.errors import UnitError
from gyrodrift.values.sample import Sample


def heard(
    port: Path,
    line: Callable[[int], str],
    count: int = 400,
    on_event: Callable[..., None] = lambda *_, **__: None,
    pause_s: float = 0.0,
    **options: Any,
) -> list[Sample]:
    """Samples of so many lines, 10 ms apart by the host's clock, with a pause after every ten."""
    now_s, samples = 1000.0, []
    with speaking_on(port) as device:
        link = Link(LinkOptions(str(port), **options), on_event, lambda: now_s)
        try:
            for i in range(count):
                device.send(line(i).encode() + b"\n")
                now_s += 0.01 + pause_s * (i % 10 == 9)
                samples += link.read()
        finally:
            link.close()
    return samples


@pytest.mark.parametrize(
    ("line", "message"),
    [
        (
            lambda i: f"{10 * i},0.{i % 7},{i / 10},25.1",
            "the first column counts milliseconds, not microseconds.*--columns 't_ms, rate:dps, encoder, temp'",
        ),
        (lambda i: f"{i},0.{i % 7}", "does not count microseconds: 1 s of it takes 1e.04 s.*with --columns"),
        (lambda i: f"{10_000_000 * i},0.{i % 7}", "does not count microseconds.*with --columns"),
    ],
    ids=["ms", "counter", "ns"],
)
def test_a_csv_clock_of_another_unit_is_refused_with_the_columns_to_give(
    port: Path, line: Callable[[int], str], message: str
) -> None:
    with pytest.raises(UnitError, match=rf"{port}: .*{message}"):
        heard(port, line)


@pytest.mark.parametrize(
    ("columns", "step"), [("t_ms,rate", 10), ("t_s,rate", 0.01), ("t_us,rate", 10_000), ("seq,rate", 1)]
)
def test_the_columns_scale_it(port: Path, columns: str, step: float) -> None:
    samples = heard(port, lambda i: f"{step * i:g},{i % 7}", columns=columns)
    assert len(samples) == 400
    assert samples[-1].t_device_s - samples[0].t_device_s == pytest.approx(3.99, abs=0.02)


def test_columns_that_name_the_wrong_unit_are_told(port: Path) -> None:
    with pytest.raises(
        UnitError, match="the clock of --columns counts milliseconds, not microseconds: write t_ms instead of t_us"
    ):
        heard(port, lambda i: f"{10 * i},0.{i % 7}", columns="t_us, rate")


@pytest.mark.parametrize("step_us", [2_500, 6_000])
def test_a_csv_clock_that_stays_slow_is_asked(port: Path, step_us: int) -> None:
    """A timer of another clock: its ticks are read as they arrive. A slow replay is stated."""
    message = rf"the clock counts .* s in each second .*--columns 't:lsb/{100 * step_us}, rate:dps'.*--protocol csv"
    with pytest.raises(UnitError, match=message):
        heard(port, lambda i: f"{step_us * i},0.{i % 7}", 800)
    assert len(heard(port, lambda i: f"{step_us * i},0.{i % 7}", 800, protocol="csv")) == 800


def test_a_device_that_sends_now_and_then_has_no_slow_clock(port: Path) -> None:
    """Ten lines, a pause, ten lines: what the clock does in a pause is unknown."""
    assert len(heard(port, lambda i: f"{10_000 * i},0.{i % 7}", 200, pause_s=1.5)) == 200


def test_a_csv_clock_that_stays_fast_is_said(port: Path) -> None:
    events: list[dict[str, Any]] = []
    heard(port, lambda i: f"{30_000 * i},0.{i % 7}", 800, on_event=lambda _, **fields: events.append(fields))
    assert "--columns 't:lsb/3000000, rate:dps'" in next(fields["hint"] for fields in events if "reason" in fields)


@pytest.mark.parametrize("host_per_device", [0.05, 0.2, 1.0, 1.02, 5.0])
def test_a_clock_that_is_only_fast_or_slow_is_none_of_another_unit(port: Path, host_per_device: float) -> None:
    """A replay runs at any speed, and a bad crystal is still a crystal."""
    assert heard(port, lambda i: f"{round(10_000 / host_per_device) * i},0.{i % 7}") != []
