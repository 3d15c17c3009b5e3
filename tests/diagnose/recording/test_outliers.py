"""Outliers of the rate and jumps of the angle: found with their size, taken out, and not seen where there are none."""

import numpy as np
import pytest
from features_support import COUNTS_PER_TURN, T_S, TRUE_DEG, TRUE_DPS, recorded, white

from firmware_sim.motion.profile import load_profile
from firmware_sim.rig import Base, Rig, parse_effect
from gyrodrift.diagnose.recording.outliers import Cleaned, clean, granularity, is_at_limit, step_of, steps_of
from gyrodrift.diagnose.recording.recording import recording_of
from gyrodrift.session.session import Session
from gyrodrift.simulation.sessions import Simulation
from gyrodrift.values.arrays import Floats

SIGMA = 0.05


def observed(
    spikes: dict[int, float] | None = None,
    jumps: dict[int, float] | None = None,
    sigma: float = SIGMA,
    cpr: int = COUNTS_PER_TURN,
) -> Cleaned:
    """The worked-out motion with so much added to a sample of the rate, or to the angle from a sample on."""
    rate_dps, angle_deg = TRUE_DPS + white(sigma), TRUE_DEG.copy()
    for index, height in (spikes or {}).items():
        rate_dps[index] += height
    for index, height in (jumps or {}).items():
        angle_deg[index:] += height
    return clean(recorded(rate_dps, angle_deg, cpr))


def test_nothing_is_found_in_noise() -> None:
    """Nor on ramps between rest and motion."""
    result = observed()
    assert len(result.spikes_dps) == len(result.slips_deg) == 0
    assert np.array_equal(result.rate_dps, TRUE_DPS + white(SIGMA))


def test_outliers_are_found_with_their_size() -> None:
    result = observed(spikes={1000: 5.0, 9000: -12.0, 15_000: 30.0})
    assert result.spikes_dps == pytest.approx([5.0, -12.0, 30.0], abs=4.0 * SIGMA)
    assert np.abs(result.rate_dps - TRUE_DPS).max() < 6.0 * SIGMA


@pytest.mark.parametrize("seed", range(12))
def test_coarse_counts_hide_no_outlier(seed: int) -> None:
    rng = np.random.default_rng([seed, 20])
    rate_hz, cpr = float(rng.choice([50.0, 100.0, 200.0, 400.0])), int(2.0 ** rng.uniform(9.0, 16.0))
    motion, minutes, height_dps = load_profile("identify"), 2.0, 20.0
    base = Base(sample_rate_hz=rate_hz, encoder_cpr=cpr, noise_dps_rthz=float(rng.uniform(0.0015, 0.02)))
    rig = Rig(base=base, effects=(parse_effect(f"spikes:height_dps={height_dps},share_percent=0.3"),))
    whole = [Simulation(item, motion, seed, 0, minutes).whole() for item in (rig, Rig(base=base))]
    put_in = np.count_nonzero(np.abs(whole[0].rate_dps - whole[1].rate_dps) > 0.5 * height_dps)
    result, without = (clean(recording_of(session, round(60.0 * minutes * rate_hz))).spikes_dps for session in whole)
    assert put_in
    assert not len(without)
    assert put_in - len(result) <= max(1, 0.1 * put_in)
    assert np.median(np.abs(result)) == pytest.approx(height_dps, rel=0.05)


@pytest.mark.parametrize("cpr", [720, COUNTS_PER_TURN])
def test_of_two_outliers_in_a_row_none_is_left(cpr: int) -> None:
    """The one would be taken for the other's neighbour."""
    result = observed(spikes={1000: 22.0, 1001: 24.0, 9000: 20.0, 9002: -20.0}, cpr=cpr)
    assert len(result.spikes_dps) == 4
    assert np.abs(result.rate_dps - TRUE_DPS).max() < 6.0 * SIGMA


def test_an_edge_of_the_rate_is_no_outlier() -> None:
    """Nor a corner, nor a sample that repeats the one before while the rate changes quickly."""
    rate_dps = np.interp(T_S, [0.0, 20.0, 20.2, 40.0, 40.01, T_S[-1]], [0.0, 0.0, 60.0, 60.0, 0.0, 0.0]) + white(SIGMA)
    rate_dps[2010] = rate_dps[2009]
    angle_deg = np.cumsum(rate_dps) * (T_S[1] - T_S[0])
    assert not len(clean(recorded(rate_dps, angle_deg, 720)).spikes_dps)


