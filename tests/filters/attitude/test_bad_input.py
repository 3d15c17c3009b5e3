"""The attitude filter on damaged samples and in unusual attitudes: never NaN, and yaw goes on."""

from collections.abc import Callable
from math import inf, isfinite, nan

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from gyrodrift.filters.attitude.model import AttitudeState, coefficients
from gyrodrift.filters.attitude.step import step
from gyrodrift.filters.restlevel.model import RestlevelParams
from gyrodrift.values.arrays import Floats

HZ = 100
C = coefficients(RestlevelParams())
BIAS = np.array((0.4, -0.3, 0.5))


class Stream:
    """Samples of a device that rests for 3 s, then turns about the vertical by 30 deg/s for 12 s, then rests for 3 s.

    Each row is time, rates and accelerations.
    """

    def __init__(self, mount: Rotation | None = None) -> None:
        rng = np.random.default_rng(1)
        mount = mount or Rotation.identity()
        n = 18 * HZ
        rate = np.zeros((n, 3))
        rate[3 * HZ : 15 * HZ, 2] = 30.0
        gyro = mount.inv().apply(rate) + BIAS + 0.05 * rng.normal(size=(n, 3))
        accel = mount.inv().apply(np.tile((0.0, 0.0, 9.81), (n, 1))) + 0.02 * rng.normal(size=(n, 3))
        self.rows: Floats = np.column_stack((np.arange(n) / HZ, gyro, accel))

    def filtered(self, still: float = nan) -> AttitudeState:
        s = AttitudeState()
        for t_s, gx, gy, gz, ax, ay, az in self.rows.tolist():
            step(C, s, t_s, gx, gy, gz, ax, ay, az, still)
            numbers = (*s.q, s.yaw_deg, s.yaw_sigma_deg, s.tilt_deg, s.tilt_sigma_deg, s.bias_dps, s.bias_sigma_dps)
            assert all(map(isfinite, (*numbers, *s.bias_xyz_dps, s.rest_probability, s.heading_rate_dps)))
        return s


def without_accel(rows: Floats) -> None:
    rows[:, 4:] = nan


def without_accel_from_6_s(rows: Floats) -> None:
    rows[6 * HZ :, 4:] = nan


def without_accel_up_to_2_s(rows: Floats) -> None:
    rows[: 2 * HZ, 4:] = nan


def without_accel_for_a_while(rows: Floats) -> None:
    rows[5 * HZ : 9 * HZ, 4:] = nan


def with_slow_accel(rows: Floats) -> None:
    rows[np.arange(len(rows)) % 8 != 0, 4:] = nan


def with_zeros_for_accel(rows: Floats) -> None:
    rows[:, 4:] = 0.0


def with_infinite_accel(rows: Floats) -> None:
    rows[::50, 4:] = inf


def with_clipped_accel(rows: Floats) -> None:
    rows[5 * HZ : 6 * HZ, 4] = 19.6


def with_free_fall(rows: Floats) -> None:
    rows[5 * HZ : 5 * HZ + 60, 4:] *= 0.001


def with_spikes(rows: Floats) -> None:
    rows[150::210, 1:4] += 1500.0


def with_times_that_go_back(rows: Floats) -> None:
    rows[400::100, 0] -= 0.5


def with_half_the_samples_missing(rows: Floats) -> None:
    rows[1::2, 1] = nan


@pytest.mark.parametrize(
    "damage",
    [
        without_accel,
        without_accel_from_6_s,
        without_accel_up_to_2_s,
        without_accel_for_a_while,
        with_slow_accel,
        with_zeros_for_accel,
        with_infinite_accel,
        with_clipped_accel,
        with_free_fall,
        with_spikes,
        with_times_that_go_back,
        with_half_the_samples_missing,
    ],
)
def test_yaw_goes_on_through_damage(damage: Callable[[Floats], None]) -> None:
    stream = Stream()
    damage(stream.rows)
    s = stream.filtered()
    assert s.yaw_deg == pytest.approx(360.0, abs=2.0)
    assert abs(s.yaw_deg - 360.0) < 3.0 * s.yaw_sigma_deg + 0.3


@pytest.mark.parametrize(
    "mount",
    [
        Rotation.from_euler("x", 180.0, degrees=True),
        Rotation.from_euler("y", 90.0, degrees=True),
        Rotation.from_euler("y", -90.0, degrees=True),
        Rotation.from_euler("xyz", (170.0, 20.0, 60.0), degrees=True),
        Rotation.from_euler("x", 45.0, degrees=True),
    ],
    ids=["upside down", "nose down", "nose up", "nearly upside down", "on edge"],
)
def test_a_device_in_any_attitude_has_the_same_heading(mount: Rotation) -> None:
    s = Stream(mount).filtered()
    assert s.yaw_deg == pytest.approx(360.0, abs=0.5)
    assert s.tilt_deg == pytest.approx(np.degrees(np.arccos(mount.as_matrix()[2, 2])), abs=0.5)
    assert s.bias_xyz_dps == pytest.approx(BIAS, abs=0.05)


def test_a_gap_widens_the_heading() -> None:
    stream = Stream()
    stream.rows[5 * HZ :, 0] += 20.0
    s = stream.filtered()
    assert s.yaw_sigma_deg > 60.0


def test_a_real_jump_of_the_rate_counts_in_full() -> None:
    """A rate that stays is no spike: the turn at 900 deg/s is complete one sample later."""
    stream = Stream()
    stream.rows[3 * HZ : 15 * HZ, 3] += 870.0
    s = stream.filtered()
    assert s.yaw_deg == pytest.approx(900.0 * 12.0, abs=10.0)


def test_a_witness_of_motion_keeps_an_even_turn_from_being_a_rest() -> None:
    """An even turn of 3 deg/s is no bias if wheels say that they move."""
    assert turning(nan) > 1.5
    assert abs(turning(0.0)) < 1.0


def turning(still: float) -> float:
    """Bias estimate of a device without bias that turns evenly."""
    s, rng = AttitudeState(), np.random.default_rng(2)
    for i in range(10 * HZ):
        gyro, accel = 0.05 * rng.normal(size=3), 0.02 * rng.normal(size=3)
        step(C, s, i / HZ, gyro[0] + 0.9, gyro[1] - 0.8, gyro[2] + 2.5, accel[0], accel[1], accel[2] + 9.81, still)
    return s.bias_xyz_dps[2]


def test_a_witness_of_rest_counts_more_than_noise() -> None:
    """Motors shake a standing device by 3 deg/s, more than any rest without a witness."""
    s, rng = AttitudeState(), np.random.default_rng(3)
    for i in range(20 * HZ):
        gx, gy, gz = (BIAS + 8.0 * rng.normal(size=3)).tolist()
        ax, ay, az = (np.array((0.0, 0.0, 9.81)) + 2.0 * rng.normal(size=3)).tolist()
        step(C, s, i / HZ, gx, gy, gz, ax, ay, az, 1.0)
    assert s.rest_probability == pytest.approx(1.0)
    assert s.bias_xyz_dps == pytest.approx(BIAS, abs=1.0)
    assert s.witness.is_believed


def test_a_stuck_witness_is_refuted() -> None:
    stream = Stream()
    s = stream.filtered(1.0)
    assert s.witness.refuted == 1
    assert s.yaw_deg == pytest.approx(360.0, abs=8.0)
