"""The bounded velocity: a motion that returns shows the tilt, because a wrong tilt makes the velocity grow.

Vehicles do not return. Their velocity counts less, and hardly at all about the vertical while they stay level.
"""

import numpy as np

from gyrodrift.filters.attitude.batch import rotation_matrices
from gyrodrift.filters.attitude.block import RAD
from gyrodrift.filters.attitude.hypotheses import BIAS, HEADING, STATES, VELOCITY, Hypotheses
from gyrodrift.filters.attitude.measure import measure, measure_in_part
from gyrodrift.filters.attitude.model import AttitudeState
from gyrodrift.values.arrays import Floats

START_SPEED = 0.5
"""Standard deviation of the velocity at the first sample, m/s.
Measured: recordings of five rigs, median heading error."""

SPEED, CORRELATION_S = 1.0, 0.5
"""Standard deviation of the bounded velocity, m/s, and its correlation time, s. Measured: as above, and inclination."""

SLOW_S, SPEED_MEMORY_S = 2.0, 10.0
"""Averaging times of the velocity and of its square, s. Chosen: a hand returns within 2 s and a vehicle does not."""

SPEED_FACTOR, MOST_FACTOR = 6.0, 40.0
"""Variance of the velocity's measurement over that of the slow velocity, and its largest factor. A vehicle's velocity
stays correlated for longer than 0.5 s. Chosen: on simulated cars with stops, larger factors gained nothing."""

UP_MEMORY_S, UP_VAR = 20.0, (15.0 * RAD) ** 2
"""Averaging time of the vertical in the sensor, s, and the variance of the vertical, rad², at which half of the gains
about it count. Chosen: tilts of vehicles are wrong by 5°, and hands turn by 30°."""

LIKELIHOOD_SHARE = 0.1
"""Weight of the velocity in the probabilities of hypotheses. Blocks within a second are one piece of evidence, and a
motion that is not bounded prefers the hypothesis that knows least. Chosen."""

OUTLIER = 9.0
"""Squared distance of a velocity from 0 beyond which its measurement counts less (Huber). Derived: 3², 3 sigma."""


def forget_velocity(h: Hypotheses) -> None:
    """Velocity as at the first sample: without acceleration it is unknown, and shows no tilt."""
    h.velocity = np.zeros_like(h.velocity)
    h.cov[:, VELOCITY, :] = 0.0
    h.cov[:, :, VELOCITY] = 0.0
    h.cov[:, VELOCITY, VELOCITY] = START_SPEED**2 * np.eye(3)


def bound_velocity(s: AttitudeState, seconds: float, *, is_still: bool) -> None:
    """Measure a velocity of 0 that is off by the speed of bounded motions; weigh the hypotheses by it.

    `is_still` during a rest candidate: rest and even turn predict the same accelerations, and no weight changes.
    """
    h, factor = s.hypotheses, speed_factor(s, seconds)
    share = share_of_vertical(s, seconds, factor)
    error, variance = np.zeros((len(h.weight), STATES)), factor * SPEED**2 * 2.0 * CORRELATION_S / seconds
    noise = variance * outlier_factors(h, variance)[:, None, None] * np.eye(3)
    if share < 1.0:
        log_likelihood = measure_in_part(h, error, VELOCITY, -h.velocity, noise, vertical_shares(h, share))
    else:
        log_likelihood = measure(h, error, VELOCITY, -h.velocity, noise)
    h.correct(error)
    if len(h.weight) > 1 and not is_still:
        weight = h.weight * np.exp(LIKELIHOOD_SHARE / factor * (log_likelihood - log_likelihood.max()))
        h.weight = weight / weight.sum()


def speed_factor(s: AttitudeState, seconds: float) -> float:
    """Factor on the variance of the bounded velocity, 1 for motions that return, by the velocity's slow part."""
    m = s.motion
    m.slow_velocity = m.slow_velocity + (s.hypotheses.velocity[0] - m.slow_velocity) * min(1.0, seconds / SLOW_S)
    squared = float((m.slow_velocity**2).mean())
    m.speed_var += (squared - m.speed_var) * min(1.0, seconds / SPEED_MEMORY_S)
    return min(max(1.0, SPEED_FACTOR * m.speed_var / SPEED**2), MOST_FACTOR)


def share_of_vertical(s: AttitudeState, seconds: float, factor: float) -> float:
    """Share of the gains about the vertical: small for a vehicle (`factor` above 1) that stays level.

    A level device cannot show them. A wrong tilt that changes would seem to.
    """
    m = s.motion
    up = rotation_matrices(s.hypotheses.q[:1])[0, 2]
    m.mean_up = m.mean_up + (up - m.mean_up) * min(1.0, seconds / UP_MEMORY_S) if m.mean_up.any() else up
    variance = max(1e-6, 1.0 - float(m.mean_up @ m.mean_up))
    return variance * variance / (variance * variance + UP_VAR * UP_VAR * min(1.0, factor - 1.0))


def vertical_shares(h: Hypotheses, share: float) -> Floats:
    """Factors (n, 21, 21) on gains: `share` for the heading, and for bias and scale about the vertical."""
    up = rotation_matrices(h.q)[:, 2, :]
    level = np.eye(3) - (1.0 - share) * up[:, :, None] * up[:, None, :]
    shares = np.zeros((len(up), STATES, STATES)) + np.eye(STATES)
    shares[:, HEADING, HEADING] = share
    shares[:, BIAS, BIAS] = level
    for column in range(3):
        shares[:, 9 + column : 18 : 3, 9 + column : 18 : 3] = level
    return shares


def outlier_factors(h: Hypotheses, variance: float) -> Floats:
    """Factors (n) on the variance of a velocity whose distance from 0 is an outlier."""
    spread = h.cov[:, VELOCITY, VELOCITY] + variance * np.eye(3)
    squared = (h.velocity * np.linalg.solve(spread, h.velocity[:, :, None])[:, :, 0]).sum(axis=1)
    factors: Floats = np.maximum(1.0, squared / OUTLIER)
    return factors
