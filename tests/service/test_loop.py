"""The loop in this process: what it logs, and when it ends."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
import structlog
from support import never, speaking_on

from gyrodrift.link.events import LinkEvents
from gyrodrift.link.link import Link
from gyrodrift.link.options import LinkOptions
from gyrodrift.service import loop
from gyrodrift.service.listener import Sink
from gyrodrift.service.loop import Service
from gyrodrift.service.pipeline import Pipeline
from gyrodrift.service.signals import StopSignal
from gyrodrift.service.stdout import JsonLines
from gyrodrift.values.sample import Corrected


class StopAfter:
    """A sink that asks the service to stop when it has had enough."""

    def __init__(self, stop: StopSignal, count: int) -> None:
        self.stop, self.left = stop, count
        self.closed = False

    def take(self, samples: list[Corrected]) -> None:
        self.left -= len(samples)
        self.stop.is_set = self.left <= 0

    def tick(self, now_s: float) -> None:
        pass

    @property
    def is_wanted(self) -> bool:
        return True

    def stats(self) -> dict[str, Any]:
        return {"left": self.left}

    def wakes(self) -> Mapping[int, int]:
        return {}

    def finish(self) -> None:
        pass

    def close(self) -> None:
        self.closed = True


def test_link_stats_say_all_that_helps_from_afar(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, logged: list[Any]
) -> None:
    """Every ten seconds; here with each turn of the loop."""
    monkeypatch.setattr(loop, "STATS_S", 0.0)
    monkeypatch.setattr(loop, "TICK_S", 0.0)
    log = structlog.get_logger()
    lines = b"".join(b"%d,0.5\n" % (i * 10_000) for i in range(100))
    with speaking_on(tmp_path / "gyro") as device, StopSignal() as stop, Path("/dev/null").open("wb") as null:
        counted = StopAfter(stop, 100)
        link = Link(LinkOptions(str(tmp_path / "gyro")), LinkEvents(log))
        device.send_all(lines, never)
        sinks: list[Sink] = [JsonLines(null.fileno()), counted]
        pipeline = Pipeline(link, sinks, log)
        Service(link, [pipeline], log, LinkEvents(log), stop, sinks).run()
    stats = [event for event in logged if event["event"] == "link_stats"]
    assert stats
    assert set(stats[-1]) >= {
        "rate_hz",
        "samples",
        "bytes",
        "damaged",
        "gaps",
        "missing",
        "rejected",
        "reconnects",
        "clock_ppm",
        "lines_dropped",
    }
    assert (logged[-1]["event"], logged[-1]["samples"], logged[-1]["bytes"]) == ("service_end", 100, len(lines))
    assert counted.closed


def test_a_device_that_falls_silent_is_told_once_and_once_more_when_it_speaks(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, logged: list[Any]
) -> None:
    log = structlog.get_logger()
    with speaking_on(tmp_path / "gyro"), StopSignal() as stop:
        link = Link(LinkOptions(str(tmp_path / "gyro")), LinkEvents(log))
        service = Service(link, [], log, LinkEvents(log), stop)
        link.counters.samples = 1
        for silent_s in (0.1, 6.0, 7.0, 8.0, 0.1, 0.2, 9.0):
            monkeypatch.setattr(link, "silent_s", lambda silent_s=silent_s: silent_s)
            service._notice_silence()
        link.close()
    report = [event["event"] for event in logged if event["event"] in {"link_silent", "link_speaks"}]
    assert report == ["link_silent", "link_speaks", "link_silent"]


def test_gaps_that_follow_closely_are_one_line(logged: list[Any]) -> None:
    """The first at once, then at most one line a second, with nothing left out of the sum."""
    now = [100.0]
    events = LinkEvents(structlog.get_logger(), lambda: now[0])
    for missing in range(1, 11):
        events("gap", missing=missing, seconds=0.01 * missing)
        now[0] += 0.05
    now[0] += 1.0
    events.report_pending()
    gaps = [(event["holes"], event["missing"], event["longest_s"]) for event in logged]
    assert gaps == [(1, 1, 0.01), (9, 54, 0.1)]
    events.report_pending()
    assert len(logged) == 2


@pytest.mark.promise("Memory and the end")
def test_a_device_that_boots_over_and_over_fills_no_log(logged: list[Any]) -> None:
    """A device that reboots again and again writes one log line a second."""
    now = [0.0]
    events = LinkEvents(structlog.get_logger(), lambda: now[0])
    heard: list[str] = []
    events.listeners.append(lambda event, _: heard.append(event))
    for number in range(300):
        events("device_reset", clock_step_s=-float(number), gone_s=0.0)
        now[0] += 0.01
    now[0] += 1.0
    events.report_pending()
    events.report_pending()
    report = [entry for entry in logged if entry["event"] == "device_reset"]
    assert report[0] == {"event": "device_reset", "log_level": "warning", "clock_step_s": 0.0, "gone_s": 0.0}
    assert sum(entry.get("times", 1) for entry in report) == 300
    assert len(report) == len(heard) == 4
    assert report[-1]["clock_step_s"] == -299.0
