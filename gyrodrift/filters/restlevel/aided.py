"""Measurements of yaw and of the bias by a second source, for all hypotheses of restlevel at the end of a block.

Each hypothesis is updated as in the probabilistic data association filter (Bar-Shalom and Tse 1975): the measurement is
right or wrong, and the posterior is the mixture of both cases. If it is right, the bias has walked or followed a ramp
since the last measurement, as at a rest.
"""

from math import sqrt

from gyrodrift.filters.aids.reading import WRONG_SHARE, AidedFilter, AidMoments, AidReading, normal_pdf
from gyrodrift.filters.gaps import CORRECTION_DEG
from gyrodrift.filters.restlevel.bias_state import Hypothesis
from gyrodrift.filters.restlevel.kalman import MAX_RAMP_S, RAMP_PROBABILITY, KalmanStep, mix
from gyrodrift.filters.restlevel.mixture import collapse, normalise
from gyrodrift.filters.restlevel.model import RestlevelCoefficients, RestlevelState
from gyrodrift.filters.restlevel.zero import scale_sigma_deg

KNOWN_SHARE = 0.01
"""Variance of the bias, as a share of that at power-on, below which a measurement has made it known. Chosen."""

MEASURED = 0.5
"""Probability of a right measurement from which on the bias counts as measured."""


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
    before_deg, before_step_deg = s.yaw_deg, s.correction_deg
    collapse(c, s)
    s.yaw_deg = s.moments.yaw_deg
    s.yaw_sigma_deg = sqrt(max(0.0, s.moments.yaw_var))
    s.start_yaw_deg += s.yaw_deg - before_deg
    s.correction_deg += s.yaw_deg - before_deg
    s.corrections += int(abs(s.correction_deg) > CORRECTION_DEG >= abs(before_step_deg))
    return right / total


def _update(c: RestlevelCoefficients, h: Hypothesis, reading: AidReading) -> tuple[float, float]:
    """Update a hypothesis; likelihood of the measurement, and the probability that it is right."""
    ramp_dps = 0.0 if h.is_at_rest or not h.knows_bias else c.rate_ramp_dps_s * min(h.moving_s, MAX_RAMP_S)
    innovation = reading.difference(h.yaw_deg if reading.is_heading else h.bias_dps)
    before = KalmanStep(0.0, 0.0, h.bias_var, h.covariance, h.yaw_var)
    walk, walk_density = _step(h, reading, innovation, 0.0)
    ramp, ramp_density = _step(h, reading, innovation, ramp_dps * ramp_dps)
    density = (1.0 - RAMP_PROBABILITY) * walk_density + RAMP_PROBABILITY * ramp_density
    likelihood = (1.0 - WRONG_SHARE) * density + WRONG_SHARE / reading.range
    share = (1.0 - WRONG_SHARE) * density / likelihood
    yaw_deg = h.yaw_deg
    mixed = mix(walk, ramp, RAMP_PROBABILITY * ramp_density / density if density > 0.0 else 0.0)
    mixed = mix(before, mixed, share)
    h.bias_dps += mixed.bias_dps
    h.yaw_deg += mixed.yaw_deg
    h.bias_var, h.covariance, h.yaw_var = mixed.bias_var, mixed.covariance, mixed.yaw_var
    h.checkpoint.yaw_deg += h.yaw_deg - yaw_deg
    h.checkpoint.yaw_var, h.checkpoint.covariance = h.yaw_var, h.covariance
    if share > MEASURED:
        h.moving_s = h.checkpoint.moving_s = 0.0
        h.knows_bias = h.knows_bias or h.bias_var < KNOWN_SHARE * c.turn_on_var
    return likelihood, share


def _step(h: Hypothesis, reading: AidReading, innovation: float, ramp_var: float) -> tuple[KalmanStep, float]:
    """Kalman update after a ramp of the bias with this variance, and the density of the innovation."""
    half_s = 0.5 * h.moving_s
    bias_var, covariance = h.bias_var + ramp_var, h.covariance - ramp_var * half_s
    yaw_var = h.yaw_var + ramp_var * half_s * half_s
    own_bias, own_yaw = reading.with_bias(bias_var), reading.with_yaw(yaw_var)
    if reading.is_heading:
        with_bias, with_yaw = covariance + own_bias, yaw_var + own_yaw
        variance = with_yaw + own_yaw + reading.own_var + reading.variance
    else:
        with_bias, with_yaw = bias_var + own_bias, covariance + own_yaw
        variance = with_bias + own_bias + reading.own_var + reading.variance
    for share, own_var in ((with_bias, bias_var), (with_yaw, yaw_var)):  # no variance falls below 0
        variance = max(variance, share * share / own_var) if own_var > 0.0 else variance
    bias_gain, yaw_gain = with_bias / variance, with_yaw / variance
    step = KalmanStep(
        bias_gain * innovation,
        yaw_gain * innovation,
        max(0.0, bias_var - bias_gain * with_bias),
        covariance - bias_gain * with_yaw,
        max(0.0, yaw_var - yaw_gain * with_yaw),
    )
    return step, normal_pdf(innovation, variance)


AIDED = AidedFilter(has_block_ended, rate_dps, moments, take, add_scale_error)
"""How restlevel takes measurements."""
