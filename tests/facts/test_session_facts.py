"""Facts of sessions against data whose truth is known, the simulated rig, and real recordings."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import allantools
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from recordings_support import Recordings
from support import near

from firmware_sim.motion.profile import load_profile
from firmware_sim.rig import load_rig, parse_effect, with_effects
from gyrodrift.facts.allan import allan_deviation
from gyrodrift.facts.host import HostClock
from gyrodrift.facts.rests import RestSource
from gyrodrift.facts.session_facts import Encoder, Gaps, Rates, SessionFacts, Temperatures
from gyrodrift.session.files import load_session
from gyrodrift.session.session import Session
from gyrodrift.simulation.sessions import Simulation
from gyrodrift.values.arrays import Floats
from gyrodrift.values.noise import FLICKER_FLOOR

RATE_HZ = 100.0
BIAS_DPS = 0.4
NOISE_DPS = 0.03


def session_of(
    t_s: Sequence[float] | Floats, rate_dps: Sequence[float] | Floats | None = None, **extra: Any
) -> Session:
    times = np.array(t_s, dtype=np.float64)
    rates = np.zeros(len(times)) if rate_dps is None else np.array(rate_dps, dtype=np.float64)
    return Session("s", times, rates, **extra)


def turned(*motion: tuple[float, float], seed: int = 1, step_deg: float = 0.01) -> Session:
    """A sensor with bias and noise beside an encoder, turned by (seconds, deg/s) one after the other."""
    true_dps = np.concatenate([np.full(round(seconds * RATE_HZ), dps) for seconds, dps in motion])
    noise_dps = NOISE_DPS * np.random.default_rng(seed).standard_normal(len(true_dps))
    angle_deg = np.concatenate(([0.0], np.cumsum(true_dps)[:-1])) / RATE_HZ
    encoder_deg = np.floor(angle_deg / step_deg + 1e-6) * step_deg
    return session_of(np.arange(len(true_dps)) / RATE_HZ, true_dps + BIAS_DPS + noise_dps, encoder_deg=encoder_deg)


def simulated(profile: str, *effects: str, minutes: float = 5.0) -> Session:
    rig = with_effects(load_rig(None), [parse_effect(text) for text in effects])
    return Simulation(rig, load_profile(profile), 1, 0, minutes).whole()


def times_of(facts: SessionFacts) -> Floats:
    return np.array([(item.start_s, item.end_s) for item in facts.stretches])


def test_a_clean_session_has_its_rate_and_nothing_missing() -> None:
    facts = SessionFacts(session_of(1e5 + np.arange(501) / 50.0, np.linspace(-1.0, 2.0, 501)))
    assert (facts.samples, facts.duration_s, facts.rate_hz) == (501, near(10.0), near(50.0))
    assert facts.jitter_s == near(0.0, 1e-9)
    assert facts.gaps == Gaps(0, 0, 0.0)
    assert (facts.steps_not_forward, facts.rates_not_finite) == (0, 0)
    assert facts.rate == Rates(-1.0, 2.0, near(0.5))
    assert [facts.host, facts.temperature, facts.encoder, facts.allan] == [None] * 4


@pytest.mark.parametrize("has_counter", [True, False])
def test_gaps_are_counted_by_the_counter_or_else_by_time(*, has_counter: bool) -> None:
    """Holes of 1, 3 and 20 samples."""
    kept = np.setdiff1d(np.arange(1000), [100, *range(300, 303), *range(500, 520)])
    facts = SessionFacts(session_of(kept / RATE_HZ, seq=kept if has_counter else None))
    assert facts.gaps == Gaps(3, 24, near(0.21))


def test_the_counter_knows_better_than_time() -> None:
    """A device that waits loses nothing; one whose clock stops for what it loses has no step that shows it."""
    t_s = np.arange(200) / RATE_HZ
    late = np.where(np.arange(200) < 100, t_s, t_s + 0.5)
    assert SessionFacts(session_of(late, seq=np.arange(200))).gaps == Gaps(1, 0, near(0.51))
    lost = SessionFacts(session_of(t_s, seq=np.where(np.arange(200) < 100, np.arange(200), np.arange(200) + 7))).gaps
    assert (lost.count, lost.missing) == (0, 7)


def test_jitter_is_the_scatter_of_steps_whatever_the_gaps() -> None:
    steps_s = 0.01 + 2e-4 * np.random.default_rng(1).standard_normal(10_000)
    steps_s[::100] = 0.5
    facts = SessionFacts(session_of(np.cumsum(steps_s)))
    assert facts.jitter_s == pytest.approx(2e-4, rel=0.05)
    assert facts.gaps.count == pytest.approx(100, abs=1)


def test_what_the_filter_passes_by_is_counted() -> None:
    """Time that stands still, goes back or is no number; rates that are no number."""
    facts = SessionFacts(
        session_of([0.0, 0.01, 0.01, 0.02, 0.005, np.nan, 0.03], [1.0, np.nan, 1.0, np.inf, 1.0, 1.0, 3.0])
    )
    assert (facts.steps_not_forward, facts.rates_not_finite) == (3, 2)
    assert facts.rate == Rates(1.0, 3.0, near(1.4))


def arrived(ppm: float, delays_s: Floats) -> Session:
    true_s = np.arange(len(delays_s)) / RATE_HZ
    return session_of(true_s * (1.0 + ppm * 1e-6), t_host_s=1.7e9 + true_s + 0.002 + delays_s)


@pytest.mark.parametrize("ppm", [-5000.0, -40.0, 0.0, 12.5, 300.0])
@pytest.mark.parametrize("is_bunched", [False, True])
def test_clock_drift_is_found_within_its_stated_error(ppm: float, *, is_bunched: bool) -> None:
    errors = []
    for seed in range(30):
        rng = np.random.default_rng(seed)
        delays_s = rng.exponential(0.003, 20_000)
        if is_bunched:
            ready_s = np.arange(20_000) / RATE_HZ + delays_s
            period_s = 0.016 * (1.0 + 1e-4 * rng.standard_normal())
            delays_s = np.ceil(ready_s / period_s) * period_s - np.arange(20_000) / RATE_HZ
        host = SessionFacts(arrived(ppm, delays_s)).host
        assert host is not None
        assert host.drift_ppm is not None
        assert host.drift_sd_ppm is not None
        assert host.drift_sd_ppm < 20.0
        errors.append(abs(host.drift_ppm - ppm) / host.drift_sd_ppm)
    assert np.mean(np.array(errors) < 1.0) > 0.5
    assert max(errors) < 4.0


def test_host_delay_is_its_scatter_above_the_soonest() -> None:
    """The 95 % quantile of exponential delays is 3 times their mean."""
    host = SessionFacts(arrived(100.0, np.random.default_rng(3).exponential(0.004, 30_000))).host
    assert host is not None
    assert host.delay_p95_s == pytest.approx(0.012, rel=0.05)


def test_a_short_session_says_nothing_of_its_clock() -> None:
    host = SessionFacts(arrived(100.0, np.tile([0.0, 0.01], 200))).host
    assert host == HostClock(None, None, near(0.01, 1e-3))


def test_temperature_and_encoder_are_told() -> None:
    temp_c = np.concatenate(([np.nan, 20.0], np.linspace(20.0, 31.0, 97), [30.0, np.nan]))
    facts = SessionFacts(replace(turned((1.01, 36.0), step_deg=0.09), temp_c=temp_c))
    assert facts.temperature == Temperatures(20.0, 31.0, 20.0, 30.0)
    assert facts.encoder == Encoder(0.0, near(36.0), near(0.36))


MOTION = ((6.0, 0.0), (5.0, 30.0), (4.0, 0.0), (3.0, -90.0), (1.0, 0.0), (2.0, 5.0), (8.0, 0.0))
RESTS_S = [(0.0, 6.0), (11.0, 15.0), (21.0, 29.0)]


@pytest.mark.parametrize("step_deg", [0.001, 0.01, 0.36])
def test_rests_are_found_by_the_encoder_and_end_before_motion_begins(step_deg: float) -> None:
    facts = SessionFacts(turned(*MOTION, step_deg=step_deg))
    result = times_of(facts)
    assert facts.still_by is RestSource.ENCODER
    assert result == pytest.approx(np.array(RESTS_S), abs=1.0)
    assert (result[:, 0] >= [start for start, _ in RESTS_S]).all()
    assert (result[:, 1] <= [end for _, end in RESTS_S]).all()
    for item in facts.stretches:
        assert item.mean_dps == near(BIAS_DPS, 4.0 * NOISE_DPS / np.sqrt((item.end_s - item.start_s) * RATE_HZ))
        assert item.std_dps == pytest.approx(NOISE_DPS, rel=0.15)


def test_a_reference_that_is_never_quite_still_shows_rest_all_the_same() -> None:
    """Noise of 0.005 deg that wanders by 0.05."""
    session = turned(*MOTION)
    assert session.encoder_deg is not None
    wander_deg = 0.025 * np.sin(session.t_device_s) + 0.005 * np.random.default_rng(1).standard_normal(2900)
    result = times_of(SessionFacts(replace(session, encoder_deg=session.encoder_deg + wander_deg)))
    assert result == pytest.approx(np.array(RESTS_S), abs=1.0)


def test_without_an_encoder_steady_stretches_are_a_guess() -> None:
    """The rests to a second, and the steady turns with them."""
    facts = SessionFacts(replace(turned(*MOTION), encoder_deg=None))
    assert facts.still_by is RestSource.RATE
    expected = sorted([*RESTS_S, (6.0, 11.0), (15.0, 18.0)])
    assert times_of(facts) == pytest.approx(np.array(expected), abs=1.001)
    assert [item.mean_dps for item in facts.stretches] == pytest.approx([0.4, 30.4, 0.4, -89.6, 0.4], abs=0.01)


@pytest.mark.parametrize("dps", [0.05, 0.2, 20.0])
@pytest.mark.parametrize("step_deg", [0.01, 0.36])
def test_a_constant_spin_is_rest_to_the_rate_and_none_to_the_encoder(dps: float, step_deg: float) -> None:
    session = turned((120.0, dps), step_deg=step_deg)
    assert SessionFacts(session).stretches == ()
    (item,) = SessionFacts(replace(session, encoder_deg=None)).stretches
    assert item.mean_dps == near(dps + BIAS_DPS, 0.002)
    assert item.end_s - item.start_s > 118.0


def test_motion_without_rest_is_no_stretch_for_either() -> None:
    """A swing of a few seconds."""
    t_s = np.arange(6000) / RATE_HZ
    noise_dps = NOISE_DPS * np.random.default_rng(1).standard_normal(6000)
    session = session_of(t_s, 30.0 * np.cos(t_s) + noise_dps, encoder_deg=30.0 * np.sin(t_s))
    assert SessionFacts(session).stretches == ()
    assert SessionFacts(replace(session, encoder_deg=None)).stretches == ()


def test_a_long_hole_ends_a_stretch_and_a_lost_sample_does_not() -> None:
    kept = np.setdiff1d(np.arange(6000), [*range(0, 6000, 77), *range(3000, 3500)])
    rate_dps = NOISE_DPS * np.random.default_rng(1).standard_normal(len(kept))
    for encoder_deg in (None, np.zeros(len(kept))):
        result = times_of(SessionFacts(session_of(kept / RATE_HZ, rate_dps, encoder_deg=encoder_deg)))
        assert result == pytest.approx(np.array([(0.0, 30.0), (35.0, 60.0)]), abs=1.5)


@pytest.mark.parametrize("count", [100, 3001, 40_000])
def test_the_allan_deviation_is_that_of_allantools(count: int) -> None:
    rng = np.random.default_rng(count)
    rate_dps = 1.0 + rng.standard_normal(count) + 0.01 * np.cumsum(rng.standard_normal(count))
    taus_s, deviations_dps = allan_deviation(rate_dps, 0.004)
    assert len(taus_s) == int(np.log2(count / 9)) + 1
    expected_s, expected_dps, _, _ = allantools.oadev(rate_dps, 250.0, "freq", taus_s)
    np.testing.assert_allclose(taus_s, expected_s, rtol=1e-12)
    np.testing.assert_allclose(deviations_dps, expected_dps, rtol=1e-9)


@pytest.mark.parametrize("walk_deg_rts", [0.0035, 0.02])
def test_the_angle_random_walk_is_recovered(walk_deg_rts: float) -> None:
    """Five times to a tenth from 30 s and to 5 % from ten minutes; white noise has no bias instability."""
    for seconds, bound in ((30, 0.1), (600, 0.05)):
        for seed in range(5):
            rate_dps = walk_deg_rts * 10.0 * np.random.default_rng(seed).standard_normal(seconds * 100)
            allan = SessionFacts(
                session_of(np.arange(len(rate_dps)) / 100.0, rate_dps, encoder_deg=np.zeros(len(rate_dps)))
            ).allan
            assert allan is not None
            assert allan.angle_random_walk_deg_rts == pytest.approx(walk_deg_rts, rel=bound)
            assert allan.bias_instability_dps is None


def test_a_low_pass_hides_neither_noise_nor_makes_a_minimum() -> None:
    """The rig's own noise, in a band of 5 Hz."""
    allan = SessionFacts(simulated("rest", "bandwidth:cutoff_hz=5", minutes=10.0)).allan
    assert allan is not None
    assert allan.angle_random_walk_deg_rts == pytest.approx(0.0035, rel=0.1)
    assert allan.bias_instability_dps is None


