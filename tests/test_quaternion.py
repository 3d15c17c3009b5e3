"""Rotations and headings against scipy."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from gyrodrift.filters.attitude.batch import from_rotation_vectors, products, rotation_matrices, to_rotation_vectors
from gyrodrift.values.quaternion import (
    Quaternion,
    from_rotation_vector,
    heading_deg,
    level,
    product,
    rotate,
    tilt_deg,
    up_in_sensor,
)


def random_rotations() -> Rotation:
    return Rotation.random(50, rng=np.random.default_rng(1))


def quaternion(rotation: Rotation) -> Quaternion:
    w, x, y, z = rotation.as_quat(scalar_first=True).tolist()
    return (w, x, y, z)


def test_products_rotations_and_matrices_are_those_of_scipy() -> None:
    a, b = random_rotations(), random_rotations()[::-1]
    qa, qb = a.as_quat(scalar_first=True), b.as_quat(scalar_first=True)
    assert rotation_matrices(products(qa, qb)) == pytest.approx((a * b).as_matrix())
    assert np.array(product(quaternion(a[0]), quaternion(b[0]))) == pytest.approx(products(qa, qb)[0])
    assert rotate(quaternion(a[0]), (1.0, 2.0, 3.0)) == pytest.approx(a[0].apply((1.0, 2.0, 3.0)))
    assert up_in_sensor(quaternion(a[0])) == pytest.approx(a[0].inv().apply((0.0, 0.0, 1.0)))


@pytest.mark.parametrize("angle", [0.0, 1e-9, 1e-3, 0.24, 0.26, 3.0])
def test_a_rotation_vector_becomes_its_quaternion(angle: float) -> None:
    vector = angle * np.array((0.6, 0.0, -0.8))
    expected = Rotation.from_rotvec(vector).as_quat(scalar_first=True)
    assert from_rotation_vector(*vector.tolist()) == pytest.approx(expected, abs=1e-8)
    assert from_rotation_vectors(vector[None, :])[0] == pytest.approx(expected, abs=1e-12)
    assert to_rotation_vectors(expected[None, :])[0] == pytest.approx(vector, abs=1e-12)


def test_heading_is_the_twist_about_the_vertical() -> None:
    """A twist after a tilt about any level axis."""
    for yaw_deg in (-179.0, -30.0, 0.0, 90.0, 179.0):
        swing = Rotation.from_rotvec([0.7, -1.1, 0.0])
        q = quaternion(Rotation.from_euler("z", yaw_deg, degrees=True) * swing)
        assert heading_deg(*q) == pytest.approx(yaw_deg)
        assert heading_deg(*(-part for part in q)) == pytest.approx(yaw_deg)
        assert tilt_deg(*q) == pytest.approx(np.degrees(np.hypot(0.7, 1.1)))


@pytest.mark.parametrize("up", [(0.0, 0.0, 9.8), (3.0, -4.0, 8.0), (9.8, 0.0, 0.0), (0.0, 0.0, -9.8), (0.0, 0.0, 0.0)])
def test_a_level_attitude_turns_gravity_up_and_has_heading_zero(up: tuple[float, float, float]) -> None:
    q = level(*up)
    assert rotate(q, up) == pytest.approx((0.0, 0.0, np.hypot(up[0], np.hypot(up[1], up[2]))), abs=1e-9)
    assert q[3] == 0.0
