"""The device clock: unwrapped, its holes measured, its restarts told from its glitches."""

from math import isnan, nan

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support import near

from gyrodrift.link.clocks.clock import ClockRestart, SampleGap
from gyrodrift.link.clocks.device import DeviceClock
from gyrodrift.values.sample import Reading, Sample

WRAP = 1 << 32
PERIOD_US = 10_000


class Bench:
    """A device that is read every sample, with a host clock that the test sets."""

    def __init__(self, *, start_us: int = 0, has_counter: bool = True, now_s: float = 1000.0) -> None:
        self.clock = DeviceClock(epoch_s=0.0)
        self.ticks_us, self.count, self.now_s = start_us, 0, now_s
        self.has_counter = has_counter

    def read(self, samples: int = 1, *, step_us: int = PERIOD_US, host_s: float | None = None) -> list[Sample]:
        out = []
        for _ in range(samples):
            reading = Reading(self.ticks_us % WRAP, self.count % 65536 if self.has_counter else None, 0.0)
            out += self.clock.stamp([reading], self.now_s)
            self.ticks_us += step_us
            self.count += 1
            self.now_s += step_us * 1e-6 if host_s is None else host_s
        return out

    def skip(self, samples: int, *, host_s: float | None = None) -> None:
        self.ticks_us += samples * PERIOD_US
        self.count += samples
        self.now_s += samples * PERIOD_US * 1e-6 if host_s is None else host_s

    def events(self) -> list[object]:
        result, self.clock.events = list(self.clock.events), []
        return list(result)


def test_time_and_counter_are_unwrapped() -> None:
    """Across the 71.6 minutes of 32 bits and the 65536 samples of 16."""
    bench = Bench(start_us=WRAP - 500 * PERIOD_US)
    bench.count = 65536 - 300
    samples = bench.read(1000)
    assert [s.t_device_s for s in samples] == [(WRAP - 500 * PERIOD_US + i * PERIOD_US) / 1e6 for i in range(1000)]
    assert [s.seq for s in samples] == list(range(65236, 66236))
    assert bench.events() == []


@pytest.mark.parametrize("has_counter", [True, False])
@given(st.integers(1, 5000), st.integers(10, 60))
def test_a_hole_is_measured_and_time_stays_true(has_counter: bool, missing: int, before: int) -> None:  # noqa: FBT001
    bench = Bench(has_counter=has_counter)
    bench.read(before)
    bench.skip(missing)
    sample, *_ = bench.read(2)
    assert bench.events() == [SampleGap(missing, near((missing + 1) * 0.01))]
    assert sample.t_device_s == pytest.approx((before + missing) * 0.01)
    assert sample.seq == before + missing


def test_a_hole_longer_than_the_counter_is_counted_by_the_clock() -> None:
    """Twenty minutes at 100 Hz are more than 16 bits."""
    bench = Bench()
    bench.read(200)
    bench.skip(120_000)
    bench.read(2)
    assert bench.events() == [SampleGap(120_000, near(1200.01))]


@pytest.mark.promise("Samples")
@pytest.mark.parametrize("host_s", [None, 1e-5], ids=["in real time", "in a fast replay"])
@pytest.mark.parametrize("off_us", [-3_000_000, 0, 3_000_000])
@pytest.mark.parametrize("wraps", [1, 2, 3])
def test_one_wild_time_near_a_wrap_of_the_counter_is_a_glitch(wraps: int, off_us: int, host_s: float | None) -> None:
    """One wrong device time is a glitch; a gap has the length on which device clock and host clock agree."""
    bench = Bench()
    bench.read(300, host_s=host_s)
    outlying = Reading((bench.ticks_us + wraps * 65536 * PERIOD_US + off_us) % WRAP, 300, 5.0)
    assert bench.clock.stamp([outlying], bench.now_s) == []
    bench.skip(1, host_s=host_s)
    assert [s.t_device_s for s in bench.read(3, host_s=host_s)] == pytest.approx([3.01, 3.02, 3.03])
    assert bench.clock.glitches == 1
    assert bench.events() == [SampleGap(1, near(0.02))]


