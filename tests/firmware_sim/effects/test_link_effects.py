"""Clock and link: what stamps, arrivals and the counter tell of ten minutes with the shipped noise."""

import numpy as np
import pytest
from effects_bench import SHIPPED, Record, effect_of, fitted, put_in, record, rig_of, share_bound, sized

from firmware_sim.effects.effect import Effect, Floats, Moments
from firmware_sim.effects.link import TimestampJitter, UsbBatching
from firmware_sim.motion.profile import load_profile

DELAY_S = SHIPPED.host_delay_s


def identified(effect: Effect | None) -> Record:
    return record(rig_of(effect), load_profile("identify"), 594.0)


@sized("clock_drift")
def test_the_drift_is_the_slope_of_the_device_clock_over_the_hosts(effect: Effect | None) -> None:
    run = identified(effect)
    _, slope = fitted(run.t_device_us - 1e6 * run.t_host_s, 1.0, run.t_host_s)
    assert slope == pytest.approx(put_in(effect, "ppm"), abs=0.01)


@sized("timestamp_jitter")
def test_stamps_scatter_about_the_time_of_measurement(effect: Effect | None) -> None:
    """Independently of each other, with their sigma to 2 %, not sooner or later on the whole; off is rounding."""
    run = identified(effect)
    off_ms = (run.t_device_us * 1e-3 - run.t_s * 1e3)[10:]
    assert off_ms.std() == pytest.approx(put_in(effect, "sigma_ms"), rel=0.02, abs=5e-4)
    assert abs(off_ms.mean()) < 5.0 * max(put_in(effect, "sigma_ms"), 5e-4) / np.sqrt(off_ms.size)
    if effect is not None:
        assert abs(np.corrcoef(off_ms[:-1], off_ms[1:])[0, 1]) < 5.0 / np.sqrt(off_ms.size)


@pytest.mark.parametrize("sigma_ms", [5.0, 50.0])
def test_stamps_that_scatter_over_several_samples_still_rise(sigma_ms: float) -> None:
    """A device clock does not go back; it never stands still either."""
    assert np.diff(identified(TimestampJitter(sigma_ms=sigma_ms)).t_device_us).min() >= 1


@sized("usb_batching")
def test_samples_arrive_in_bunches_at_the_ticks(effect: Effect | None) -> None:
    """Arrivals that differ are an interval apart to a microsecond; off, one sample comes after the other."""
    run = identified(effect)
    gaps_s = np.diff(run.t_host_s)
    interval_s = put_in(effect, "interval_ms") * 1e-3 or 0.01
    assert np.abs(gaps_s[gaps_s > 1e-6] - interval_s).max() < 1e-6
    assert np.mean(gaps_s > 1e-6) == pytest.approx(0.01 / interval_s, abs=0.001)


@sized("usb_batching")
def test_a_sample_waits_for_less_than_an_interval(effect: Effect | None) -> None:
    run = identified(effect)
    waits_s = run.t_host_s - run.t_s - DELAY_S
    interval_s = put_in(effect, "interval_ms") * 1e-3
    assert waits_s.min() >= -1e-9
    assert waits_s.max() < interval_s + 1e-9
    assert waits_s.mean() == pytest.approx(interval_s / 2.0, abs=0.002 * bool(effect) + 1e-9)


def arrivals_s(effect: UsbBatching, *blocks: int) -> Floats:
    """Arrivals of samples of 100 Hz that are measured in blocks of these lengths."""
    empty = np.zeros(0)
    act, moments = effect.begin(np.random.default_rng(3), 100.0), Moments(empty, empty, empty, empty, empty, 0.01)
    ends = np.cumsum(blocks)
    pieces = [np.arange(end - length, end) / 100.0 for end, length in zip(ends, blocks, strict=True)]
    return np.concatenate([act(piece_s, moments) for piece_s in pieces])


@pytest.mark.parametrize("spread_percent", [20.0, 50.0, 100.0])
def test_ticks_scatter_by_their_spread(spread_percent: float) -> None:
    """Ticks much rarer than samples show: their mean, and their standard deviation as a share of it."""
    came_s = arrivals_s(UsbBatching(interval_ms=500.0, spread_percent=spread_percent), 400_000)
    intervals_s = np.diff(np.unique(came_s))
    assert (came_s >= np.arange(400_000) / 100.0).all()
    assert intervals_s.mean() == pytest.approx(0.5, rel=0.05)
    assert intervals_s.std() / intervals_s.mean() == pytest.approx(spread_percent / 100.0, rel=0.05)


def test_samples_of_a_bunch_are_handed_over_one_after_the_other() -> None:
    """Distances within a bunch are the handover; a link that is slower than the samples never rests."""
    at_once_s = arrivals_s(UsbBatching(interval_ms=79.0), 4000)
    handed_s = arrivals_s(UsbBatching(interval_ms=79.0, handover_ms=2.0), 4000)
    gaps_ms = 1e3 * np.diff(handed_s)
    assert gaps_ms.min() == pytest.approx(2.0)
    assert np.median(gaps_ms) == pytest.approx(2.0)
    assert (handed_s - at_once_s).max() == pytest.approx(7 * 2e-3)
    slow_s = arrivals_s(UsbBatching(interval_ms=79.0, handover_ms=12.0), 4000)
    assert np.diff(slow_s)[1:] == pytest.approx(np.full(3998, 0.012))


def test_bunches_do_not_depend_on_the_blocks_of_the_measurement() -> None:
    uneven = UsbBatching(interval_ms=45.0, spread_percent=40.0, handover_ms=2.0)
    assert np.array_equal(arrivals_s(uneven, 3000), arrivals_s(uneven, 1, 99, 900, 2000))
    even = UsbBatching(interval_ms=45.0, spread_percent=0.0, handover_ms=0.0)
    assert np.array_equal(arrivals_s(even, 3000), np.ceil(np.arange(3000) / 100.0 / 0.045) * 0.045)


def test_a_sample_that_the_scheduler_delays_still_waits_for_the_tick() -> None:
    """Jitter comes before the link: arrivals stay on the ticks, and no sample is there before its own."""
    jittery = SHIPPED.model_copy(update={"host_jitter_s": 0.004})
    run = record(rig_of(effect_of("usb_batching", "small"), base=jittery), load_profile("identify"), 60.0)
    ticks = run.t_host_s / 0.016
    assert np.abs(ticks - np.rint(ticks)).max() < 1e-6
    assert (run.t_host_s >= run.t_s + DELAY_S - 1e-9).all()


@sized("sample_drop")
def test_lost_samples_are_holes_in_the_counter(effect: Effect | None) -> None:
    seq = identified(effect).seq
    holes = np.diff(seq, prepend=-1) - 1
    share = put_in(effect, "share_percent") / 100.0
    assert abs(holes.sum() / 59_400 - share) <= share_bound(share, 59_400)
    assert np.mean(holes[holes > 0] > 1 if effect else 0.0) < 0.1


@pytest.mark.parametrize("name", ["clock_drift", "timestamp_jitter", "usb_batching", "sample_drop"])
def test_what_arrives_was_measured_as_ever(name: str) -> None:
    """Rate and encoder of a sample do not depend on clock and link."""
    disturbed, usual = identified(effect_of(name)), identified(None)
    assert disturbed.rate_dps.tolist() == usual.rate_dps[disturbed.seq].tolist()
    assert disturbed.encoder_deg.tolist() == usual.encoder_deg[disturbed.seq].tolist()
