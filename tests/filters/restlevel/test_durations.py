"""Rests against spins, levels by chance and loud motions, on numbers by hand."""

from math import pi

import pytest

from gyrodrift.filters.beliefs import SPINS_PER_DPS
from gyrodrift.filters.restlevel.bias_state import Hypothesis
from gyrodrift.filters.restlevel.durations import begin_rest, weigh_gradual_end, weigh_rest
from gyrodrift.filters.restlevel.rate_state import RateWander

STEADY, WANDERING = RateWander(log_odds=-50.0), RateWander(log_odds=50.0, step_dps=0.5)


def begun(
    wander: RateWander = STEADY, odds: float = 0.25, away_dps: float = 0.0, sigma_dps: float = 0.05
) -> Hypothesis:
    """Return a hypothesis of rest with weight 1 and a known bias."""
    h = Hypothesis(weight=1.0)
    begin_rest(h, wander, odds, sigma_dps**2, away_dps)
    return h


def test_levels_by_chance_lie_about_the_bias_where_levels_wander() -> None:
    """Four times the Cauchy density with the typical step as its width."""
    assert begun().chance_density == pytest.approx(0.0, abs=1e-12)
    assert begun(WANDERING).chance_density == pytest.approx(4.0 / (pi * 0.5), rel=1e-6)
    assert begun(WANDERING, away_dps=50.0).chance_density < 0.01 * SPINS_PER_DPS


def test_noisy_motions_are_as_frequent_as_rests() -> None:
    """Odds of 99 for a rest at the start are odds against a spin; the Cauchy density has the noise as its width."""
    assert begun(odds=99.0, sigma_dps=2.0).noisy_density == pytest.approx(99.0 / (pi * 2.0))
    assert begun(odds=0.25, sigma_dps=2.0).noisy_density == pytest.approx(1.0 / (pi * 2.0))


def test_a_quiet_rest_is_weighed_against_spins() -> None:
    h = begun()
    weigh_rest(h, 0.0, 1.0)
    assert h.weight == pytest.approx(0.25 / SPINS_PER_DPS)
    weigh_rest(h, 12.0, 1.0)
    assert h.weight == pytest.approx(0.25 / SPINS_PER_DPS * 2.0**0.25)


def test_weighing_again_replaces_the_weighing_before() -> None:
    h = begun(WANDERING)
    for _ in range(5):
        weigh_rest(h, 3.0, 0.5)
    once = begun(WANDERING)
    weigh_rest(once, 3.0, 0.5)
    assert h.weight == pytest.approx(once.weight)


def test_a_scatter_that_no_sensor_has_speaks_for_a_motion() -> None:
    """A tenth of the odds of a sensor: a tenth of the weight, and nine tenths of the loud motions."""
    h = begun(sigma_dps=2.0)
    weigh_rest(h, 0.0, 0.1)
    assert h.weight == pytest.approx(0.025 / (SPINS_PER_DPS + 0.9 / (pi * 2.0)))


def test_a_gradual_end_is_one_of_a_curve() -> None:
    h = begun(WANDERING)
    weigh_rest(h, 3.0, 1.0)
    before = h.weight
    weigh_gradual_end(h, 3.0, 1.0)
    assert 0.01 / 0.9 < h.weight / before < 0.01 / 0.1
    weigh_rest(h, 3.0, 1.0)
    assert h.weight == pytest.approx(before)