def test_a_clock_that_steps_by_a_wrap_of_the_counter_is_a_restart_where_the_host_saw_no_such_time() -> None:
    """A counter that goes on by one, and a clock that went on by minutes."""
    bench = Bench()
    last = bench.read(300)[-1]
    bench.ticks_us += 65536 * PERIOD_US
    assert bench.read(3)[-1].t_device_s == near(last.t_device_s + 0.03)
    assert [type(event) for event in bench.events()] == [ClockRestart]


def test_a_fast_replay_with_a_hole_keeps_the_true_time() -> None:
    bench = Bench(has_counter=False)
    for _ in range(300):
        bench.read(host_s=1e-5)
    bench.skip(1000, host_s=1e-5)
    sample, _ = bench.read(2, host_s=1e-5)
    assert sample.t_device_s == pytest.approx(13.0)
    assert len(bench.events()) == 1


@pytest.mark.parametrize("old_us", [50_000_000, WRAP - 60_000_000])
@pytest.mark.parametrize("has_counter", [True, False])
def test_a_reset_goes_on_one_period_after_the_last_sample(old_us: int, has_counter: bool) -> None:  # noqa: FBT001
    bench = Bench(start_us=old_us, has_counter=has_counter)
    last = bench.read(300)[-1]
    bench.ticks_us, bench.count = 0, 0
    bench.now_s += 2.5
    after = bench.read(50)
    assert [s.t_device_s for s in after] == pytest.approx([last.t_device_s + 0.01 * (i + 1) for i in range(50)])
    assert [s.seq for s in after] == [last.seq + 1 + i for i in range(50)]
    (event,) = bench.events()
    assert isinstance(event, ClockRestart)
    assert event.silent_s == pytest.approx(2.5, abs=0.05)


def test_a_clock_step_forward_that_the_host_did_not_see_is_a_restart() -> None:
    """A sample cannot arrive before it was taken."""
    bench = Bench(has_counter=False)
    last = bench.read(300)[-1]
    bench.ticks_us += 30_000_000
    after = bench.read(3)
    assert after[-1].t_device_s - last.t_device_s == pytest.approx(0.03)
    assert isinstance(bench.events()[0], ClockRestart)


@pytest.mark.parametrize("has_counter", [True, False])
def test_right_after_a_restart_the_host_is_a_witness_still(has_counter: bool) -> None:  # noqa: FBT001
    """A clock that leaps to and fro, as where digits are doubled, makes no hole out of time that never was."""
    bench = Bench(has_counter=has_counter)
    last = bench.read(300)[-1]
    for leap_us in (60_000_000, -60_000_000, 65_000_000, -65_000_000, 70_000_000):
        bench.ticks_us += leap_us
        bench.read(4)
    after = bench.read(5)[-1]
    assert after.t_device_s - last.t_device_s == pytest.approx(0.25)
    assert {type(event) for event in bench.events()} == {ClockRestart}


def test_a_single_wild_time_is_a_glitch() -> None:
    """Dropped, and time goes on as if it had not been."""
    bench = Bench()
    bench.read(300)
    outlying = Reading(3_000_000_000, 300, 0.0)
    assert bench.clock.stamp([outlying], bench.now_s) == []
    bench.skip(1)
    samples = bench.read(5)
    assert [s.t_device_s for s in samples] == pytest.approx([3.01 + 0.01 * i for i in range(5)])
    assert bench.clock.glitches == 1


def test_times_that_repeat_or_go_back_a_little_are_left_to_the_filter() -> None:
    bench = Bench()
    bench.read(100)
    repeated = Reading(bench.ticks_us - PERIOD_US, 99, 0.0)
    earlier = Reading(bench.ticks_us - 3 * PERIOD_US, 97, 0.0)
    times = [s.t_device_s for s in bench.clock.stamp([repeated, earlier], bench.now_s)]
    assert times == pytest.approx([0.99, 0.97])
    assert bench.read()[0].t_device_s == pytest.approx(1.0)
    assert bench.events() == []


