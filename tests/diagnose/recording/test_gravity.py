"""Gravity beside the angle of a table: what stays is the tilt of the sensor, what turns is that of the table."""

import numpy as np
import pytest
from features_support import T_S, TRUE_DEG, TRUE_DPS, recorded

from gyrodrift.diagnose.recording.checks import check_recording
from gyrodrift.diagnose.recording.gravity import Gravity, gravity_of
from gyrodrift.diagnose.recording.recording import Recording, recording_of
from gyrodrift.session.session import Session
from gyrodrift.values.arrays import Floats

G = 9.8
RNG_SEED = 4


def force_of(sensor_deg: float = 0.0, table_deg: float = 0.0, off_axis_m: float = 0.0) -> Floats:
    """Specific force with noise, m/s², shape (n, 3): tilt of the sensor toward y, tilt of the table, place on it."""
    sensor, table, turn = np.deg2rad(sensor_deg), np.deg2rad(table_deg), np.deg2rad(TRUE_DEG)
    across = np.column_stack([np.cos(turn + 0.3), -np.sin(turn + 0.3)]) * G * np.sin(table)
    across[:, 1] += G * np.sin(sensor)
    across[:, 0] -= off_axis_m * np.deg2rad(TRUE_DPS) ** 2
    along = np.full(len(turn), G * np.cos(sensor) * np.cos(table))
    return np.column_stack([across, along]) + np.random.default_rng(RNG_SEED).normal(0.0, 0.03, (len(turn), 3))


def with_force(force: Floats | None) -> Recording:
    counter = np.arange(len(T_S))
    rates = np.column_stack([np.zeros(len(T_S)), np.zeros(len(T_S)), TRUE_DPS])
    return recording_of(
        Session("turns", T_S, TRUE_DPS, 1.7e9 + T_S, counter, TRUE_DEG, gyro_dps=rates, accel_mps2=force)
    )


def known_gravity(force: Floats) -> Gravity:
    gravity = gravity_of(with_force(force), TRUE_DEG, TRUE_DPS)
    assert gravity is not None
    return gravity


@pytest.mark.parametrize(("sensor_deg", "table_deg"), [(0.0, 0.0), (8.0, 0.0), (0.0, 5.0), (8.0, 5.0)])
def test_the_tilts_of_sensor_and_table_come_apart(sensor_deg: float, table_deg: float) -> None:
    gravity = known_gravity(force_of(sensor_deg, table_deg))
    assert np.degrees(np.arcsin(gravity.fixed.sine)) == pytest.approx(sensor_deg, abs=0.1)
    assert np.degrees(np.arctan(gravity.turning)) == pytest.approx(table_deg, abs=0.1)


def test_a_sensor_off_the_axis_is_not_tilted() -> None:
    assert known_gravity(force_of(off_axis_m=0.2)).fixed.sine < np.sin(np.deg2rad(0.1))


def test_the_tilt_points_where_gravity_leans() -> None:
    lean = known_gravity(force_of(8.0)).fixed
    assert (lean.x, lean.y) == pytest.approx((0.0, np.sin(np.deg2rad(8.0))), abs=0.002)


def test_a_table_that_does_not_turn_has_no_part_once_per_turn() -> None:
    """The whole lean is that of the sensor."""
    still = np.zeros(len(T_S))
    gravity = gravity_of(with_force(np.tile([0.0, G * 0.1, G], (len(T_S), 1))), still, still)
    assert gravity is not None
    assert np.isnan(gravity.turning)
    assert gravity.fixed.y == pytest.approx(0.1 / np.hypot(1.0, 0.1))


def test_gravity_is_not_known_without_an_accelerometer() -> None:
    """Nor if it is silent most of the time, nor in free fall."""
    assert gravity_of(recorded(TRUE_DPS), TRUE_DEG, TRUE_DPS) is None
    silent = np.where(T_S[:, None] < 120.0, np.nan, force_of())
    assert gravity_of(with_force(silent), TRUE_DEG, TRUE_DPS) is None
    assert gravity_of(with_force(np.zeros((len(T_S), 3))), TRUE_DEG, TRUE_DPS) is None


def test_samples_without_acceleration_are_left_out() -> None:
    """A part of a tenth without any, and every third sample of the rest."""
    is_missing = (T_S > 90.0) & (T_S < 110.0) | (np.arange(len(T_S)) % 3 == 0)
    gravity = known_gravity(np.where(is_missing[:, None], np.nan, force_of(8.0, 5.0)))
    assert np.degrees(np.arcsin(gravity.fixed.sine)) == pytest.approx(8.0, abs=0.1)
    assert np.degrees(np.arctan(gravity.turning)) == pytest.approx(5.0, abs=0.1)


def test_a_tilted_table_is_remarked_on() -> None:
    (remark,) = check_recording(with_force(force_of(0.0, 4.0))).remarks
    assert "the table is tilted by 4.0 deg" in remark
    assert check_recording(with_force(force_of(8.0, 0.0))).remarks == ()
