"""Measurements of yaw and of the bias by a second source, for all hypotheses of restlevel at the end of a block.

Each hypothesis is updated as in the probabilistic data association filter (Bar-Shalom and Tse 1975): the measurement is
right or wrong, and the posterior is the mixture of both cases.
"""

from math import sqrt

from gyrodrift.filters.aids.reading import WRONG_SHARE, AidedFilter, AidMoments, AidReading, normal_pdf
from gyrodrift.filters.beliefs import MAJORITY
from gyrodrift.filters.gaps import add_correction
from gyrodrift.filters.restlevel.bias_state import Hypothesis
from gyrodrift.filters.restlevel.kalman import KalmanStep, mix
from gyrodrift.filters.restlevel.mixture import collapse, normalise
from gyrodrift.filters.restlevel.model import RestlevelCoefficients, RestlevelState
from gyrodrift.filters.restlevel.zero import scale_sigma_deg

KNOWN_SHARE = 0.01
"""Variance of the bias, as a share of that at power-on, below which a measurement has made it known. Chosen."""


def has_block_ended(s: RestlevelState) -> bool:
    """Whether the last sample ended a block."""
    return s.block.samples == 0


def rate_dps(s: RestlevelState) -> float:
    """Rate as measured, deg/s."""
    return s.rate_dps


def moments(s: RestlevelState) -> AidMoments:
    """Moments of the Gaussian sum."""
    m = s.moments
    return AidMoments(s.bias_dps, m.yaw_deg, max(0.0, m.bias_var), m.covariance, max(0.0, m.yaw_var))


def add_scale_error(c: RestlevelCoefficients, s: RestlevelState, covariance_var: float) -> None:
    """Keep the yaw error of the scale factor so far in yaw, with a variance beside it, deg²."""
    scale_deg = scale_sigma_deg(c, s)
    added_var = scale_deg * scale_deg + covariance_var
    for h in s.hypotheses:
        h.yaw_var = max(0.0, h.yaw_var + added_var)
        h.checkpoint.yaw_var = max(0.0, h.checkpoint.yaw_var + added_var)
    s.moments.yaw_var = max(0.0, s.moments.yaw_var + added_var)
    s.start_yaw_deg, s.travelled_deg = s.yaw_deg, 0.0


def take(c: RestlevelCoefficients, s: RestlevelState, reading: AidReading) -> float:
    """Update all hypotheses, and give the probability that the measurement is right."""
    right = 0.0
    for h in s.hypotheses:
        if h.weight > 0.0:
            likelihood, share = _update(c, h, reading)
            h.weight *= likelihood
            right += h.weight * share
    total = sum(h.weight for h in s.hypotheses)
    normalise(s)
    before_deg = s.yaw_deg
    collapse(c, s)
    s.yaw_deg = s.moments.yaw_deg
    s.yaw_sigma_deg = sqrt(max(0.0, s.moments.yaw_var))
    s.start_yaw_deg += s.yaw_deg - before_deg
    add_correction(s, s.yaw_deg - before_deg)
    return right / total


def _update(c: RestlevelCoefficients, h: Hypothesis, reading: AidReading) -> tuple[float, float]:
    """Update a hypothesis; likelihood of the measurement, and the probability that it is right."""
    innovation = reading.difference(h.yaw_deg if reading.is_heading else h.bias_dps)
    step, density = _kalman_step(h, reading, innovation)
    likelihood = (1.0 - WRONG_SHARE) * density + WRONG_SHARE / reading.range
    share = (1.0 - WRONG_SHARE) * density / likelihood
    mixed = mix(KalmanStep(0.0, 0.0, h.bias_var, h.covariance, h.yaw_var), step, share)
    h.bias_dps += mixed.bias_dps
    h.yaw_deg += mixed.yaw_deg
    h.bias_var, h.covariance, h.yaw_var = mixed.bias_var, mixed.covariance, mixed.yaw_var
    h.checkpoint.yaw_deg += mixed.yaw_deg
    h.checkpoint.yaw_var, h.checkpoint.covariance = h.yaw_var, h.covariance
    if share > MAJORITY:
        h.moving_s = h.checkpoint.moving_s = 0.0
        h.knows_bias = h.knows_bias or h.bias_var < KNOWN_SHARE * c.turn_on_var
    return likelihood, share


def _kalman_step(h: Hypothesis, reading: AidReading, innovation: float) -> tuple[KalmanStep, float]:
    """Kalman update of a hypothesis if the measurement is right, and the density of the innovation."""
    if reading.is_heading:
        known_var = max(0.0, h.yaw_var - reading.shared_var)
        most = sqrt(max(0.0, h.bias_var) * known_var)
        with_bias, with_yaw = max(-most, min(h.covariance - reading.shared_covariance, most)), known_var
    else:
        known_var = h.bias_var
        with_bias, with_yaw = h.bias_var, h.covariance
    variance = known_var + reading.own_var + reading.variance
    bias_gain, yaw_gain = with_bias / variance, with_yaw / variance
    taken = min(1.0, max(0.0, 1.0 - reading.own_var / known_var) * variance / known_var) if known_var > 0.0 else 0.0
    step = KalmanStep(
        bias_gain * innovation,
        yaw_gain * innovation,
        max(0.0, h.bias_var - taken * bias_gain * with_bias),
        h.covariance - taken * bias_gain * with_yaw,
        max(0.0, h.yaw_var - taken * yaw_gain * with_yaw),
    )
    return step, normal_pdf(innovation, variance)


AIDED = AidedFilter(has_block_ended, rate_dps, moments, take, add_scale_error)
"""How restlevel takes measurements."""