def test_after_an_outage_a_clock_that_ran_on_keeps_its_true_time() -> None:
    """The cable was pulled, the device was not."""
    bench = Bench()
    bench.read(500)
    bench.clock.reconnected()
    bench.skip(6000)
    sample, _ = bench.read(2)
    assert sample.t_device_s == pytest.approx(65.0)
    assert bench.events() == [SampleGap(6000, near(60.01))]


@pytest.mark.parametrize("has_counter", [True, False])
@pytest.mark.parametrize("step_us", [-900_000, -300_000, 900_000])
def test_a_step_of_less_than_a_second_is_told_from_time_that_passed(has_counter: bool, step_us: int) -> None:  # noqa: FBT001
    """The counter, or the host clock, knows that there was no such time."""
    bench = Bench(has_counter=has_counter)
    last = bench.read(300)[-1]
    bench.ticks_us += step_us
    after = bench.read(20)
    assert [s.t_device_s for s in after] == pytest.approx([last.t_device_s + 0.01 * (i + 1) for i in range(20)])
    assert [type(event) for event in bench.events()] == [ClockRestart]


def test_a_fast_replay_believes_the_counter_and_not_a_clock_that_jumped() -> None:
    bench = Bench()
    for _ in range(300):
        bench.read(host_s=1e-5)
    bench.ticks_us += 30_000_000
    after = bench.read(5, host_s=1e-5)
    assert after[-1].t_device_s == pytest.approx(3.04)
    assert [type(event) for event in bench.events()] == [ClockRestart]


@pytest.mark.parametrize("wild_us", [-500_000, 400_000, 40_000_000])
def test_one_damaged_time_without_a_counter_is_a_glitch(wild_us: int) -> None:
    bench = Bench(has_counter=False)
    bench.read(300)
    assert bench.clock.stamp([Reading(bench.ticks_us + wild_us, None, 0.0)], bench.now_s) == []
    bench.skip(1)
    assert bench.read(5)[0].t_device_s == pytest.approx(3.01)
    assert bench.clock.glitches == 1


@given(st.lists(st.integers(2_000, 60_000), min_size=5, max_size=200))
def test_irregular_times_lose_nothing_but_perhaps_the_last(steps_us: list[int]) -> None:
    bench = Bench(has_counter=False)
    samples = [sample for step_us in steps_us for sample in bench.read(step_us=step_us, host_s=1e-5)]
    times_us = [sum(steps_us[:i]) for i in range(len(steps_us))]
    got_us = [round(sample.t_device_s * 1e6) for sample in samples]
    assert got_us == times_us[: len(got_us)]
    assert len(got_us) >= len(times_us) - 1


def test_after_an_outage_a_clock_that_began_anew_is_not_taken_for_a_hole() -> None:
    bench = Bench()
    last = bench.read(500)[-1]
    bench.clock.reconnected()
    bench.ticks_us, bench.count = 8_000_000, 800
    bench.now_s += 60.0
    samples = bench.read(5)
    assert samples[0].t_device_s == pytest.approx(last.t_device_s + 0.01)
    assert [type(event) for event in bench.events()] == [ClockRestart]


def test_a_stall_that_ends_in_a_burst_moves_nothing() -> None:
    bench = Bench()
    bench.read(300)
    bench.now_s += 4.0
    late = bench.read(400, host_s=0.0)
    assert late[-1].t_device_s == pytest.approx(6.99)
    assert bench.read(50)[-1].t_device_s == pytest.approx(7.49)
    assert bench.events() == []