def test_an_outlier_is_filled_by_its_neighbours() -> None:
    result = observed(spikes={1000: 5.0})
    assert result.rate_dps[1000] == pytest.approx(0.5 * (result.rate_dps[999] + result.rate_dps[1001]))


def test_jumps_are_found_with_their_size() -> None:
    result = observed(jumps={2000: 0.2, 9000: -0.3, 15_000: 0.05})
    assert result.slips_deg == pytest.approx([0.2, -0.3, 0.05], abs=0.005)
    assert np.abs(result.encoder_deg - TRUE_DEG).max() < 0.01
    assert len(result.spikes_dps) == 0


def test_steps_of_a_coarse_encoder_are_no_jumps() -> None:
    result = observed(cpr=720)
    assert len(result.slips_deg) == 0
    assert result.step_deg == pytest.approx(0.5)


def test_jumps_of_a_few_coarse_steps_are_found() -> None:
    """Rounding makes none of more than a step, so that three are no chance, at rest and turning."""
    result = observed(jumps={2000: 1.7, 9000: -1.7, 15_000: 2.3}, cpr=720)
    assert result.slips_deg == pytest.approx([1.7, -1.7, 2.3], abs=0.55)


@pytest.mark.parametrize("steps", [0.1, 0.2, 0.3, 0.35, 0.4, 0.5, 1.0])
def test_noise_of_a_coarse_encoder_makes_no_jumps(steps: float) -> None:
    """A magnet that is read with noise of so many steps."""
    noise_deg = np.random.default_rng(4).normal(0.0, 0.5 * steps, len(T_S))
    result = clean(recorded(TRUE_DPS + white(SIGMA), TRUE_DEG + noise_deg, 720))
    assert len(result.slips_deg) == 0


def test_holes_are_filled_before_anything_is_looked_for() -> None:
    rate_dps = TRUE_DPS + white(SIGMA)
    rate_dps[5000:5003] = np.nan
    result = clean(recorded(rate_dps))
    assert np.isfinite(result.rate_dps).all()
    assert len(result.spikes_dps) == 0


@pytest.mark.parametrize("count", [10, 100, 20_000])
def test_a_constant_has_no_outliers(count: int) -> None:
    """Nor has a recording of ten samples."""
    result = clean(recorded(np.zeros(count), np.zeros(count)))
    assert len(result.spikes_dps) == len(result.slips_deg) == 0
    assert result.step_deg == 0.0


@pytest.mark.parametrize("step", [0.25, 0.07, 2.0])
def test_steps_are_read_off_the_values(step: float) -> None:
    values = np.round(white(20.0 * step, 3, 4000) / step) * step
    assert granularity(values) == pytest.approx(step)
    assert step_of(values) == pytest.approx(step)


def test_a_step_between_two_levels_is_their_mean() -> None:
    """Steps of 0.025 that are written as 0.02 and 0.03 alike."""
    values = np.round(np.arange(-40.0, 41.0) * 0.025 + 1e-6, 2)
    assert granularity(values) == pytest.approx(0.02)
    assert step_of(values) == pytest.approx(0.025, rel=0.02)


def test_the_step_of_few_levels_is_that_of_the_closest() -> None:
    levels = np.concatenate([[0.0, 1.0, 2.0, 3.0], np.arange(-5, 6) * 7.0 + 40.0])
    assert granularity(0.05 * levels) == pytest.approx(0.05)


def test_the_step_of_a_motion_that_comes_by_the_same_values_is_the_smallest() -> None:
    seldom = 0.05 * np.cumsum([0, 1, 36, 2, 37, 3, 36, 5, 37, 7, *(36, 37) * 10])
    assert granularity(seldom) == pytest.approx(0.05)
    chance = np.cumsum([0.13, 1.0, 0.47, 1.0, 0.77, *(1.0,) * 40])
    assert granularity(chance) == pytest.approx(1.0)


@pytest.mark.parametrize("values", [np.zeros(0), np.ones(1), np.ones(5), np.full(3, np.nan)])
def test_one_value_has_no_step(values: Floats) -> None:
    assert granularity(values) == step_of(values) == 0.0


