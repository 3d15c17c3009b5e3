"""Rest or even turn: the regimes of a segment in which gyro and accelerometer keep their means.

Gravity stays constant in the sensor only in a rest and in an even turn about the vertical. The rates about the level
axes are biases in both, and only the vertical component decides. Each hypothesis branches. Later segments and the
velocity decide between the branches.
"""

import numpy as np

from gyrodrift.filters.attitude.batch import rotation_matrices
from gyrodrift.filters.attitude.block import RAD
from gyrodrift.filters.attitude.evidence import ALIGNMENT, MODEL_ERROR, SAME_RATE, must_agree, weigh
from gyrodrift.filters.attitude.hypotheses import BIAS, HEADING, REST, STATES, TURN, VELOCITY, Hypotheses
from gyrodrift.filters.attitude.measure import innovations, measure
from gyrodrift.filters.attitude.model import AttitudeCoefficients
from gyrodrift.filters.attitude.rests import QUIET, RestCandidate
from gyrodrift.filters.beliefs import MAX_RAMP_S, duration_odds
from gyrodrift.values.arrays import Floats

REST_BIAS = 0.045 * RAD
"""Error of a rest's mean beside its scatter, rad/s. Measured: recordings of five rigs, median heading error."""

NOISY_REST = 0.4 * RAD
"""Error of the mean of a noisy rest once a quiet one is measured, rad/s: it may be a bend. Measured: as above."""

SPREAD_WEIGHT = 2.0
"""Weight of the scatter of block means in the error of their mean. Measured: as above."""

GATE = 27.0
"""Squared distance, of three components, beyond which a later window does not belong to the rest. Derived: 3·3²,
3 sigma each."""

QUIET_SPEED, NOISY_SPEED = 0.05, 0.1
"""Standard deviation of the velocity in quiet and in noisy rests, m/s. Measured: as above."""

FREE_RATE = 1000.0 * RAD
"""Standard deviation of the vertical rate of an even turn as a measurement of the bias, rad/s. Chosen: so large that it
measures none."""

CERTAIN = 9.0
"""Logarithm of odds from which on a hypothesis does not branch. Chosen: 1 : 8000."""

LARGEST_LOG = 60.0
"""Largest distance of a logarithm of odds from the highest that counts. Chosen: its exp() is far below `LEAST_WEIGHT`,
and above 0."""


def branch(c: AttitudeCoefficients, h: Hypotheses, m: RestCandidate, odds: float, turn_on_bias: Floats) -> Hypotheses:
    """Hypotheses after a new candidate: of rest, which measure the bias, and of no rest.

    `odds` are the prior odds of a rest, and `turn_on_bias` (3) is the mean of the prior of an unknown bias, rad/s.
    """
    drifted = with_drift(h, np.where(must_agree(h, m), 0.0, c.drift_rate))
    log_rest, log_motion = np.empty(len(h.weight)), np.empty(len(h.weight))
    for i in range(len(h.weight)):
        evidence = weigh(c, drifted, i, m, _vertical(h, i, m), np.diag(test_variances(h, m)[i]), turn_on_bias)
        log_rest[i] = evidence.rest + np.log(odds + 1e-300)
        log_motion[i] = evidence.motion
    most = max(log_rest.max(), log_motion.max())
    is_rest, is_motion = log_rest - log_motion > -CERTAIN, log_rest - log_motion < CERTAIN
    rests, motions = drifted.select(is_rest), h.select(is_motion)
    rests.weight = rests.weight * np.exp(np.maximum(log_rest - most, -LARGEST_LOG)[is_rest])
    motions.weight = motions.weight * np.exp(np.maximum(log_motion - most, -LARGEST_LOG)[is_motion])
    rests.regime[:], motions.regime[:] = REST, TURN
    if len(rests.weight):
        widen(rests, m.gyro - rests.bias, rest_variances(rests, m, 1.0))
        measure_rest(rests, m, 1.0)
    if len(motions.weight):
        measure_turn(motions, m)
    return rests.joined(motions)


def with_drift(h: Hypotheses, drift_rate: Floats) -> Hypotheses:
    """The hypotheses with the fastest drift of their biases (n) since the last rest, rad/s², in their covariances.

    The drift grew evenly, so the error of the heading is half of its end value times the time since the rest.
    """
    drifted = h.select(np.arange(len(h.weight)))
    sigma = np.where(h.knows_bias, drift_rate * np.minimum(h.moving_s, MAX_RAMP_S), 0.0)
    reach = np.zeros((len(h.weight), STATES, 3))
    reach[:, BIAS, :] = np.eye(3)
    reach[:, HEADING, :] = -0.5 * h.moving_s[:, None] * rotation_matrices(h.q)[:, 2]
    drifted.cov += (sigma * sigma)[:, None, None] * (reach @ reach.transpose(0, 2, 1))
    return drifted


def _vertical(h: Hypotheses, i: int, m: RestCandidate) -> Floats:
    """Unit vector of the vertical in the sensor: the mean acceleration, or the attitude without one."""
    up: Floats = m.up
    return up if up.any() else rotation_matrices(h.q[i : i + 1])[0, 2]


