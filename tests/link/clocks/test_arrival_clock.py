"""Times for a device without a clock: along the line through arrivals, whatever the link does to them."""

from itertools import pairwise
from random import Random

import pytest

from gyrodrift.link.clocks.arrival import ArrivalClock
from gyrodrift.link.clocks.clock import ArrivalFit, SampleGap
from gyrodrift.values.sample import Reading, Sample

READING = Reading(None, None, 0.0)


def batches(period_s: float, seconds: float, batch_s: float, jitter_s: float, seed: int = 0) -> list[tuple[float, int]]:
    """(arrival, samples that come with it): every `batch_s`, late by up to `jitter_s`."""
    random, out, sent = Random(seed), [], 0
    for number in range(1, int(seconds / batch_s) + 1):
        due = int(number * batch_s / period_s + 1e-9) - sent
        sent += due
        if due:
            out.append((100.0 + number * batch_s + random.uniform(0.0, jitter_s), due))
    return out


def stamped(clock: ArrivalClock, arrivals: list[tuple[float, int]]) -> list[Sample]:
    return [sample for arrival_s, count in arrivals for sample in clock.stamp([READING] * count, arrival_s)]


@pytest.mark.parametrize(("batch_s", "jitter_s"), [(0.005, 0.0), (0.005, 0.003), (0.016, 0.004), (0.1, 0.01)])
def test_bunched_and_jittering_arrivals_give_evenly_spaced_times(batch_s: float, jitter_s: float) -> None:
    samples = stamped(ArrivalClock(0.0), batches(0.005, 60.0, batch_s, jitter_s))
    steps = [b.t_device_s - a.t_device_s for a, b in pairwise(samples)]
    late = steps[len(steps) // 2 :]
    assert min(steps) > 0.0
    assert max(late) == pytest.approx(0.005, rel=0.02)
    assert min(late) == pytest.approx(0.005, rel=0.02)
    assert sum(late) / len(late) == pytest.approx(0.005, rel=0.001)


def test_nothing_is_lost_while_the_line_is_being_found() -> None:
    """The first samples are held, then given."""
    arrivals = batches(0.005, 3.0, 0.01, 0.002)
    samples = stamped(ArrivalClock(0.0), arrivals)
    assert len(samples) == sum(count for _, count in arrivals)
    assert [sample.seq for sample in samples] == list(range(len(samples)))


def test_a_slow_device_is_not_held_for_long() -> None:
    clock = ArrivalClock(0.0)
    samples = stamped(clock, [(100.0 + i, 1) for i in range(6)])
    assert len(samples) == 6
    assert samples[-1].t_device_s == pytest.approx(5.0, abs=0.05)


def test_a_stall_that_ends_in_a_burst_is_no_gap() -> None:
    """The samples come, only late, and keep their times."""
    clock = ArrivalClock(0.0)
    stamped(clock, batches(0.005, 20.0, 0.01, 0.001))
    late = clock.stamp([READING] * 400, 122.0)
    assert clock.events == []
    assert late[-1].t_device_s - late[0].t_device_s == pytest.approx(399 * 0.005, rel=0.01)


def test_a_stall_that_is_made_up_for_in_several_reads_is_no_gap() -> None:
    """A first read that brings more than half of what is still due says that the rest is on its way."""
    clock = ArrivalClock(0.0)
    stamped(clock, batches(0.005, 20.0, 0.01, 0.001))
    late = clock.stamp([READING] * 160, 122.0) + clock.stamp([READING] * 240, 122.01)
    assert clock.events == []
    assert late[-1].seq - late[0].seq == 399


def test_late_arrivals_now_and_then_do_not_end_the_line() -> None:
    fit = ArrivalFit()
    for index in range(2000):
        is_late = index > 200 and index % 10 == 0
        fit.add(index * 0.01, 100.0 + index * 0.01 + (0.2 if is_late else 0.0))
    assert fit.is_warm
    assert fit.slope == pytest.approx(1.0, abs=1e-9)
    assert fit.arrival_s(0.0) == pytest.approx(100.0, abs=1e-6)


def test_silence_without_a_burst_is_a_gap_of_its_true_length() -> None:
    """Samples that were lost leave a hole in number and time."""
    clock = ArrivalClock(0.0)
    before = stamped(clock, batches(0.005, 20.0, 0.01, 0.0))[-1]
    (after,) = clock.stamp([READING], 120.0 + 3.005)
    (gap,) = clock.events
    assert isinstance(gap, SampleGap)
    assert gap.missing == pytest.approx(600, abs=3)
    assert after.t_device_s - before.t_device_s == pytest.approx(3.005, abs=0.02)
    assert after.seq - before.seq == gap.missing + 1


def test_time_never_goes_back_whatever_arrives() -> None:
    random, clock, now_s = Random(4), ArrivalClock(0.0), 100.0
    samples = []
    for _ in range(5000):
        now_s += random.choice([0.0, 0.001, 0.01, 0.01, 0.5])
        samples += clock.stamp([READING] * random.randint(0, 7), now_s)
    assert all(b.t_device_s > a.t_device_s for a, b in pairwise(samples))
