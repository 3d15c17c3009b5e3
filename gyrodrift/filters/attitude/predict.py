"""Prediction of all hypotheses over a block.

The rotation of the block belongs to a reference bias and scale. A hypothesis with another bias or scale corrects it by
the derivatives, to first order.
"""

import numpy as np

from gyrodrift.filters.attitude.batch import (
    conjugates,
    cross_matrices,
    from_rotation_vectors,
    products,
    rotation_matrices,
    to_rotation_vectors,
    unit,
)
from gyrodrift.filters.attitude.block import Integrals
from gyrodrift.filters.attitude.hypotheses import (
    ATTITUDE,
    BIAS,
    FORCE_BIAS,
    HEADING,
    SCALE,
    STATES,
    VELOCITY,
    Hypotheses,
)
from gyrodrift.values.arrays import Floats, Mask

GRAVITY = 9.81
VERTICAL = np.array((0.0, 0.0, 1.0))

TURN_NOISE = 0.001
"""Error of a rotation by what scale and misalignment do not explain, rad per √(rad²/s): of the root of the integral of
the squared rate. Measured: recordings of five rigs, median heading error."""

TILT_NOISE = 0.0026179938779914944
"""Noise of the two axes that gravity corrects, rad/√s: 0.15 deg. It keeps the horizon from trusting the gyro alone.
Measured: as above."""

ACCEL_NOISE = 0.3
"""Noise of the velocity, m/s/√s: vibration and bias of the accelerometer. Measured: as above."""


def predict(h: Hypotheses, block: Integrals, walk_var: float, noise_var: float, is_held: Mask) -> None:
    """Carry means and covariances over a block whose rotation has the bias and scale of the first hypothesis.

    Parameters
    ----------
    h
        Hypotheses.
    block
        The block.
    walk_var, noise_var
        Random walk of the bias, (rad/s)²/s, and angle random walk, rad²/s.
    is_held
        Hypotheses (n) that stand still: their heading stays.
    """
    bias, scale, before = h.bias[0], h.scale[0], h.q
    start = rotation_matrices(h.q)
    by_bias = block.by_bias @ (np.eye(3) + scale)
    change = (h.scale - scale).reshape(-1, 9) @ block.by_scale.T - (h.bias - bias) @ by_bias.T
    force = block.velocity + 0.5 * np.cross(change, block.velocity) - h.force_bias @ block.by_bias.T
    velocity = (start @ force[:, :, None])[:, :, 0]
    turn = products(from_rotation_vectors(change), block.rotation[None, :])
    h.q = unit(products(h.q, turn))
    if is_held.any():
        h.q = np.where(is_held[:, None], with_headings(h.q, before), h.q)
    h.moving_s = h.moving_s + block.seconds
    h.velocity = h.velocity + velocity - np.array((0.0, 0.0, GRAVITY * block.seconds))
    transition = transitions(start, velocity, block)
    transition[is_held, HEADING, BIAS] = 0.0
    transition[is_held, HEADING, SCALE] = 0.0
    noise = np.zeros((len(start), STATES)) + process_noise(block, walk_var, noise_var)
    noise[is_held, HEADING] = 0.0
    h.cov = transition @ h.cov @ transition.transpose(0, 2, 1) + noise[:, :, None] * np.eye(STATES)


def with_headings(q: Floats, before: Floats) -> Floats:
    """Attitudes (n, 4) of q without their rotation about the vertical since `before` (n, 4)."""
    turn = to_rotation_vectors(products(q, conjugates(before)))
    turn[:, :HEADING] = 0.0
    return unit(products(from_rotation_vectors(-turn), q))


def transitions(start: Floats, velocity: Floats, block: Integrals) -> Floats:
    """Derivatives (n, 21, 21) of the error states at the end of a block by those at its beginning.

    start are the rotation matrices (n, 3, 3) at the beginning, velocity the integrals of the specific force (n, 3) in
    the earth frame. Only its vertical part couples attitude and velocity: through a bounded velocity, the horizontal
    accelerations of a vehicle would show a heading. A rotation that grows evenly over the block tilts the velocity by
    half of its final value.
    """
    transition = np.zeros((len(start), STATES, STATES)) + np.eye(STATES)
    tilt = -cross_matrices(velocity * VERTICAL)
    by_bias, by_scale = -(start @ block.by_bias), start @ block.by_scale
    transition[:, ATTITUDE, BIAS] = by_bias
    transition[:, ATTITUDE, SCALE] = by_scale
    transition[:, VELOCITY, ATTITUDE] = tilt
    transition[:, VELOCITY, FORCE_BIAS] = by_bias
    transition[:, VELOCITY, BIAS] = 0.5 * tilt @ by_bias
    transition[:, VELOCITY, SCALE] = 0.5 * tilt @ by_scale
    return transition


def process_noise(block: Integrals, walk_var: float, noise_var: float) -> Floats:
    """Variances (21) that a block adds."""
    added = np.zeros(STATES)
    added[ATTITUDE] = noise_var * block.seconds + TURN_NOISE**2 * block.squared_turn
    added[:2] += TILT_NOISE**2 * block.seconds
    added[BIAS] = walk_var * block.seconds
    added[VELOCITY] = ACCEL_NOISE**2 * block.seconds
    return added
