"""The Gaussian sum of restlevel: merging, pruning and collapsing, on numbers worked out by hand."""

from dataclasses import replace

import pytest

from gyrodrift.filters.restlevel.bias_state import Hypothesis
from gyrodrift.filters.restlevel.mixture import collapse, is_in_merge_gate, merge_and_prune, moment_matched_merge
from gyrodrift.filters.restlevel.model import RestlevelParams, RestlevelState
from gyrodrift.filters.restlevel.step import coefficients

C = coefficients(RestlevelParams())


def test_a_merge_keeps_the_mean_and_the_covariance_of_both() -> None:
    """A quarter at (0, 0) and three quarters at (4, −4), each with variances 1: what lies between adds 3/16 of 16."""
    h = Hypothesis(weight=0.25, bias_var=1.0, yaw_var=1.0, moving_s=5.0)
    second = Hypothesis(weight=0.75, bias_dps=4.0, yaw_deg=-4.0, bias_var=1.0, yaw_var=1.0, moving_s=2.0)
    moment_matched_merge(h, second)
    assert (h.weight, h.bias_dps, h.yaw_deg, h.moving_s) == (1.0, 3.0, -3.0, 2.0)
    assert (h.bias_var, h.covariance, h.yaw_var) == (4.0, -3.0, 4.0)
    assert second.weight == 0.0


def test_a_merge_averages_what_a_rest_is_weighed_by() -> None:
    h = Hypothesis(weight=0.25, rest_odds=1.0, chance_density=8.0, noisy_density=4.0, odds=2.0)
    moment_matched_merge(h, Hypothesis(weight=0.75, rest_odds=1.0, chance_density=0.0, noisy_density=0.0, odds=6.0))
    assert (h.rest_odds, h.chance_density, h.noisy_density, h.odds) == (1.0, 2.0, 1.0, 5.0)


def test_the_merge_gate_is_the_smaller_sigma() -> None:
    h = Hypothesis(weight=0.5, bias_var=1.0, yaw_var=4.0, knows_bias=True)
    wider = replace(h, bias_var=9.0, yaw_var=9.0)
    assert is_in_merge_gate(h, replace(wider, bias_dps=0.9, yaw_deg=1.9))
    for second in (
        replace(wider, bias_dps=1.1),
        replace(wider, yaw_deg=2.1),
        replace(h, is_at_rest=True),
        replace(h, knows_bias=False),
        replace(h, weight=0.0),
    ):
        assert not is_in_merge_gate(h, second)
        assert not is_in_merge_gate(second, h)


def test_kinds_of_parts_stay_apart_until_a_bias_is_known() -> None:
    """Two that know none have the same bias, and are not the same."""
    h = Hypothesis(weight=0.5, bias_var=1.0)
    assert is_in_merge_gate(h, replace(h, bias_var=2.0))
    assert not is_in_merge_gate(h, replace(h, bias_var=0.01))


def test_variances_leave_out_what_is_improbable() -> None:
    """A spin of 1 % does not widen yaw, one of a third does."""
    for weight, sigma_dps in ((0.01, 1.0), (1.0 / 3.0, 3.0)):
        s = RestlevelState()
        s.hypotheses[0] = Hypothesis(knows_bias=True, weight=1.0 - weight, bias_var=1.0)
        s.hypotheses[1] = Hypothesis(knows_bias=True, weight=weight, bias_var=1.0, bias_dps=6.0)
        collapse(C, s)
        assert s.bias_sigma_dps == pytest.approx(sigma_dps, rel=0.1)


def test_the_least_probable_are_pruned() -> None:
    s = RestlevelState()
    for number, h in enumerate(s.hypotheses):
        h.weight, h.bias_dps, h.bias_var, h.yaw_var = number + 1.0, 10.0 * number, 1.0, 1.0
    merge_and_prune(s)
    assert [h.weight for h in s.hypotheses] == pytest.approx([0.0] * 6 + [k / 57.0 for k in range(7, 13)])


def test_those_that_agree_are_merged_before_any_is_pruned() -> None:
    s = RestlevelState()
    for h in s.hypotheses:
        h.weight, h.bias_var, h.yaw_var = 0.5, 1.0, 1.0
    merge_and_prune(s)
    assert [h.weight for h in s.hypotheses] == [1.0] + [0.0] * 11


def test_collapsed_means_are_by_cubed_probability() -> None:
    s = RestlevelState()
    s.hypotheses[2] = Hypothesis(knows_bias=True, weight=0.8, bias_dps=1.0, yaw_deg=-2.0, bias_var=0.5, is_at_rest=True)
    s.hypotheses[5] = Hypothesis(knows_bias=True, weight=0.2, bias_var=0.5)
    collapse(C, s)
    assert s.bias_dps == pytest.approx(64.0 / 65.0)
    assert s.moments.yaw_deg == pytest.approx(-128.0 / 65.0)
    assert (s.confidence, s.rest_probability) == (0.8, 0.8)
    spread = (0.755 * 1.0 + 0.155 * 64.0**2) / 0.91 / 65.0**2
    assert s.bias_sigma_dps**2 == pytest.approx(0.5 + spread)
    assert s.moments.covariance == pytest.approx(-2.0 * spread)
    assert s.moments.yaw_var == pytest.approx(4.0 * spread)


def test_the_covariance_holds_a_ramp_since_the_last_rest_and_yaw_only_that_since_the_zero() -> None:
    """20 s at 0.004 deg/s² with probability 0.3; a zero after 10 s halves the time and keeps the later part of it."""
    ramp_var = 0.3 * 0.08**2
    for travelled_s, reach_s in ((20.0, 10.0), (10.0, 7.5), (0.0, 0.0)):
        s = RestlevelState(travelled_s=travelled_s)
        s.hypotheses[0] = Hypothesis(weight=1.0, knows_bias=True, moving_s=20.0)
        collapse(C, s)
        assert s.bias_sigma_dps**2 == pytest.approx(ramp_var)
        assert (s.moments.covariance, s.moments.yaw_var) == pytest.approx((-ramp_var * reach_s, ramp_var * reach_s**2))
