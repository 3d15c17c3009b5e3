"""The bias: Allan deviations of simulated hours, levels, and the parts that go with rate and angle."""

import allantools
import numpy as np
import pytest
from effects_bench import (
    REST,
    effect_of,
    fitted,
    means,
    once_per_turn,
    phasor,
    profile_of,
    put_in,
    record,
    rig_of,
    sized,
)
from scipy.signal import welch

from firmware_sim.effects.effect import Effect, Floats
from firmware_sim.motion.profile import load_profile
from firmware_sim.rig import Base

TAUS_S = np.array([1.0, 10.0, 100.0])
BOUNDS = np.array([0.03, 0.08, 0.25])
"""Relative, at TAUS_S. n hours have 3600·n/τ means, and 1/√(2·3600·n/τ) is the error that Allan deviations of white
noise have; for eight hours it is 0.4, 1.3 and 4.2 %. The slow noises have up to twice that, and this is five of them
at the least."""

HOURS = 8
HOUR_S = 3600.0
NOISE = 0.005


def allan_dps(*effects: Effect | None, base: Base) -> Floats:
    """Overlapping Allan deviation at TAUS_S, the mean square over hours with different seeds."""
    squares = np.zeros(len(TAUS_S))
    for seed in range(HOURS):
        rate_dps = record(rig_of(*effects, base=base), profile_of(*REST), HOUR_S, seed).rate_dps
        taus_s, deviations, _, _ = allantools.oadev(rate_dps, base.sample_rate_hz, "freq", TAUS_S)
        np.testing.assert_allclose(taus_s, TAUS_S)
        squares += deviations**2 / HOURS
    result: Floats = np.sqrt(squares)
    return result


def slow(noise_dps_rthz: float) -> Base:
    """Ten samples a second: all that an Allan deviation from one second on needs."""
    return Base(sample_rate_hz=10.0, dps_per_lsb=2e-5, noise_dps_rthz=noise_dps_rthz)


@pytest.mark.parametrize("noise_dps_rthz", [0.0, 0.005, 0.02])
def test_white_noise_has_its_allan_deviation(noise_dps_rthz: float) -> None:
    """N/√τ: the density is that of an angle random walk (IEEE 952)."""
    base = Base(sample_rate_hz=20.0, dps_per_lsb=1e-4, noise_dps_rthz=noise_dps_rthz)
    expected = noise_dps_rthz / np.sqrt(TAUS_S)
    assert (np.abs(allan_dps(base=base) - expected) <= BOUNDS * expected).all()


@sized("bias_instability")
def test_one_over_f_noise_has_a_flat_allan_deviation(effect: Effect | None) -> None:
    result = allan_dps(effect, base=slow(0.0))
    floor = 0.664 * put_in(effect, "floor_dph") / 3600.0
    assert (np.abs(result - floor) <= BOUNDS * floor).all()


@pytest.mark.parametrize("sample_rate_hz", [50.0, 400.0])
def test_one_over_f_noise_goes_on_to_half_the_sample_rate(sample_rate_hz: float) -> None:
    base = Base(sample_rate_hz=sample_rate_hz, dps_per_lsb=1e-5, noise_dps_rthz=0.0)
    rate_dps = record(rig_of(effect_of("bias_instability"), base=base), profile_of(*REST), 600.0).rate_dps
    frequencies_hz, density = welch(rate_dps, sample_rate_hz, nperseg=round(16.0 * sample_rate_hz))
    floor_dps = put_in(effect_of("bias_instability"), "floor_dph") / 3600.0
    shares = 0.5 * density[1:] * 2.0 * np.pi * frequencies_hz[1:] / floor_dps**2
    lowest = 0.5
    while lowest < sample_rate_hz / 4.0:
        octave = (frequencies_hz[1:] >= lowest) & (frequencies_hz[1:] < 2.0 * lowest)
        assert shares[octave].mean() == pytest.approx(1.0, abs=0.25)
        lowest *= 2.0


@sized("rate_random_walk")
def test_a_walking_bias_has_its_allan_deviation(effect: Effect | None) -> None:
    """K·√(τ/3), beside the shipped noise; variances add."""
    result = allan_dps(effect, base=slow(NOISE).model_copy(update={"dps_per_lsb": 1e-4}))
    variance = NOISE**2 / TAUS_S + put_in(effect, "density_dps_rts") ** 2 * TAUS_S / 3.0
    assert (np.abs(result / np.sqrt(variance) - 1.0) <= BOUNDS).all()


def test_a_walking_bias_has_no_floor_to_its_steps() -> None:
    rig = rig_of(effect_of("rate_random_walk"), base=Base(sample_rate_hz=1.0))
    ends_dps = [record(rig, profile_of(*REST), 3600.0, seed).rate_dps[-60:].mean() for seed in range(40)]
    assert np.std(ends_dps) == pytest.approx(0.005 * 60.0, rel=0.4)


@sized("popcorn")
def test_popcorn_has_two_levels_and_its_dwell_time(effect: Effect | None) -> None:
    means_dps = means(record(rig_of(effect), profile_of(*REST), HOUR_S, 1).rate_dps, 150)
    middle = 0.5 * (np.quantile(means_dps, 0.02) + np.quantile(means_dps, 0.98))
    is_high = means_dps > middle
    step_dps = float(np.median(means_dps[is_high]) - np.median(means_dps[~is_high]))
    if effect is None:
        assert step_dps < 0.007
        return
    assert step_dps == pytest.approx(put_in(effect, "step_dps"), abs=0.001)
    assert HOUR_S / np.sum(is_high[1:] != is_high[:-1]) == pytest.approx(put_in(effect, "dwell_s"), rel=0.25)


@sized("vibration_rectification")
def test_rectification_is_the_part_that_goes_with_the_square_of_the_rate(effect: Effect | None) -> None:
    run = record(rig_of(effect), load_profile("identify"), 594.0)
    _, gain, square = fitted(run.error_dps, 1.0, run.true_dps, (run.true_dps / 100.0) ** 2)
    assert square == pytest.approx(put_in(effect, "bias_dps_at_100_dps"), abs=0.001)
    assert gain == pytest.approx(0.0, abs=1e-5)


@sized("g_sensitivity")
@pytest.mark.parametrize("to_dps", [-45.0, 90.0])
def test_a_tilted_table_shows_once_per_turn_whatever_the_speed(effect: Effect | None, to_dps: float) -> None:
    """Amplitude and phase against the true angle, to 2.5 mdps; the noise leaves 0.7."""
    spin = {"kind": "ramp", "seconds": 1.0, "to_dps": to_dps}
    run = record(rig_of(effect), profile_of(spin, {"kind": "hold", "seconds": 99.0}), 100.0)
    result = once_per_turn(run.error_dps, run.angle_deg)
    assert result == pytest.approx(phasor(effect, "amplitude_dps"), abs=0.0025)
