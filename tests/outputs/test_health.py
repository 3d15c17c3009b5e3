"""How the service is, in words."""

from dataclasses import replace
from typing import Any

from gyrodrift.outputs.health import Health, HealthLevel, health
from gyrodrift.outputs.status import DeviceStatus, FilterStatus, LinkStatus, OutputStatus, ServiceStatus, aid_text

GOOD = ServiceStatus(link=LinkStatus(port="/dev/ttyUSB0", is_open=True, samples=1000, rate_hz=100.0))


def test_all_is_well() -> None:
    assert health(GOOD) == [Health(HealthLevel.GOOD, "Link OK: no samples lost or damaged.")]


def test_the_worst_is_told_first_and_everything_is_told() -> None:
    """Counted in words a person uses."""
    link = replace(GOOD.link, damaged=1, gaps=1, missing=3, reconnects=1, gone_s=2.5, jitter_ms=31.0)
    outputs = (OutputStatus("tcp", problem="port 127.0.0.1:7117 is used by nc (process 7)"),)
    statement = health(replace(GOOD, link=link, outputs=outputs, device=DeviceStatus(sample_rate_hz=50.0)))
    assert [item.says for item in statement] == [
        "The output tcp is not open: port 127.0.0.1:7117 is used by nc (process 7).",
        "Damaged: 1 frame.",
        "Lost: 3 samples in 1 gap.",
        "The port was reconnected once, after 2.5 s in total.",
        "Samples arrive unevenly, by up to 31 ms.",
        "The rate is 100.0 Hz; the device states 50 Hz.",
    ]
    assert statement[0].level is HealthLevel.BAD


def test_a_second_source_that_contradicts_is_told() -> None:
    aids: dict[str, dict[str, Any]] = {
        "course": {"age_s": 1.0, "weight": 0.0, "differs": "it differs by 23 deg"},
        "speed": {"age_s": 0.2, "weight": 1.0, "differs": None},
    }
    (statement,) = health(replace(GOOD, filter=FilterStatus(aids=aids)))
    assert statement.level is HealthLevel.NOTE
    assert statement.says == "The second source course contradicts the gyro and is left out: it differs by 23 deg."
    assert [aid_text(aid) for aid in aids.values()] == ["left out", "0.2 s ago, 100% agree"]


def test_a_link_that_says_nothing_is_bad() -> None:
    """A port that is gone, or a device that is silent."""
    gone = health(replace(GOOD, link=replace(GOOD.link, is_open=False)))
    silent = health(replace(GOOD, link=replace(GOOD.link, silent_s=12.0)))
    assert gone[0] == Health(HealthLevel.BAD, "The port /dev/ttyUSB0 is gone; the service waits for it.")
    assert silent[0] == Health(HealthLevel.BAD, "No sample for 12 s.")
