"""`gyrodrift serve` on a simulated device whose link goes wrong: what a person sees in the lines and in the log."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from support import PATIENCE_S, Command, near

PERIOD_S = 0.01
PACE = {"native": "max", "csv": "max", "witmotion": "2"}
"""A device without a clock is timed by its arrivals. A stream that is read in one piece has none, so it lasts longer
than a busy machine keeps the service from reading."""


@pytest.fixture
def link(tmp_path: Path) -> Path:
    return tmp_path / "gyro"


@dataclass(frozen=True)
class Account:
    """Every line of stdout, the events of the log, and the counters at the end."""

    lines: list[dict[str, Any]]
    events: list[dict[str, Any]]
    stats: dict[str, Any]

    def named(self, event: str) -> list[dict[str, Any]]:
        return [entry for entry in self.events if entry["event"] == event]


@contextmanager
def served(
    link: Path, *faults: str, options: tuple[str, ...], baud: str = "115200"
) -> Iterator[tuple[Command, Command]]:
    """A service on a device that powers on when the service has opened its port."""
    faulty = [word for fault in faults for word in ("--fault", fault)]
    with Command("--link", link, "--wait", *options, *faulty, module="tests.patient_device") as device:
        device.until(lambda _: link.is_symlink(), "link")
        with Command("serve", "--port", link, "--baud", baud, "--filter", "hdr", "--log-format", "json") as serve:
            yield serve, device


def story_of(serve: Command) -> Account:
    assert serve.stop() == 0
    assert "Traceback" not in serve.log
    events = [json.loads(line) for line in serve.log.splitlines()]
    return Account(serve.all_lines(), events, events[-1])


def story(link: Path, *faults: str, seconds: int, speed: str = "max", protocol: str = "native") -> Account:
    """A device that plays so many seconds of its own time, to the last sample."""
    options = ("--speed", speed, "--protocol", protocol, "--duration", str(seconds))
    with served(link, *faults, options=options) as (serve, device):
        serve.until(lambda _: device.process.poll() is not None, "end of the device")
        return story_of(serve)


def assert_smooth(lines: list[dict[str, Any]], step_s: float = 0.2) -> None:
    """Time goes forward, and yaw moves no further than the rate takes it."""
    for a, b in pairwise(lines):
        assert 0.0 < b["t_s"] - a["t_s"] < step_s
        fastest_dps = max(abs(a["rate_dps"]), abs(b["rate_dps"])) + 2.0
        assert abs(b["yaw_deg"] - a["yaw_deg"]) < fastest_dps * (b["t_s"] - a["t_s"])


@pytest.mark.parametrize(
    "fault",
    [
        "bit_flips",
        pytest.param("dropped_bytes", marks=pytest.mark.evaluation),
        pytest.param("duplicated_bytes", marks=pytest.mark.evaluation),
    ],
)
def test_damaged_bytes_are_counted_and_yaw_does_not_jump(link: Path, fault: str) -> None:
    """The samples around the damage are used, and no other value is."""
    report = story(link, f"{fault}:per_kilobyte=3", seconds=15)
    assert report.stats["damaged"] > 10
    assert report.stats["missing"] > 10
    assert report.stats["rejected"] == 0
    assert report.stats["samples"] + report.stats["missing"] == near(1500, 1)
    assert_smooth(report.lines)


@pytest.mark.parametrize("protocol", ["native", "csv", pytest.param("witmotion", marks=pytest.mark.evaluation)])
def test_broken_frames_end_nothing(link: Path, protocol: str) -> None:
    """Merged and truncated frames and runs of zeros are counted."""
    report = story(
        link, "merged_frames", "truncated_frames", "zeros", seconds=15, speed=PACE[protocol], protocol=protocol
    )
    assert report.stats["damaged"] > 10
    assert 1000 < report.stats["samples"] < 1500
    assert all(b["t_s"] > a["t_s"] for a, b in pairwise(report.lines))


@pytest.mark.parametrize("speed", ["max", pytest.param("5", marks=pytest.mark.evaluation)])
@pytest.mark.parametrize("protocol", ["native", "csv"])
def test_a_reset_is_told_and_yaw_and_time_go_on(link: Path, protocol: str, speed: str) -> None:
    report = story(link, "reset:from_s=5,silent_s=1", seconds=9, speed=speed, protocol=protocol)
    assert (report.stats["device_resets"], report.stats["gaps"], report.stats["samples"]) == (1, 0, 800)
    (reset,) = report.named("device_reset")
    assert reset["clock_step_s"] == near(-4.99, 0.02)
    assert_smooth(report.lines, 1.5 * PERIOD_S)


@pytest.mark.parametrize("speed", ["max", pytest.param("5", marks=pytest.mark.evaluation)])
@pytest.mark.parametrize("power_lost", [1, 0])
def test_a_device_that_was_pulled_comes_back_with_yaw_and_drift_estimate(
    link: Path, power_lost: int, speed: str
) -> None:
    report = story(link, f"unplug:from_s=4,seconds=1.5,power_lost={power_lost}", seconds=9, speed=speed)
    assert report.stats["reconnects"] == 1
    assert report.stats["device_resets"] == power_lost, report.events
    assert [entry["event"] for entry in report.events if entry["event"].startswith("link_")][:3] == [
        "link_open",
        "link_lost",
        "link_restored",
    ]
    assert_smooth(report.lines, PATIENCE_S)
    assert all(b["bias_dps"] == near(a["bias_dps"], 0.01) for a, b in pairwise(report.lines))
    longest_s = max(b["t_s"] - a["t_s"] for a, b in pairwise(report.lines))
    assert (longest_s < 1.5 * PERIOD_S) if power_lost else (longest_s > 1.5)


def test_under_another_name_it_is_waited_for(link: Path) -> None:
    """A name that is gone stays gone; the service is still there."""
    options = ("--speed", "5")
    with served(link, "unplug:from_s=2,seconds=0.5,name=other", options=options) as (serve, _):
        serve.until_log('"link_lost"')
        serve.until(lambda _: link.with_name("gyro-1").is_symlink(), "second name")
        assert not link.is_symlink()
        report = story_of(serve)
    assert report.stats["reconnects"] == 0


@pytest.mark.parametrize("protocol", ["native", pytest.param("csv", marks=pytest.mark.evaluation)])
def test_a_stall_is_no_gap(link: Path, protocol: str) -> None:
    """Late is not lost: every sample is there with its own time."""
    report = story(link, "stall:seconds=2,every_s=4,to_s=8", seconds=9, speed="5", protocol=protocol)
    assert (report.stats["gaps"], report.stats["device_resets"], report.stats["damaged"]) == (0, 0, 0)
    assert [line["seq"] for line in report.lines] == list(range(900))
    assert_smooth(report.lines, 1.5 * PERIOD_S)


@pytest.mark.parametrize("step_s", [30, -30])
def test_a_clock_that_steps_begins_anew(link: Path, step_s: int) -> None:
    report = story(link, f"clock_step:from_s=1.5,step_s={step_s}", seconds=2, speed="1")
    (reset,) = report.named("device_reset")
    assert reset["clock_step_s"] == near(step_s, 0.05)
    assert report.stats["samples"] == near(200, 1)
    assert_smooth(report.lines, 1.5 * PERIOD_S)


def test_twice_the_rate_that_hello_tells_is_integrated_with_its_true_time(link: Path) -> None:
    """The clock counts, not what a device says of itself."""
    report = story(link, "double_rate:from_s=3", seconds=12)
    assert (report.stats["gaps"], report.stats["device_resets"], report.stats["rejected"]) == (0, 0, 0)
    assert {round(b["t_s"] - a["t_s"], 6) for a, b in pairwise(report.lines)} == {0.01, 0.005}
    assert report.lines[-1]["yaw_deg"] == near(report.lines[-1]["encoder_deg"], 6.0)
    assert_smooth(report.lines, 1.5 * PERIOD_S)


def test_a_rate_that_changes_is_integrated_with_its_true_time(link: Path) -> None:
    """Slower, with a counter that tells no hole."""
    report = story(link, "rate_change:from_s=3,divide=4", seconds=9)
    assert (report.stats["gaps"], report.stats["device_resets"], report.stats["rejected"]) == (0, 0, 0)
    assert {round(b["t_s"] - a["t_s"], 6) for a, b in pairwise(report.lines)} == {0.01, 0.04}


@pytest.mark.parametrize("protocol", ["native", "witmotion", pytest.param("csv", marks=pytest.mark.evaluation)])
def test_a_boot_banner_in_the_stream_costs_a_sample_at_most(link: Path, protocol: str) -> None:
    report = story(link, "boot_banner:from_s=3", seconds=6, speed=PACE[protocol], protocol=protocol)
    assert report.stats["damaged"] > 0
    assert report.stats["samples"] >= 599
    assert all(b["t_s"] > a["t_s"] for a, b in pairwise(report.lines))


def test_full_scale_and_stuck_values_are_counted_and_yaw_is_held(link: Path) -> None:
    """A sensor that does not answer is no measurement, whatever it sends for a second."""
    report = story(link, "full_scale:from_s=3,to_s=4", "stuck_value:from_s=5,to_s=6", seconds=7)
    assert report.stats["clipped"] == 100
    assert report.stats["hung_s"] == near(2.0, 0.03)
    assert len(report.named("rate_hangs")) == len(report.named("rate_moves")) == 2
    assert len(report.lines) == near(500, 10)
    assert all(abs(b["yaw_deg"] - a["yaw_deg"]) < 0.5 for a, b in pairwise(report.lines))


@pytest.mark.parametrize("protocol", ["native", "witmotion", pytest.param("csv", marks=pytest.mark.evaluation)])
def test_the_baud_rate_of_the_device_is_found(link: Path, protocol: str) -> None:
    options = ("--speed", "5", "--protocol", protocol)
    with served(link, "wrong_baud:baud=9600", options=options, baud="auto") as (serve, _):
        serve.until_log('"protocol_found"')
        serve.take_lines(100)
        report = story_of(serve)
    (result,) = report.named("protocol_found")
    assert (result["protocol"], result["baud"]) == (protocol, 9600)


def test_many_faults_at_once_are_survived(link: Path) -> None:
    faults = ("bit_flips:per_kilobyte=2", "zeros", "boot_banner", "stall:every_s=3", "reset:from_s=6")
    report = story(link, *faults, seconds=9, speed="5")
    assert report.stats["damaged"] > 5
    assert report.stats["device_resets"] == 1
    assert_smooth(report.lines)