def mean_variances(m: RestCandidate) -> Floats:
    """Variances (3) of the mean rates of a candidate as a bias, (rad/s)²."""
    return m.gyro_var * scatter_share(m) + (0.0 if m.kind is QUIET else (m.kind.bias * REST_BIAS) ** 2)


def test_variances(h: Hypotheses, m: RestCandidate) -> Floats:
    """Variances (n, 3) of the mean rates where hypotheses are tested, (rad/s)².

    A rest that has to agree with a sure bias has the error of any rest.
    """
    agreeing = m.gyro_var * SPREAD_WEIGHT / m.kind.blocks + REST_BIAS**2
    return np.where(must_agree(h, m)[:, None], agreeing, mean_variances(m))


def rest_variances(h: Hypotheses, m: RestCandidate, overlap: float) -> Floats:
    """Covariances (n, 3, 3) of the mean rates of a candidate as measurements of the bias, (rad/s)².

    `overlap` is the factor of a window that contains blocks of an earlier update.
    """
    variance = mean_variances(m)
    extra = np.where(h.knows_bias & (m.kind.blocks > QUIET.blocks), NOISY_REST**2, 0.0)
    return (variance[None, :] + extra[:, None])[:, :, None] * np.eye(3) * overlap


def scatter_share(m: RestCandidate) -> float:
    """Variance of the mean of a window over that of its block means."""
    return SPREAD_WEIGHT / m.kind.blocks * (2.0 if m.kind.blocks <= QUIET.blocks else 5.0)


def measure_rest(h: Hypotheses, m: RestCandidate, overlap: float) -> None:
    """Update hypotheses of rest by the candidate: its mean rates are the bias, and the velocity is 0."""
    variance = rest_variances(h, m, overlap)
    error = np.zeros((len(h.weight), STATES))
    measure(h, error, BIAS, m.gyro - h.bias, variance)
    speed = QUIET_SPEED if m.kind.blocks <= QUIET.blocks else NOISY_SPEED
    measure(h, error, VELOCITY, -h.velocity, speed * speed * np.eye(3))
    h.correct(error)
    h.moving_s = np.zeros(len(h.weight))
    h.knows_bias = h.knows_bias | (m.kind.blocks >= QUIET.blocks)


def measure_turn(h: Hypotheses, m: RestCandidate) -> None:
    """Update hypotheses of an even turn: the rates about the level axes are biases."""
    variance = rest_variances(h, m, 1.0)
    level_var = (MODEL_ERROR * RAD) ** 2 + ALIGNMENT**2 * float(m.gyro @ m.gyro)
    for i in range(len(h.weight)):
        up = _vertical(h, i, m)
        variance[i] += FREE_RATE**2 * np.outer(up, up) + level_var * np.eye(3)
    error = np.zeros((len(h.weight), STATES))
    measure(h, error, BIAS, m.gyro - h.bias, variance)
    h.correct(error)


def widen(h: Hypotheses, off: Floats, variance: Floats) -> None:
    """Widen the bias of hypotheses whose rest is more than 3 sigma away in a component.

    Before the first rest the part is a raw one, and the covariances with the heading grow too. Later the bias has
    jumped.
    """
    spread = np.diagonal(h.cov[:, BIAS, BIAS], axis1=1, axis2=2)
    variance = np.diagonal(variance, axis1=1, axis2=2)
    for i in np.flatnonzero((off * off > 9.0 * (spread + variance)).any(axis=1)):
        if h.knows_bias[i]:
            h.cov[i, BIAS, BIAS] += np.diag(off[i] ** 2)
            continue
        factor = max(1.0, float((off[i] ** 2 / (9.0 * spread[i])).max()))
        carried = h.cov[i][:, BIAS]
        h.cov[i] += (factor - 1.0) * carried @ np.linalg.inv(h.cov[i, BIAS, BIAS]) @ carried.T


def is_same_rest(h: Hypotheses, m: RestCandidate, undone: Floats) -> bool:
    """Whether the rates of a later window fit the bias of the first hypothesis of rest, before it was changed.

    `undone` (3) is the change of the bias after the end of the rest, rad/s.
    """
    rest = h.select(np.flatnonzero(h.regime == REST)[:1])
    if not len(rest.weight):
        return True
    error, variance = np.zeros((1, STATES)), np.diag(m.gyro_var * scatter_share(m) + (SAME_RATE * RAD) ** 2)
    inverse, innovation = innovations(rest, error, BIAS, m.gyro - rest.bias + undone, variance)
    return bool((innovation.transpose(0, 2, 1) @ inverse @ innovation)[0, 0, 0] <= GATE)


def weigh_duration(h: Hypotheses, before_s: float, now_s: float) -> None:
    """Raise the probability of rests as a segment grows longer than even turns last."""
    h.weight = h.weight * np.where(h.regime == REST, duration_odds(now_s) / duration_odds(before_s), 1.0)
    h.weight = h.weight / h.weight.sum()