def test_bias_instability_is_read_off_the_flat_part() -> None:
    allan = SessionFacts(simulated("rest", "bias_instability:floor_dph=36", minutes=60.0)).allan
    assert allan is not None
    assert allan.bias_instability_dps == pytest.approx(0.01, rel=0.34)
    assert allan.bias_instability_tau_s is not None
    assert allan.bias_instability_dps == near(float(allan.deviations_dps.min()) / FLICKER_FLOOR)


def test_a_walking_bias_has_a_minimum() -> None:
    """N²/τ + K²·τ/3 is least at τ = N/K·√3: about 3 s here, found within an octave."""
    rng = np.random.default_rng(1)
    rate_dps = 0.1 * rng.standard_normal(60_000) + 0.00058 * np.cumsum(rng.standard_normal(60_000))
    allan = SessionFacts(session_of(np.arange(60_000) / 100.0, rate_dps, encoder_deg=np.zeros(60_000))).allan
    assert allan is not None
    assert allan.bias_instability_tau_s is not None
    assert 1.4 < allan.bias_instability_tau_s < 6.0


def test_allan_needs_half_a_minute() -> None:
    rate_dps = np.random.default_rng(1).standard_normal(2900)
    assert SessionFacts(session_of(np.arange(2900) / 100.0, rate_dps, encoder_deg=np.zeros(2900))).allan is None


