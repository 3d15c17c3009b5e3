"""Rotations of many quaternions in numpy; the first dimension counts them."""

import numpy as np

from gyrodrift.values.arrays import Floats

TINY = 1e-12
"""Angle x below which sin(x/2)/x is 1/2, rad. Derived: its relative error, x²/24, is below a double's resolution."""


def rotation_matrices(q: Floats) -> Floats:
    """Matrices (n, 3, 3) of quaternions (n, 4)."""
    w, x, y, z = q.T
    rows = (
        (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)),
        (2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)),
        (2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)),
    )
    return np.array(rows).transpose(2, 0, 1)


def cross_matrices(v: Floats) -> Floats:
    """Matrices (n, 3, 3) whose product with b is v × b, for vectors (n, 3)."""
    matrices = np.zeros((len(v), 3, 3))
    matrices[:, 2, 1], matrices[:, 0, 2], matrices[:, 1, 0] = v.T
    return matrices - matrices.transpose(0, 2, 1)


def products(a: Floats, b: Floats) -> Floats:
    """Quaternion products (n, 4): rotation b followed by rotation a."""
    aw, ax, ay, az = a.T
    bw, bx, by, bz = b.T
    return np.array(
        (
            aw * bw - ax * bx - ay * by - az * bz,
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
        )
    ).T


def from_rotation_vectors(v: Floats) -> Floats:
    """Quaternions (n, 4) of rotation vectors (n, 3) in rad."""
    angle = np.sqrt((v * v).sum(axis=1))
    share = np.where(angle > TINY, np.sin(0.5 * angle) / np.maximum(angle, TINY), 0.5)
    return np.column_stack((np.cos(0.5 * angle), share[:, None] * v))


def to_rotation_vectors(q: Floats) -> Floats:
    """Rotation vectors (n, 3) of at most π rad of quaternions (n, 4)."""
    q = np.where(q[:, :1] < 0.0, -q, q)
    norm = np.sqrt((q[:, 1:] ** 2).sum(axis=1))
    share = np.where(norm > TINY, 2.0 * np.arctan2(norm, q[:, 0]) / np.maximum(norm, TINY), 2.0)
    vectors: Floats = share[:, None] * q[:, 1:]
    return vectors


def conjugates(q: Floats) -> Floats:
    """Inverse rotations (n, 4)."""
    inverse: Floats = q * np.array((1.0, -1.0, -1.0, -1.0))
    return inverse


def unit(q: Floats) -> Floats:
    """Quaternions (n, 4) of norm 1."""
    norms: Floats = np.sqrt((q * q).sum(axis=1, keepdims=True))
    normalized: Floats = q / norms
    return normalized
