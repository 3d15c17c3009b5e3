"""Samples between two updates, integrated once for all hypotheses.

Forster et al., On-Manifold Preintegration for Real-Time Visual-Inertial Odometry, IEEE Trans. Robotics 33(1), 2017.
"""

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from gyrodrift.filters.attitude.batch import rotation_matrices
from gyrodrift.values.arrays import Floats
from gyrodrift.values.quaternion import IDENTITY, Quaternion, from_rotation_vector, product

RAD = 0.017453292519943295
"""A degree in rad. By definition: π/180."""

SUB_STEP_S = 0.008
"""Length of the steps of the Jacobians and of the velocity, s: 500 deg/s turn by 4° in it, an error of 0.06 % in
gravity. Derived: (4°)²/8."""

Step = tuple[float, float, float, float, float, float, float, float, float, float, float]
"""Seconds; angles of the three axes in deg; velocities along them; rotation (w, x, y, z) at the end."""


@dataclass(slots=True)
class InertialBlock:
    """Sums of a block. Rotations are corrected by the bias and scale of the most probable hypothesis.

    gain, offset
        Rows of the matrix (I + scale)·π/180, and that matrix times the bias, rad/s.
    q
        Rotation since the beginning of the block.
    seconds, samples
        Length, and number of samples.
    step_s, angle, velocity
        Sums since the last step: s, deg of each axis, m/s along each axis.
    steps
        Finished steps.
    still, moving
        Samples that a rest sensor calls still and moving.
    is_clipped
        An acceleration was at the end of its range.
    """

    gain: tuple[float, ...] = (RAD, 0.0, 0.0, 0.0, RAD, 0.0, 0.0, 0.0, RAD)
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)
    q: Quaternion = IDENTITY
    seconds: float = 0.0
    samples: int = 0
    step_s: float = 0.0
    angle: tuple[float, float, float] = (0.0, 0.0, 0.0)
    velocity: tuple[float, float, float] = (0.0, 0.0, 0.0)
    steps: list[Step] = field(default_factory=list)
    still: int = 0
    moving: int = 0
    is_clipped: bool = False


class Integrals(NamedTuple):
    """A finished block, in the frame of the sensor at its beginning.

    seconds
        Length, s.
    rotation
        Quaternion (4) from the end to the beginning.
    velocity
        Integral of the specific force (3), m/s; NaN without acceleration.
    by_bias, by_scale
        Derivatives of the rotation: minus that by the bias (3, 3), s, and that by scale and misalignment (3, 9), rad.
    gyro, accel
        Means of the measured rates (3), rad/s, and accelerations (3), m/s², in the turning sensor.
    squared_turn
        Integral of the squared rate, rad²/s.
    """

    seconds: float
    rotation: Floats
    velocity: Floats
    by_bias: Floats
    by_scale: Floats
    gyro: Floats
    accel: Floats
    squared_turn: float


def add_sample(b: InertialBlock, dt: float, gx: float, gy: float, gz: float, ax: float, ay: float, az: float) -> None:
    """Turn a block by mean rates (deg/s) over dt, with the mean acceleration (m/s², or NaN)."""
    mx, my, mz = gx * dt, gy * dt, gz * dt
    g, o = b.gain, b.offset
    turn = from_rotation_vector(
        g[0] * mx + g[1] * my + g[2] * mz - o[0] * dt,
        g[3] * mx + g[4] * my + g[5] * mz - o[1] * dt,
        g[6] * mx + g[7] * my + g[8] * mz - o[2] * dt,
    )
    b.q = product(b.q, turn)
    x, y, z = b.angle
    b.angle = (x + mx, y + my, z + mz)
    x, y, z = b.velocity
    b.velocity = (x + ax * dt, y + ay * dt, z + az * dt)
    b.seconds += dt
    b.samples += 1
    b.step_s += dt
    if b.step_s >= SUB_STEP_S:
        end_step(b)


def end_step(b: InertialBlock) -> None:
    """Keep the sums since the last step."""
    b.steps.append((b.step_s, *b.angle, *b.velocity, *b.q))
    b.step_s, b.angle, b.velocity = 0.0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)


def integrals(b: InertialBlock) -> Integrals:
    """Rotation, velocity and derivatives of a block with one step or more."""
    if b.step_s > 0.0:
        end_step(b)
    steps = np.array(b.steps)
    seconds, angles, velocities = steps[:, 0], steps[:, 1:4], steps[:, 4:7]
    ends = rotation_matrices(steps[:, 7:])
    middles = 0.5 * ends
    middles[0] += 0.5 * np.eye(3)
    middles[1:] += 0.5 * ends[:-1]
    turns = angles @ np.array(b.gain).reshape(3, 3).T - seconds[:, None] * np.array(b.offset)
    total_s = float(seconds.sum())
    return Integrals(
        seconds=total_s,
        rotation=np.array(b.q) / np.sqrt(np.dot(b.q, b.q)),
        velocity=(middles @ velocities[:, :, None]).sum(axis=0)[:, 0],
        by_bias=(middles * seconds[:, None, None]).sum(axis=0),
        by_scale=(middles[:, :, :, None] * turns[:, None, None, :]).sum(axis=0).reshape(3, 9),
        gyro=np.radians(angles.sum(axis=0)) / total_s,
        accel=velocities.sum(axis=0) / total_s,
        squared_turn=float(((turns * turns).sum(axis=1) / seconds).sum()),
    )


def next_block(bias: Floats, scale: Floats) -> InertialBlock:
    """Empty block, corrected by this bias (3), rad/s, and scale and misalignment (3, 3)."""
    matrix = np.eye(3) + scale
    x, y, z = (matrix @ bias).tolist()
    return InertialBlock(gain=tuple(np.radians(matrix).ravel().tolist()), offset=(x, y, z))