@pytest.mark.parametrize("count", [1, 2, 3])
@pytest.mark.parametrize("columns", [(), ("t_host_s", "encoder_deg", "temp_c")])
def test_a_few_samples_are_described(count: int, columns: tuple[str, ...]) -> None:
    facts = SessionFacts(session_of(np.arange(count) / 10.0, **{name: np.arange(float(count)) for name in columns}))
    assert facts.samples == count
    assert (facts.rate_hz is None) == (count == 1)
    assert facts.stretches == ()


def test_time_that_stands_still_and_rates_that_are_no_numbers_are_described() -> None:
    still = SessionFacts(session_of(np.ones(100), t_host_s=np.arange(100.0), encoder_deg=np.zeros(100)))
    assert (still.rate_hz, still.duration_s, still.steps_not_forward, still.stretches) == (None, 0.0, 99, ())
    nothing = SessionFacts(session_of(np.full(100, np.nan), np.full(100, np.nan), t_host_s=np.full(100, np.nan)))
    assert (nothing.rate, nothing.rate_hz, nothing.host) == (None, None, None)
    assert (nothing.steps_not_forward, nothing.rates_not_finite) == (99, 100)
    stopped = SessionFacts(session_of(np.arange(5000) / 100.0, t_host_s=np.ones(5000))).host
    assert stopped is not None
    assert stopped.drift_ppm is None


