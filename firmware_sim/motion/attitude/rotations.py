"""Rotations and vectors with their first two derivatives in time: "jets", arrays whose first axis is the derivative.

A rotation has the shape (3, n, 3, 3), a vector (3, n, 3), a scalar (3, n). Products follow the rule of Leibniz, so that
the rates and accelerations of a chain of rotations and links are exact.
"""

from collections.abc import Callable
from math import pi

import numpy as np

from firmware_sim.effects.effect import Floats

X, Y, Z = range(3)
RAD = pi / 180.0


def product(multiply: Callable[[Floats, Floats], Floats], first: Floats, then: Floats) -> Floats:
    """Jet of a bilinear product of two jets."""
    return np.stack(
        [
            multiply(first[0], then[0]),
            multiply(first[1], then[0]) + multiply(first[0], then[1]),
            multiply(first[2], then[0]) + 2.0 * multiply(first[1], then[1]) + multiply(first[0], then[2]),
        ]
    )


def chained(*rotations: Floats) -> Floats:
    """Jet of the product of rotations, from the outermost to the innermost."""
    whole = rotations[0]
    for rotation in rotations[1:]:
        whole = product(np.matmul, whole, rotation)
    return whole


def rotated(rotation: Floats, vector: Floats) -> Floats:
    """Jet of a fixed vector, shape (3,), that a rotation turns."""
    return rotation @ vector


def about(axis: int, angle_deg: Floats) -> Floats:
    """Jet of a rotation about the x, y or z axis; the angle has its derivatives along the first axis, deg/sᵏ."""
    angle, rate, change = angle_deg[:3] * RAD
    sine, cosine = np.sin(angle), np.cos(angle)
    sines = (sine, cosine * rate, cosine * change - sine * rate**2)
    cosines = (cosine, -sine * rate, -sine * change - cosine * rate**2)
    jet = np.zeros((3, len(angle), 3, 3))
    first, second = (axis + 1) % 3, (axis + 2) % 3
    jet[0, :, axis, axis] = 1.0
    for order in range(3):
        jet[order, :, first, first] = jet[order, :, second, second] = cosines[order]
        jet[order, :, second, first] = sines[order]
        jet[order, :, first, second] = -sines[order]
    return jet


def yaw_pitch_roll(yaw_deg: Floats, pitch_deg: Floats, roll_deg: Floats) -> Floats:
    """Jet of the rotation about z, then the new y, then the new x (aerospace sequence, z up)."""
    return chained(about(Z, yaw_deg), about(Y, pitch_deg), about(X, roll_deg))


def body_rates_dps(rotation: Floats) -> Floats:
    """Rates about the axes of the sensor, deg/s, shape (n, 3): Ω = Rᵀ·dR/dt."""
    skew = np.swapaxes(rotation[0], 1, 2) @ rotation[1]
    rates = np.stack([skew[:, Z, Y], skew[:, X, Z], skew[:, Y, X]], axis=1)
    dps: Floats = rates / RAD
    return dps


def quaternions(matrices: Floats) -> Floats:
    """Unit quaternions (w, x, y, z) with w ≥ 0 of rotation matrices, shape (n, 4).

    The row with the largest sum keeps its precision at every angle (`Shepperd` 1978).
    """
    m = matrices
    trace = m[:, 0, 0] + m[:, 1, 1] + m[:, 2, 2]
    sums = np.stack([trace, m[:, 0, 0], m[:, 1, 1], m[:, 2, 2]], axis=1)
    off = (m[:, 2, 1] - m[:, 1, 2], m[:, 0, 2] - m[:, 2, 0], m[:, 1, 0] - m[:, 0, 1])
    xy, xz, yz = m[:, 0, 1] + m[:, 1, 0], m[:, 0, 2] + m[:, 2, 0], m[:, 1, 2] + m[:, 2, 1]
    squares = 1.0 - trace + 2.0 * sums[:, 1:].T
    rows = np.stack(
        [
            np.stack([1.0 + trace, *off], axis=1),
            np.stack([off[0], squares[0], xy, xz], axis=1),
            np.stack([off[1], xy, squares[1], yz], axis=1),
            np.stack([off[2], xz, yz, squares[2]], axis=1),
        ]
    )
    chosen = rows[np.argmax(sums, axis=1), np.arange(len(m))]
    unit = chosen / np.linalg.norm(chosen, axis=1, keepdims=True)
    signed: Floats = np.where(unit[:, :1] < 0.0, -unit, unit)
    return signed


def twist_deg(quaternion: Floats, near_deg: Floats) -> Floats:
    """Twist of rotations about the vertical, the turn that is nearest to `near_deg`, degrees, shape (n,)."""
    twist = 2.0 * np.arctan2(quaternion[:, 3], quaternion[:, 0]) / RAD
    near: Floats = near_deg + np.mod(twist - near_deg + 180.0, 360.0) - 180.0
    return near
