"""Zero-velocity updates: the mean rate of a rest measures the bias, and also corrects yaw.

At rest the true angular rate is zero. This is a zero-velocity update (ZUPT); for a gyro alone it is also called a zero
angular rate update (ZARU). Two models describe the change of the bias since the last rest: a rate random walk and a
rate ramp (IEEE Std 952). Each update is made under both of them. The two posteriors are merged into one Gaussian,
weighted by their likelihoods, as in interacting multiple models (Blom and Bar-Shalom 1988).
"""

from math import exp, log, pi
from typing import NamedTuple

from gyrodrift.filters.beliefs import MAX_RAMP_S, RAMP_PROBABILITY
from gyrodrift.filters.restlevel.bias_state import Hypothesis
from gyrodrift.filters.restlevel.model import RestlevelCoefficients

MAX_LOG_ODDS = 700.0
"""Largest argument of exp(). Derived: its value is still a finite double (IEEE 754)."""


class KalmanStep(NamedTuple):
    """Kalman update of a Gaussian over yaw and bias by a measurement of the bias.

    bias_dps, yaw_deg
        Corrections of the mean.
    bias_var, covariance, yaw_var
        Covariance matrix after the update: (deg/s)², deg²/s and deg².
    """

    bias_dps: float
    yaw_deg: float
    bias_var: float
    covariance: float
    yaw_var: float


def kalman_gain(bias_var: float, covariance: float, mean_var: float) -> tuple[float, float]:
    """Gains of a measurement of the bias: for the bias, a share, and for yaw, s."""
    return bias_var / (bias_var + mean_var), covariance / (bias_var + mean_var)


def kalman_step(
    innovation_dps: float, bias_var: float, covariance: float, yaw_var: float, mean_var: float
) -> KalmanStep:
    """Update of a Gaussian over yaw and bias by a block mean at rest with variance `mean_var`."""
    gain, yaw_gain_s = kalman_gain(bias_var, covariance, mean_var)
    return KalmanStep(
        gain * innovation_dps,
        yaw_gain_s * innovation_dps,
        bias_var * (1.0 - gain),
        covariance * (1.0 - gain),
        yaw_var - yaw_gain_s * covariance,
    )


def gaussian_logpdf(x: float, variance: float) -> float:
    """Logarithm of the density of a normal distribution with mean 0."""
    return -0.5 * (x * x / variance + log(2.0 * pi * variance))


def kalman_update(h: Hypothesis, mean_dps: float, mean_var: float, ramp_var: float) -> float:
    """Update a hypothesis by a block mean at rest, under the random-walk model and the ramp model.

    Parameters
    ----------
    h
        Hypothesis, which is changed: the two posteriors are merged by their moments.
    mean_dps, mean_var
        The block mean and its variance, deg/s and (deg/s)².
    ramp_var
        Variance of the change of the bias by a ramp since the last rest, (deg/s)². The change grew linearly, so the
        yaw error is half the change times the time since the rest.

    Returns
    -------
    float
        Logarithm of the likelihood of the block mean.
    """
    innovation_dps = mean_dps - h.bias_dps
    half_s = 0.5 * h.moving_s
    ramp_bias_var, ramp_covariance = h.bias_var + ramp_var, h.covariance - ramp_var * half_s
    ramp_yaw_var = h.yaw_var + ramp_var * half_s * half_s
    walk_logpdf = gaussian_logpdf(innovation_dps, h.bias_var + mean_var)
    ramp_logpdf = gaussian_logpdf(innovation_dps, ramp_bias_var + mean_var)
    walk_odds = exp(max(-MAX_LOG_ODDS, min(walk_logpdf - ramp_logpdf, MAX_LOG_ODDS)))
    evidence = RAMP_PROBABILITY + (1.0 - RAMP_PROBABILITY) * walk_odds  # divided by the likelihood of the ramp
    walk = kalman_step(innovation_dps, h.bias_var, h.covariance, h.yaw_var, mean_var)
    ramp = kalman_step(innovation_dps, ramp_bias_var, ramp_covariance, ramp_yaw_var, mean_var)
    posterior = mix(walk, ramp, RAMP_PROBABILITY / evidence)
    h.bias_dps += posterior.bias_dps
    h.yaw_deg += posterior.yaw_deg
    h.bias_var, h.covariance, h.yaw_var = posterior.bias_var, posterior.covariance, posterior.yaw_var
    return ramp_logpdf + log(evidence)


def first_kalman_update(c: RestlevelCoefficients, h: Hypothesis, mean_dps: float, mean_var: float) -> float:
    """Update a hypothesis at the beginning of a rest; return the logarithm of the likelihood of the mean.

    A hypothesis without a rest has the prior of the turn-on bias: a Gaussian of typical parts, and a wide Gaussian.
    Both have its mean: 0, or the last bias before a restart.
    """
    if h.knows_bias:
        ramp_dps = c.rate_ramp_dps_s * min(h.moving_s, MAX_RAMP_S)
        log_likelihood = kalman_update(h, mean_dps, mean_var, ramp_dps * ramp_dps)
    else:
        log_likelihood = kalman_update(h, mean_dps, mean_var, 0.0)
        h.knows_bias = True
    h.moving_s = 0.0
    return log_likelihood


def mix(first: KalmanStep, second: KalmanStep, share: float) -> KalmanStep:
    """Moments of the mixture of two posteriors; `share` is the weight of the second."""
    apart_dps, apart_deg = second.bias_dps - first.bias_dps, second.yaw_deg - first.yaw_deg
    spread = share * (1.0 - share)
    return KalmanStep(
        first.bias_dps + share * apart_dps,
        first.yaw_deg + share * apart_deg,
        first.bias_var + share * (second.bias_var - first.bias_var) + spread * apart_dps * apart_dps,
        first.covariance + share * (second.covariance - first.covariance) + spread * apart_dps * apart_deg,
        first.yaw_var + share * (second.yaw_var - first.yaw_var) + spread * apart_deg * apart_deg,
    )