def test_times_are_those_of_the_recording() -> None:
    assert len(observed().rate_dps) == len(observed().encoder_deg) == len(T_S)


def quick(seed: int, late: int = 0, jump_deg: float = 0.0) -> Cleaned:
    """A motor that is at its rate within 80 ms, read 50 times a second beside an encoder of 65 536 counts.

    The gyro is `late` by so many samples; the angle jumps in the middle.
    """
    dice = np.random.default_rng(seed)
    fine_s, period_s = 1e-4, 0.02
    levels_dps = np.repeat(np.pad(dice.uniform(-200.0, 200.0, 80), 1), 5000)
    ramp = np.ones(800) / 800.0
    rate_dps = np.convolve(np.convolve(levels_dps, ramp, "same"), np.ones(100) / 100.0, "same")
    angle_deg = np.cumsum(rate_dps) * fine_s
    every = round(period_s / fine_s)
    count_deg, count = 360.0 / 65_536, len(rate_dps) // every
    t_s = np.linspace(0.0, (count - 1) * period_s, count)
    late_dps = rate_dps[::every][np.clip(np.arange(count) - late, 0, count - 1)]
    seen_dps = late_dps + dice.normal(0.0, SIGMA, count)
    angle_deg = angle_deg[::every] + np.where(np.arange(count) < count // 2, 0.0, jump_deg)
    angles_deg = np.rint(angle_deg / count_deg) * count_deg
    return clean(recording_of(Session("quick", t_s, seen_dps, 1.7e9 + t_s, np.arange(count), angles_deg)))


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("late", [0, 2, 7, -3])
def test_corners_of_a_quick_motion_are_no_jumps(seed: int, late: int) -> None:
    """Nor those of a gyro that is late or early."""
    assert len(quick(seed, late).slips_deg) == 0


@pytest.mark.parametrize("late", [0, 7])
def test_a_jump_beside_a_late_gyro_is_found(late: int) -> None:
    assert quick(1, late, jump_deg=3.0).slips_deg == pytest.approx([3.0], abs=0.3)


def plateau(limit_dps: float, sigma_dps: float, step_dps: float = 0.061) -> tuple[Floats, Floats]:
    """Rate and angle of a table that speeds up to 60 deg/s, turns steadily and stops, of a gyro of some limit."""
    true_dps = np.interp(np.arange(3000) / 100.0, [0.0, 5.0, 10.0, 20.0, 25.0], [0.0, 0.0, 60.0, 60.0, 0.0])
    noise = np.random.default_rng(5).normal(0.0, sigma_dps, len(true_dps))
    rate_dps = np.rint(np.minimum(true_dps + noise, limit_dps) / step_dps) * step_dps
    return rate_dps, np.floor(np.cumsum(true_dps) / 100.0 / 0.35) * 0.35


@pytest.mark.parametrize("sigma_dps", [0.0, 0.01, 0.03, 0.1])
def test_a_steady_motion_is_at_no_limit(sigma_dps: float) -> None:
    assert not is_at_limit(*plateau(1000.0, sigma_dps), 0.01).any()


@pytest.mark.parametrize("sigma_dps", [0.0, 0.01, 0.03, 0.1])
@pytest.mark.parametrize("limit_dps", [40.0, 55.0])
def test_what_the_encoder_goes_beyond_is_a_limit(limit_dps: float, sigma_dps: float) -> None:
    rate_dps, angle_deg = plateau(limit_dps, sigma_dps)
    result = is_at_limit(rate_dps, angle_deg, 0.01)
    assert result[1010:1990].all()
    assert not result[:800].any()
    assert np.array_equal(is_at_limit(-rate_dps, -angle_deg, 0.01), result)


def test_counts_that_were_rounded_to_others_are_uneven() -> None:
    fine, coarse = 360.0 / 1024.0, 360.0 / 410.0
    rounded_deg: Floats = np.rint(np.arange(0.0, 360.0, coarse) / fine) * fine
    assert steps_of(rounded_deg).mean == pytest.approx(coarse, rel=0.01)
    assert steps_of(rounded_deg).scatter == pytest.approx(fine / 12.0**0.5, rel=0.3)
    even_deg: Floats = np.arange(100.0) * fine
    assert steps_of(even_deg).scatter == pytest.approx(0.0, abs=1e-9)
    assert steps_of(np.ones(5)) == (0.0, 0.0)
