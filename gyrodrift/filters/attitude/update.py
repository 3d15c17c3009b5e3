"""Update of all hypotheses at the end of a block, and the estimate that results."""

from math import degrees, sqrt

import numpy as np

from gyrodrift.filters.attitude.batch import rotation_matrices
from gyrodrift.filters.attitude.block import InertialBlock, Integrals, next_block
from gyrodrift.filters.attitude.hypotheses import BIAS, REST, STATES, VELOCITY, Hypotheses, first_hypothesis
from gyrodrift.filters.attitude.levelling import START_TILT, UNKNOWN_TILT, find_lost_tilt, level_start
from gyrodrift.filters.attitude.measure import measure
from gyrodrift.filters.attitude.mixture import moments, ordered
from gyrodrift.filters.attitude.model import RAD, AttitudeCoefficients, AttitudeState
from gyrodrift.filters.attitude.predict import GRAVITY, predict
from gyrodrift.filters.attitude.quaternion import IDENTITY, Vector, heading_axis, level, multiply
from gyrodrift.filters.attitude.rests import add_block
from gyrodrift.filters.attitude.segments import follow_rest
from gyrodrift.filters.attitude.yaw import unwrap_headings
from gyrodrift.mount import with_heading

START_SPEED = 0.5
"""Standard deviation of the velocity at the first sample, m/s.
Measured: recordings of five rigs, median heading error."""

GYRO_NOISE = 0.02 * RAD
"""Angle random walk of a gyro that has not been at rest, rad/√s. Measured: as above."""

SPEED, CORRELATION_S = 0.7, 0.5
"""Standard deviation of the bounded velocity, m/s, and its correlation time, s. Measured: as above."""

SLOW_S, SPEED_MEMORY_S = 2.0, 10.0
"""Averaging times of the velocity and of its square, s. A hand returns within 2 s and a vehicle does not. Chosen."""

SPEED_FACTOR, MOST_FACTOR = 6.0, 40.0
"""Variance of the velocity's measurement over that of the slow velocity, and its largest factor. A vehicle's velocity
stays correlated for longer than 0.5 s. Chosen: on simulated cars with stops, larger factors gained nothing."""

LIKELIHOOD_SHARE = 0.1
"""Weight of the velocity in the probabilities of hypotheses: blocks within a second are one piece of evidence, and a
motion that is not bounded prefers the hypothesis that knows least. Chosen."""

OUTLIER = 9.0
"""Squared distance of a velocity from 0 beyond which its measurement counts less: 3 sigma (Huber)."""

GAP_RATE = 10.0 * RAD
"""Standard deviation of the unknown rate in a gap, rad/s. Chosen: half the rates of the recordings are below it."""


def begin(c: AttitudeCoefficients, s: AttitudeState, accel: Vector) -> None:
    """First sample: level by its acceleration; the heading is `yaw_deg`, 0 unless an earlier filter had another yaw."""
    h = first_hypothesis()
    has_accel = accel[0] == accel[0]
    s.start_q = with_heading(level(*accel) if has_accel else IDENTITY, s.yaw_deg)
    h.yaw_deg[0] = s.yaw_deg
    h.q[0] = s.start_q
    diagonal = np.zeros(STATES)
    diagonal[:2] = (START_TILT if has_accel else UNKNOWN_TILT) ** 2
    diagonal[BIAS] = c.bias_sigma**2
    diagonal[VELOCITY] = START_SPEED**2
    diagonal[9:] = (c.scale_sigma**2 * np.eye(3) + c.cross_sigma**2 * (1.0 - np.eye(3))).ravel()
    h.cov[0] = np.diag(diagonal)
    s.hypotheses, s.noise_var, s.block = h, GYRO_NOISE**2, InertialBlock()
    publish(s)


def end_block(c: AttitudeCoefficients, s: AttitudeState, block: Integrals) -> None:
    """Update all hypotheses by a finished block, and begin the next one."""
    h = s.hypotheses
    h.yaw_deg = h.yaw_deg + (s.yaw_deg - s.start_yaw_deg)
    is_blind = s.block.is_clipped or not np.isfinite(block.velocity).all()
    usable = with_gravity(h, block) if is_blind else block
    predict(h, usable, h.bias[0].copy(), h.scale[0].copy(), c.walk_var, s.noise_var)
    if s.block.gap_s > 0.0:
        forget_gap(s)
    if is_blind:
        forget_velocity(h)
    else:
        find_lost_tilt(s, block)
        level_start(s, block)
        bound_velocity(h, block.seconds, speed_factor(s, block.seconds), is_still=s.segment.blocks > 0)
    add_block(s.windows, block)
    follow_rest(c, s)
    s.hypotheses = ordered(s.hypotheses)
    unwrap_headings(s.hypotheses)
    publish(s)
    s.block = next_block(s.hypotheses.bias[0], s.hypotheses.scale[0])


