"""Zero-velocity updates of restlevel, on numbers worked out by hand."""

from math import exp, log, pi

import pytest

from gyrodrift.filters.restlevel.bias_state import Hypothesis
from gyrodrift.filters.restlevel.kalman import gaussian_logpdf, kalman_step, kalman_update


def test_a_step_shares_the_innovation_by_the_variances() -> None:
    """Bias and block mean are equally uncertain, so half of the innovation goes to the bias, and to yaw 2/8 of it."""
    result = kalman_step(1.0, bias_var=4.0, covariance=2.0, yaw_var=3.0, mean_var=4.0)
    assert result == (0.5, 0.25, 2.0, 1.0, 2.5)


def test_the_density_is_that_of_a_normal_distribution() -> None:
    assert gaussian_logpdf(0.0, 1.0) == pytest.approx(-0.5 * log(2.0 * pi))
    assert gaussian_logpdf(3.0, 9.0) == pytest.approx(-0.5 - log(3.0) - 0.5 * log(2.0 * pi))


def test_without_a_ramp_both_models_are_one() -> None:
    """The merged posterior is the single step, and the likelihood that of the innovation."""
    h = Hypothesis(weight=1.0, bias_dps=1.0, yaw_deg=10.0, bias_var=4.0, covariance=2.0, yaw_var=3.0)
    log_likelihood = kalman_update(h, 2.0, 4.0, 0.0)
    assert (h.bias_dps, h.yaw_deg) == (1.5, 10.25)
    assert (h.bias_var, h.covariance, h.yaw_var) == (2.0, 1.0, 2.5)
    assert log_likelihood == pytest.approx(-0.5 / 8.0 - 0.5 * log(2.0 * pi * 8.0))


def test_an_even_ramp_has_turned_yaw_by_half_of_it_and_that_is_taken_back() -> None:
    """A bias that is known to a thousandth is off by 1 deg/s after 10 s: a ramp, which has turned yaw by 5 deg."""
    h = Hypothesis(weight=1.0, bias_var=1e-6, moving_s=10.0)
    log_likelihood = kalman_update(h, 1.0, 1e-6, 1.0)
    assert h.bias_dps == pytest.approx(1.0, abs=1e-5)
    assert h.yaw_deg == pytest.approx(-5.0, abs=1e-4)
    assert log_likelihood == pytest.approx(log(0.3) - 0.5 - 0.5 * log(2.0 * pi), abs=1e-5)


def test_both_models_are_merged_by_their_likelihoods() -> None:
    h = Hypothesis(weight=1.0, bias_var=1.0)
    log_likelihood = kalman_update(h, 0.0, 1.0, 6.0)  # variances of the innovation: 2 and 8
    walk, ramp = 0.7 / 2.0**0.5, 0.3 / 8.0**0.5
    assert exp(log_likelihood) == pytest.approx((walk + ramp) / (2.0 * pi) ** 0.5)
    assert h.bias_var == pytest.approx((walk * 1.0 / 2.0 + ramp * 7.0 / 8.0) / (walk + ramp))
