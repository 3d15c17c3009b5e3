"""Out-of-catalogue models: shapes that are added to a rate."""

from dataclasses import replace

import numpy as np
import pytest
from simulate_support import HINTS, RATE_HZ, candidate_of, feature, plain, response_at

from gyrodrift.diagnose.features.vector import FEATURES
from gyrodrift.diagnose.simulate.candidates import KINDS, candidates
from gyrodrift.diagnose.simulate.kinds import LAG
from gyrodrift.diagnose.simulate.nuisance import (
    MEMORY_S,
    ORDERS,
    ahead,
    behind_temperature,
    in_angle,
    in_proportion,
    in_rate,
    in_time,
    of_angle_error,
    random_function,
    with_memory,
    with_memory_in_motion,
)


def test_they_are_told_from_effects_by_name_and_make_none() -> None:
    result = candidates(HINTS)
    outside = [item for item in result if item.is_out_of_catalogue]
    assert result[-len(outside) :] == outside
    assert {item.name for item in outside}.isdisjoint(KINDS)
    assert all(item.name.startswith("?") and not item.needs for item in outside)
    assert all(item.group in {item.name, LAG} for item in outside)
    with pytest.raises(LookupError, match="no effect"):
        outside[0].make(1.0)


def test_a_rate_that_leads_is_what_it_is_a_little_later() -> None:
    design = plain().design
    rate_dps = design.motion.rate_dps
    t_s = np.arange(len(rate_dps)) / RATE_HZ
    early_dps = rate_dps + 0.01 * ahead(design, np.random.default_rng(0))
    calm = np.abs(np.gradient(np.gradient(rate_dps))) * RATE_HZ**2 < 50.0
    assert early_dps[calm] == pytest.approx(np.interp(t_s + 0.01, t_s, rate_dps)[calm], abs=0.01)


def test_a_bias_follows_the_temperature_with_play() -> None:
    design = plain().design
    t_s = np.arange(design.samples) / RATE_HZ
    warms = np.minimum(t_s, t_s[-1] - t_s) / 10.0  # up and down again, 0.1 °C each second
    design = replace(design, motion=replace(design.motion, sensor_c=20.0 + warms))
    lag_c = behind_temperature(1.0)(design, np.random.default_rng(0))
    assert lag_c[0] == 0.0
    assert lag_c[round(4.0 * RATE_HZ)] == pytest.approx(0.4, abs=0.01)
    assert lag_c[len(lag_c) // 2 - design.block] == pytest.approx(0.5, abs=1e-6)
    assert lag_c[-1] == pytest.approx(-0.5, abs=0.01)


def test_every_form_is_named_after_a_feature() -> None:
    """A verdict lists this feature first."""
    names = {item.name.removeprefix("?") for item in candidates(HINTS) if item.is_out_of_catalogue}
    assert names <= {item.name for item in FEATURES}


def test_a_random_function_has_a_variance_of_1_and_is_smooth_over_its_length() -> None:
    x = np.linspace(0.0, 100.0, 2001)
    drawn = np.array([random_function(np.random.default_rng(seed), x, 5.0, 5.0) for seed in range(40)])
    assert drawn.mean(axis=1) == pytest.approx(np.zeros(40), abs=1e-9)
    assert np.square(drawn).mean() == pytest.approx(1.0, abs=0.2)
    near, far = (np.mean(drawn[:, step:] * drawn[:, :-step]) / np.square(drawn).mean() for step in (10, 400))
    assert near == pytest.approx(np.exp(-0.5 * 0.1**2), abs=0.01)
    assert abs(far) < 0.2


def test_a_function_of_time_or_rate_is_another_one_in_each_stream() -> None:
    design = plain().design
    first, second = (in_time(design, np.random.default_rng(seed)) for seed in (0, 1))
    assert np.ptp(first - second) > 0.5
    by_rate = in_rate(design, np.random.default_rng(0))
    assert np.median(by_rate[np.abs(design.motion.rate_dps) < 0.01]) == pytest.approx(0.0, abs=0.05)
    order = np.argsort(design.motion.rate_dps)
    assert np.abs(np.diff(by_rate[order])).max() < 0.5


def test_a_function_of_the_angle_has_parts_of_a_turn() -> None:
    design = plain().design
    shape = in_angle(design, np.random.default_rng(0))
    turns = np.deg2rad(np.outer(design.motion.angle_deg, ORDERS))
    basis = np.concatenate([np.sin(turns), np.cos(turns)], axis=1)
    coefficients = np.linalg.lstsq(basis, shape, rcond=None)[0]
    assert basis @ coefficients == pytest.approx(shape, abs=0.02)


def test_the_rate_of_an_angle_error_sums_up_to_that_error() -> None:
    design = plain().design
    error_deg = in_angle(design, np.random.default_rng(0))
    summed_deg = -np.cumsum(of_angle_error(design, np.random.default_rng(0))) / RATE_HZ
    assert summed_deg - summed_deg[0] == pytest.approx(error_deg - error_deg[0], abs=0.1)


def test_a_regressor_moves_the_coefficient_of_its_own() -> None:
    candidate = candidate_of("?moving")
    size = float(candidate.grid_points[-1])
    whole, half = response_at(candidate, size, size / 2.0)[:, 0]
    assert feature(whole, "moving") > 0.0
    assert feature(half, "moving") == pytest.approx(0.5 * feature(whole, "moving"), rel=1e-6)


def test_noise_with_a_memory_forgets() -> None:
    """A variance of 1, and a correlation that falls to 1/e in MEMORY_S."""
    noise = with_memory(plain().design, np.random.default_rng(0))
    late = round(MEMORY_S * RATE_HZ)
    assert np.std(noise) == pytest.approx(1.0, abs=0.15)
    assert np.corrcoef(noise[late:], noise[:-late])[0, 1] == pytest.approx(np.exp(-1.0), abs=0.12)


def test_noise_of_motion_is_silent_at_rest() -> None:
    design = plain().design
    whole, moving = (shape(design, np.random.default_rng(0)) for shape in (with_memory, with_memory_in_motion))
    assert not moving[design.regimes.at_rest].any()
    assert np.array_equal(moving[design.regimes.is_fast], whole[design.regimes.is_fast])
    assert design.regimes.is_fast.any()
    grown = in_proportion(design, np.random.default_rng(0))
    rates_dps = design.motion.rate_dps
    assert np.std(grown) == pytest.approx(float(np.sqrt(np.mean(np.square(rates_dps)))), rel=0.1)


def test_noise_shows_in_what_single_samples_say_and_a_regressor_does_not() -> None:
    """Features of samples are simulated with the one, and taken over with the other."""
    noise, step = candidate_of("?scatter_moving"), candidate_of("?moving")
    changes = [response_at(item, float(item.grid_points[-1]))[0, 0] for item in (noise, step)]
    assert feature(changes[0], "scatter_moving") > 1.0
    assert feature(changes[0], "noise_fast_4") > 0.0
    assert feature(changes[1], "noise_fast_4") == 0.0