def with_gravity(h: Hypotheses, block: Integrals) -> Integrals:
    """The block with gravity alone as its specific force."""
    up = rotation_matrices(h.q[:1])[0, 2]
    return block._replace(velocity=GRAVITY * block.seconds * up)


def forget_velocity(h: Hypotheses) -> None:
    """Velocity as at the first sample: without acceleration it is unknown, and shows no tilt."""
    h.velocity = np.zeros_like(h.velocity)
    h.cov[:, VELOCITY, :] = 0.0
    h.cov[:, :, VELOCITY] = 0.0
    h.cov[:, VELOCITY, VELOCITY] = START_SPEED**2 * np.eye(3)


def forget_gap(s: AttitudeState) -> None:
    """Widen the attitude by the unknown turn in a gap, and forget windows and velocity."""
    turn = min(GAP_RATE * s.block.gap_s, np.pi)
    s.hypotheses.cov[:, :3, :3] += turn * turn * np.eye(3)
    s.windows.blocks = 0
    forget_velocity(s.hypotheses)


def speed_factor(s: AttitudeState, seconds: float) -> float:
    """Factor on the variance of the bounded velocity, 1 for motions that return, by the velocity's slow part."""
    s.slow_velocity = s.slow_velocity + (s.hypotheses.velocity[0] - s.slow_velocity) * min(1.0, seconds / SLOW_S)
    squared = float((s.slow_velocity**2).mean())
    s.speed_var += (squared - s.speed_var) * min(1.0, seconds / SPEED_MEMORY_S)
    return min(max(1.0, SPEED_FACTOR * s.speed_var / SPEED**2), MOST_FACTOR)


def bound_velocity(h: Hypotheses, seconds: float, factor: float, *, is_still: bool) -> None:
    """Measure a velocity of 0 that is off by the speed of bounded motions; weigh the hypotheses by it.

    `is_still` during a rest candidate: rest and even turn predict the same accelerations, and no weight changes.
    """
    error, variance = np.zeros((len(h.weight), STATES)), factor * SPEED**2 * 2.0 * CORRELATION_S / seconds
    spread = h.cov[:, VELOCITY, VELOCITY] + variance * np.eye(3)
    squared = (h.velocity * np.linalg.solve(spread, h.velocity[:, :, None])[:, :, 0]).sum(axis=1)
    excess = np.maximum(1.0, squared / OUTLIER)[:, None, None]
    log_likelihood = measure(h, error, VELOCITY, -h.velocity, variance * excess * np.eye(3))
    h.correct(error)
    if len(h.weight) > 1 and not is_still:
        share = LIKELIHOOD_SHARE / factor
        weight = h.weight * np.exp(share * (log_likelihood - log_likelihood.max()))
        h.weight = weight / weight.sum()


def publish(s: AttitudeState) -> None:
    """Write the Gaussian sum as the estimate of the last sample."""
    h = s.hypotheses
    m = moments(h)
    half = 0.5 * m.heading
    w, x, y, z = h.q[0].tolist()
    s.start_q = s.q = multiply((float(np.cos(half)), 0.0, 0.0, float(np.sin(half))), (w, x, y, z))
    s.start_yaw_deg = s.yaw_deg = float(h.yaw_deg[0]) + degrees(m.heading)
    s.yaw_sigma_deg = degrees(sqrt(max(m.heading_var, 0.0)))
    s.tilt_sigma_deg = degrees(sqrt(max(m.tilt_var, 0.0)))
    axis = np.array(heading_axis(s.q))
    x, y, z = np.degrees(m.bias).tolist()
    s.bias_xyz_dps = (x, y, z)
    s.bias_dps = degrees(float(axis @ m.bias))
    s.bias_sigma_dps = degrees(sqrt(max(float(axis @ m.bias_cov @ axis), 0.0)))
    s.rest_probability = float(h.weight[h.regime == REST].sum()) if s.segment.blocks > 0 else 0.0
    s.confidence = float(h.weight[0])
