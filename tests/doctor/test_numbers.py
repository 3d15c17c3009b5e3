"""The numbers behind findings: drift that is expected against drift that happens, and data sheets."""

import numpy as np
import pytest

from gyrodrift.doctor.checks.drift import of_bias, of_uncertainty
from gyrodrift.doctor.sensors import SENSORS, sensor_named, with_step
from gyrodrift.values.constants import SECONDS_PER_MINUTE

NOISE, WALK, SIGMA = 0.0035, 0.0005, 0.002
RATE_HZ = 10.0


def test_expected_drift_is_the_scatter_of_yaw_that_is_drawn() -> None:
    """Bias, white noise and a walk of the bias, integrated over a minute, two thousand times."""
    rng = np.random.default_rng(5)
    runs, steps = 2000, int(SECONDS_PER_MINUTE * RATE_HZ)
    walks = WALK / np.sqrt(RATE_HZ) * rng.standard_normal((runs, steps)).cumsum(axis=1)
    whites = NOISE * np.sqrt(RATE_HZ) * rng.standard_normal((runs, steps))
    rates = SIGMA * rng.standard_normal((runs, 1)) + walks + whites
    yaws = rates.sum(axis=1) / RATE_HZ
    assert of_uncertainty(SIGMA, NOISE, WALK).minute_deg == pytest.approx(yaws.std(), rel=0.06)


def test_a_bias_adds_up() -> None:
    assert (of_bias(-0.5).minute_deg, of_bias(-0.5).hour_deg) == (30.0, 1800.0)
    assert str(of_bias(0.35)) == "21 deg in a minute, 1260 deg in an hour"


def test_sensors_are_known_by_name_and_step() -> None:
    assert [sensor_named(sensor.name.lower().replace("-", "_")) for sensor in SENSORS] == list(SENSORS)
    assert sensor_named("my robot's LSM6DSOX") is sensor_named("LSM6DSO")
    assert sensor_named("firmware_sim") is None
    assert [(item.name, scale) for item, scale in with_step(0.00875)] == [("LSM6DS3", 250), ("LSM6DSO", 250)]