@pytest.mark.parametrize("ppm", [-8000.0, -50.0, 0.0, 50.0, 8000.0])
def test_the_drift_of_the_device_clock_is_measured(ppm: float) -> None:
    bench = Bench()
    for _ in range(3000):
        bench.read(host_s=0.01 / (1.0 + ppm * 1e-6))
    assert bench.clock.drift_ppm == pytest.approx(ppm, abs=1.0)
    assert bench.clock.period_s == pytest.approx(0.01)


@pytest.mark.promise("Samples")
def test_a_device_that_is_set_to_another_rate_loses_nothing_though_frames_do() -> None:
    """A device that changes its sample rate loses no sample, even with damaged frames."""
    bench = Bench()
    bench.read(100)
    heard = [bench.read(step_us=500_000)]
    for lost in (0, 0, 1, 3, 0, 7, 0):
        bench.ticks_us += lost * 500_000
        bench.count += lost
        bench.now_s += lost * 0.5
        heard.append(bench.read(step_us=500_000))
    samples = [sample for some in heard for sample in some]
    assert [sample.seq for sample in samples] == [100, 101, 102, 104, 108, 109, 117, 118]
    assert samples[-1].t_device_s - samples[0].t_device_s == pytest.approx(9.0)
    assert bench.clock.glitches == 0


def test_a_step_at_the_pace_of_the_one_before_needs_no_second_reading() -> None:
    bench = Bench()
    bench.read(100)
    assert [len(bench.read(step_us=500_000)) for _ in range(5)] == [1, 0, 2, 1, 1]


def test_a_rate_that_changes_while_frames_are_lost_costs_no_sample() -> None:
    """The first two that are heard are seconds apart, in step with the counter."""
    bench = Bench()
    bench.read(100)
    samples = bench.read(step_us=2_000_000)
    bench.count += 3
    samples += bench.read(step_us=4_000_000)
    bench.count += 7
    samples += bench.read(step_us=500_000)
    assert [sample.seq for sample in samples] == [100, 104, 112]


def test_a_step_of_which_a_part_is_at_the_old_rate_costs_no_sample() -> None:
    """The first sample of the slow rate is lost, and two behind the second one too."""
    bench = Bench()
    bench.read(100)
    bench.skip(1)
    bench.ticks_us += 490_000
    samples = bench.read(step_us=1_500_000)
    bench.count += 2
    samples += bench.read(3, step_us=500_000)
    assert [sample.seq for sample in samples] == [101, 104, 105, 106]
    assert bench.clock.glitches == 0


def test_a_device_that_loses_samples_from_its_first_one_on_has_a_period() -> None:
    bench = Bench()
    for _ in range(20):
        bench.read()
        bench.skip(2)
    assert bench.clock.period_s == pytest.approx(PERIOD_US * 1e-6)
    assert [event.missing for event in bench.events() if isinstance(event, SampleGap)] == [2] * 19


def test_a_sample_rate_that_halves_is_no_run_of_gaps() -> None:
    """Without a counter some steps show it; a real gap afterwards is told."""
    bench = Bench(has_counter=False)
    bench.read(100)
    bench.read(200, step_us=2 * PERIOD_US)
    assert len(bench.events()) < 5
    bench.ticks_us += 5 * PERIOD_US
    bench.now_s += 5 * PERIOD_US * 1e-6
    bench.read(5, step_us=2 * PERIOD_US)
    assert [type(event) for event in bench.events()] == [SampleGap]


@pytest.mark.parametrize("has_counter", [True, False])
def test_an_angle_since_the_last_sample_is_a_rate_and_lost_samples_do_not_lower_it(has_counter: bool) -> None:  # noqa: FBT001
    clock, rates_dps = DeviceClock(epoch_s=0.0), []
    for count in [*range(100), *range(200, 300)]:
        reading = Reading(count * PERIOD_US, count if has_counter else None, nan, delta_deg=0.5)
        rates_dps += [sample.rate_dps for sample in clock.stamp([reading], count * PERIOD_US * 1e-6)]
    assert isnan(rates_dps[0])
    assert rates_dps[1:] == pytest.approx([50.0] * 199)
