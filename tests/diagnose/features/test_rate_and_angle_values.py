"""Numbers that a rate and an angle take."""

import numpy as np
import pytest
from features_support import AT_REST, FACTS, TRUE_DEG, TRUE_DPS, TURNING, observed, observed_beside, white

from gyrodrift.diagnose.features.sample_values import smallest

LSB = FACTS.dps_per_lsb
NOISE = white(0.2)


def test_a_rate_in_coarser_steps_is_seen() -> None:
    step = 16.0 * LSB
    result = observed(np.round((TRUE_DPS + NOISE) / step) * step).values()
    assert result["rate_step"] == pytest.approx(4.0)


def test_a_dead_band_leaves_zeros_and_no_small_rates() -> None:
    rate_dps = np.round((TRUE_DPS + white(0.4)) / LSB) * LSB
    dead = np.where(np.abs(rate_dps) < 256.0 * LSB, 0.0, rate_dps)
    near = np.abs(dead) < 3.0
    result = observed(dead).values()
    assert result["zero_share"] == pytest.approx(np.sqrt(np.count_nonzero(dead[near] == 0.0) / np.count_nonzero(near)))
    # 48 % of normal numbers lie within 0.64 sigmas, and nearly all rates below 3 deg/s are at rest.
    assert result["zero_share"] == pytest.approx(np.sqrt(0.478), abs=0.02)
    assert result["least_rate"] == pytest.approx(8.0, abs=0.1)


@pytest.mark.parametrize("drift_dps", [0.01, 0.03])
def test_a_rate_that_drifts_through_zero_has_no_zeros_too_many(drift_dps: float) -> None:
    rate_dps = TRUE_DPS + white(0.003) + drift_dps * np.sin(np.linspace(0.0, 100.0, len(TRUE_DPS)))
    result = observed(np.round(rate_dps / LSB) * LSB).values()
    assert np.count_nonzero(np.round(rate_dps / LSB) == 0.0) > 20
    assert result["zero_share"] == pytest.approx(0.0, abs=0.03)


def test_small_rates_that_a_ramp_may_step_over_are_not_looked_at() -> None:
    for least in (1.0, 20.0):
        rate_dps = np.where(AT_REST, least * LSB, TRUE_DPS)
        assert observed(rate_dps).values()["least_rate"] == pytest.approx(np.log2(80.0))


def test_repeated_samples_are_seen_where_they_are() -> None:
    rate_dps = TRUE_DPS + NOISE
    kept = np.flatnonzero(TURNING)[::10]
    rate_dps[kept] = rate_dps[kept - 1]
    result = observed(rate_dps).values()
    assert result["equal_moving"] == pytest.approx(np.sqrt(0.1), rel=0.05)
    assert result["equal_rest"] < 0.1


def test_a_rate_that_is_cut_off_does_not_reach() -> None:
    result = observed(np.clip(TRUE_DPS, -60.0, 60.0)).values()
    assert result["reach"] == pytest.approx(np.log(61.0 / 91.0), abs=0.01)
    assert observed(TRUE_DPS).values()["reach"] == pytest.approx(0.0, abs=0.01)


def test_a_coarse_angle_is_seen() -> None:
    result = observed_beside(TRUE_DPS + NOISE, TRUE_DEG, cpr=36_000).values()
    assert result["angle_step"] == pytest.approx(np.log2(10.0), abs=1e-6)


@pytest.mark.parametrize("speed_dps", [20.0, 36.0, 90.0])
@pytest.mark.parametrize("ramp", [1, 10, 25])
def test_an_even_spin_that_comes_by_every_tenth_count_says_nothing_of_a_step(speed_dps: float, ramp: int) -> None:
    rate_dps = np.minimum(np.maximum(np.arange(len(TRUE_DPS)) - 1000.0, 0.0) / ramp, 1.0) * speed_dps
    angle_deg = np.round(0.01 * (np.cumsum(rate_dps) - 0.5 * rate_dps), 2)
    result = observed_beside(rate_dps + NOISE, angle_deg, cpr=36_000)
    assert result.values()["angle_step"] == pytest.approx(0.0, abs=0.15)


@pytest.mark.parametrize(("jump_deg", "least", "most"), [(3.0, 3.0, 4.5), (0.1, 0.2, 0.25)])
def test_jumps_of_the_angle_have_a_power(jump_deg: float, least: float, most: float) -> None:
    """Four in 200 s: of 3 deg, as much as one jump of 3.3 deg in each minute; of 0.1 deg, nothing that matters."""
    rate_dps, angle_deg = TRUE_DPS + white(0.02), np.cumsum(TRUE_DPS) * 0.01
    for position, sign in ((2000, 1), (6000, -1), (9000, 1), (19_000, 1)):
        angle_deg[position:] += sign * jump_deg
    result = observed_beside(rate_dps, angle_deg).values()
    assert least < np.exp(0.5 * result["slip_power"]) < most


def test_an_angle_that_scatters_is_seen() -> None:
    noise = 0.01 * white(1.0, 8)
    result = observed_beside(TRUE_DPS, np.cumsum(TRUE_DPS) * 0.01 + noise).values()
    assert np.exp(0.5 * result["angle_noise"]) == pytest.approx(0.01, rel=0.1)


@pytest.mark.parametrize(("sizes", "least"), [([5.0], 5.0), ([3.0, 2.0], 2.0), ([9.0, 1.0, 2.0, 3.0, 4.0], 3.0)])
def test_the_smallest_is_the_third(sizes: list[float], least: float) -> None:
    assert smallest(np.array(sizes)) == least


def test_a_constant_rate_has_numbers() -> None:
    result = observed(np.zeros(len(TRUE_DPS))).values()
    assert (result["equal_rest"], result["zero_share"], result["rate_step"]) == (1.0, 1.0, 0.0)
    assert result["least_rate"] == pytest.approx(np.log2(80.0))
    assert np.count_nonzero(AT_REST) > 7000
