"""Ending a recording after some seconds of device time."""

from dataclasses import dataclass, field
from typing import Any, cast

import pytest

from gyrodrift.recording.duration import GRACE_S, Duration
from gyrodrift.recording.recorder import Recorder
from gyrodrift.values.sample import Sample


@dataclass
class Stop:
    is_set: bool = False


@dataclass
class Recorded:
    """Stands for a recorder: keeps the times it is handed; a signal may come while it does."""

    stop: Stop
    signal_comes: bool = False
    times_s: list[float] = field(default_factory=list)
    ticks_s: list[float] = field(default_factory=list)

    def take(self, samples: list[Sample]) -> None:
        self.times_s += [sample.t_device_s for sample in samples]
        self.stop.is_set = self.stop.is_set or self.signal_comes

    def tick(self, now_s: float) -> None:
        self.ticks_s.append(now_s)
        self.stop.is_set = self.stop.is_set or self.signal_comes

    def stats(self) -> dict[str, Any]:
        return {"recorded": len(self.times_s)}

    def close(self) -> None:
        self.times_s.append(-1.0)


class Clock:
    """The clock of the host, set by hand."""

    now_s = 1000.0

    def __call__(self) -> float:
        return self.now_s


@pytest.fixture
def stop() -> Stop:
    return Stop()


@pytest.fixture
def recorded(stop: Stop) -> Recorded:
    return Recorded(stop)


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def duration(recorded: Recorded, stop: Stop, clock: Clock) -> Duration:
    return Duration(cast("Recorder", recorded), 2.0, stop, clock)


def index(*times_s: float) -> list[Sample]:
    return [Sample(0, t_s, 1.7e9, 0.0) for t_s in times_s]


def test_samples_before_the_end_are_recorded_and_the_first_behind_it_ends_it(
    duration: Duration, recorded: Recorded, stop: Stop
) -> None:
    """Counted from the first sample, whatever the device clock said then."""
    duration.take(index(500.0, 501.0))
    duration.take(index(501.75))
    assert not stop.is_set
    duration.take(index(501.99, 502.0, 502.25))
    assert recorded.times_s == [500.0, 501.0, 501.75, 501.99]
    assert stop.is_set


def test_nothing_is_recorded_behind_the_end(duration: Duration, recorded: Recorded) -> None:
    """A last read may still come in."""
    duration.take(index(0.0, 5.0))
    duration.take(index(1.0))
    assert recorded.times_s == [0.0]


@pytest.mark.parametrize("last_s", [0.5, 1.0])
def test_a_silent_device_ends_it_when_its_time_is_over(
    duration: Duration, stop: Stop, clock: Clock, last_s: float
) -> None:
    duration.take(index(0.0))
    clock.now_s += last_s
    duration.take(index(last_s))
    duration.tick(1001.99)
    assert not stop.is_set
    duration.tick(1000.0 + max(2.0, last_s + GRACE_S))
    assert stop.is_set


def test_a_slow_device_clock_has_its_time(duration: Duration, stop: Stop, clock: Clock) -> None:
    for second in range(20):
        clock.now_s = 1000.0 + 0.9 * second
        duration.take(index(0.05 * second))
        duration.tick(clock.now_s + 0.5)
        assert not stop.is_set


def test_waiting_for_the_first_sample_does_not_count(duration: Duration, recorded: Recorded, stop: Stop) -> None:
    """Ticks are handed on all the same."""
    duration.take([])
    duration.tick(9000.0)
    assert recorded.ticks_s == [9000.0]
    assert not stop.is_set


def test_a_signal_that_comes_while_samples_are_taken_is_kept(
    duration: Duration, recorded: Recorded, stop: Stop
) -> None:
    """The end of the time only ever sets what a signal sets."""
    recorded.signal_comes = True
    duration.take(index(0.0))
    assert stop.is_set


def test_samples_that_were_read_with_a_signal_are_recorded(duration: Duration, recorded: Recorded, stop: Stop) -> None:
    duration.take(index(0.0))
    stop.is_set = True
    duration.take(index(0.5, 1.0, 2.0))
    assert recorded.times_s == [0.0, 0.5, 1.0]


def test_a_signal_that_comes_during_a_tick_is_kept(duration: Duration, recorded: Recorded, stop: Stop) -> None:
    duration.take(index(0.0))
    recorded.signal_comes = True
    duration.tick(1001.5)
    assert stop.is_set


def test_the_rest_is_the_recorders(duration: Duration, recorded: Recorded) -> None:
    """Fields for the log, and the end."""
    assert duration.stats() == {"recorded": 0}
    duration.close()
    assert recorded.times_s == [-1.0]