wild = st.lists(st.floats(width=64), min_size=40, max_size=40)


@given(st.integers(1, 40), wild, wild, wild, wild, st.lists(st.integers(-1, 2**62), min_size=40, max_size=40))
def test_any_numbers_are_described(
    count: int, t_s: list[float], host_s: list[float], rate: list[float], angle: list[float], seq: list[int]
) -> None:
    """A file may hold whatever it likes."""
    wide = {"t_host_s": host_s, "seq": seq, "encoder_deg": angle, "temp_c": angle}
    columns = {name: np.array(column)[:count] for name, column in wide.items()}
    even_s = np.arange(count) / 2.0
    for session in (
        session_of(t_s[:count], rate[:count], **columns),
        session_of(even_s, rate[:count], **columns),
        session_of(even_s, rate[:count]),
    ):
        assert SessionFacts(session).published()["samples"] == count


def test_the_simulated_rig_is_described_as_it_is() -> None:
    session = simulated("turntable", "clock_drift:ppm=300", "usb_batching", "sample_drop")
    facts = SessionFacts(session)
    assert session.seq is not None
    assert facts.gaps.missing == session.seq[-1] - session.seq[0] + 1 - facts.samples
    assert facts.host is not None
    assert facts.host.drift_ppm == near(300.0, 1.0)
    assert facts.encoder is not None
    assert facts.encoder.smallest_step_deg == near(0.01)
    assert len(facts.stretches) > 20
    assert [item.mean_dps for item in facts.stretches] == pytest.approx([0.35] * len(facts.stretches), abs=0.01)


