"""Properties that every heading has: it does not depend on frames, mounts or sample rates."""

import numpy as np
import pytest
from attitude_support import Filtered, filtered
from scipy.spatial.transform import Rotation
from six_axis_motions import arm
from six_axis_sensors import Recorded, measure, perfect

from gyrodrift.values.arrays import Floats


@pytest.fixture(scope="module")
def recorded() -> Recorded:
    """A robot arm for 20 s, seen by a part with a bias alone."""
    rng = np.random.default_rng(7)
    return measure(arm(rng, 20.0), perfect(100, (0.4, -0.3, 0.6)), rng)


@pytest.fixture(scope="module")
def estimate(recorded: Recorded) -> Filtered:
    return filtered(recorded)


def headings_deg(q: Floats, true: Rotation) -> Floats:
    """Heading errors (n), whatever the heading at the start."""
    error = (Rotation.from_quat(q, scalar_first=True) * true.inv()).as_quat(scalar_first=True)
    twist = np.degrees(np.unwrap(2.0 * np.arctan2(error[:, 3], error[:, 0])))
    return np.asarray(twist - twist[50])


def test_a_part_without_noise_has_a_heading_of_a_tenth(recorded: Recorded, estimate: Filtered) -> None:
    assert np.abs(headings_deg(estimate.q, recorded.attitude)).max() < 0.2


@pytest.mark.parametrize("vector", [(0.0, 0.0, 1.5), (1.2, -0.4, 0.3), (0.0, 3.0, 0.0)])
def test_the_mount_of_the_sensor_does_not_matter(
    recorded: Recorded, estimate: Filtered, vector: tuple[float, float, float]
) -> None:
    """A sensor that is screwed on otherwise has the same heading."""
    mount = Rotation.from_rotvec(vector)
    second = recorded._replace(
        gyro_dps=mount.inv().apply(recorded.gyro_dps),
        accel_mps2=mount.inv().apply(recorded.accel_mps2),
        attitude=recorded.attitude * mount,
    )
    errors = headings_deg(filtered(second).q, second.attitude)
    assert errors == pytest.approx(headings_deg(estimate.q, recorded.attitude), abs=0.1)


def test_half_the_sample_rate_gives_the_same_heading(recorded: Recorded, estimate: Filtered) -> None:
    half = recorded._replace(
        t_s=recorded.t_s[::2],
        gyro_dps=recorded.gyro_dps[::2],
        accel_mps2=recorded.accel_mps2[::2],
        attitude=recorded.attitude[::2],
    )
    errors = headings_deg(filtered(half).q, half.attitude)
    assert errors == pytest.approx(headings_deg(estimate.q, recorded.attitude)[::2][: len(errors)], abs=0.3)


def test_yaw_is_the_twist_of_the_attitude(estimate: Filtered) -> None:
    twist = np.degrees(2.0 * np.arctan2(estimate.q[:, 3], estimate.q[:, 0]))
    upright = np.hypot(estimate.q[:, 0], estimate.q[:, 3]) > 0.3
    off = (estimate.yaw_deg - twist)[upright]
    assert off / 360.0 == pytest.approx(np.round(off / 360.0), abs=1e-6)


def test_units_of_time_do_not_matter(recorded: Recorded, estimate: Filtered) -> None:
    later = filtered(recorded._replace(t_s=recorded.t_s + 4096.0))
    assert later.yaw_deg == pytest.approx(estimate.yaw_deg, abs=1e-6)