@pytest.mark.parametrize(
    ("name", "bias_dps", "least_s"),
    [("broad_01", 0.47, 65.0), ("broad_06", 0.49, 65.0), ("broad_14", -0.23, 60.0), ("mpu6050_still", 1.12, 650.0)],
)
def test_real_recordings_have_the_rest_that_their_makers_tell(
    name: str, bias_dps: float, least_s: float, recordings: Recordings
) -> None:
    session = load_session(recordings.path(name))
    for item in (session, replace(session, encoder_deg=None)):
        stretches = SessionFacts(item).stretches
        lengths_s = [stretch.end_s - stretch.start_s for stretch in stretches]
        assert sum(lengths_s) > least_s
        means_dps = [stretch.mean_dps for stretch in stretches]
        assert np.average(means_dps, weights=lengths_s) == near(bias_dps, 0.02)


def test_an_hour_at_a_kilohertz_is_described() -> None:
    """Three and a half million samples with every column; work that grows with their square would not end."""
    count, rng = 3_600_000, np.random.default_rng(1)
    t_s, still = np.arange(count) / 1000.0, np.zeros(count)
    session = session_of(t_s, rng.standard_normal(count), t_host_s=t_s, seq=np.arange(count), encoder_deg=still)
    facts = SessionFacts(session).published()
    assert facts["allan"] is not None
