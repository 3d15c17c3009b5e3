"""Data sheets of common gyros, one record per sensor."""

import re
from dataclasses import dataclass

from gyrodrift.columns.sizes import INVENSENSE
from gyrodrift.values.constants import SECONDS_PER_HOUR


@dataclass(frozen=True, slots=True)
class Sensor:
    """Typical values of a data sheet; None if it does not state them.

    ranges
        Full scale, deg/s, and counts per deg/s.
    noise_dps_rthz
        Rate noise density, one-sided, deg/s/√Hz.
    zero_rate_dps
        Zero-rate offset at 25 °C, deg/s.
    zero_rate_dps_c
        Change of the zero-rate offset with temperature, deg/s/°C.
    in_run_dps
        In-run bias stability, deg/s.
    bandwidth_by
        Register that sets the low-pass of the sensor.
    source
        Number of the data sheet, and section.
    """

    name: str
    ranges: tuple[tuple[int, float], ...]
    noise_dps_rthz: float
    source: str
    bandwidth_by: str
    zero_rate_dps: float | None = None
    zero_rate_dps_c: float | None = None
    in_run_dps: float | None = None

    def range_of(self, step_dps: float) -> int | None:
        """Full scale with this step, deg/s; None without one."""
        return next((scale for scale, lsb in self.ranges if abs(step_dps * lsb - 1.0) < STEP_TOLERANCE), None)


STEP_TOLERANCE = 0.01

ST = ((125, 1e3 / 4.375), (250, 1e3 / 8.75), (500, 1e3 / 17.5), (1000, 1e3 / 35.0), (2000, 1e3 / 70.0))
BOSCH = ((125, 262.4), (250, 131.2), (500, 65.6), (1000, 32.8), (2000, 16.4))

SENSORS = (
    Sensor(
        "MPU-6050",
        tuple(INVENSENSE.items()),
        noise_dps_rthz=0.005,
        source="InvenSense PS-MPU-6000A rev. 3.4, 6.1",
        bandwidth_by="DLPF_CFG of register 0x1A",
        zero_rate_dps=20.0,
        zero_rate_dps_c=0.16,  # ±20 deg/s from −40 to 85 °C
    ),
    Sensor(
        "ICM-20948",
        tuple(INVENSENSE.items()),
        noise_dps_rthz=0.015,
        source="TDK InvenSense DS-000189 rev. 1.3, table 1",
        bandwidth_by="GYRO_DLPFCFG of register 0x01 in bank 2",
        zero_rate_dps=5.0,
        zero_rate_dps_c=0.05,
    ),
    Sensor(
        "LSM6DS3",
        ST,
        noise_dps_rthz=0.007,
        source="ST DocID026899, mechanical characteristics",
        bandwidth_by="the output data rate of CTRL2_G (0x11)",
        zero_rate_dps=10.0,
        zero_rate_dps_c=0.05,
    ),
    Sensor(
        "LSM6DSO",
        ST,
        noise_dps_rthz=0.0038,
        source="ST DS12140, table 2",
        bandwidth_by="LPF1 of CTRL4_C (0x13) and CTRL6_C (0x15)",
        zero_rate_dps=1.0,
        zero_rate_dps_c=0.01,
    ),
    Sensor(
        "BMI160",
        BOSCH,
        noise_dps_rthz=0.007,
        source="Bosch BST-BMI160-DS000, gyroscope parameters",
        bandwidth_by="gyr_bwp of register 0x42",
        zero_rate_dps=3.0,
        zero_rate_dps_c=0.05,
    ),
    Sensor(
        "ADIS16470",
        ((2000, 10.0),),
        noise_dps_rthz=0.008,
        source="Analog Devices ADIS16470 rev. C, page 1",
        bandwidth_by="FILT_CTRL, register 0x5C",
        in_run_dps=8.0 / SECONDS_PER_HOUR,
    ),
)
"""A name that begins with another name comes after it."""


def plain(name: str) -> str:
    """Letters and digits in capitals, so that mpu_6050 matches MPU-6050."""
    return re.sub(r"[^A-Z0-9]", "", name.upper())


def sensor_named(text: str) -> Sensor | None:
    """Sensor whose name is in a text; None without one."""
    matches = [sensor for sensor in SENSORS if plain(sensor.name) in plain(text)]
    return matches[-1] if matches else None


def with_step(step_dps: float) -> list[tuple[Sensor, int]]:
    """Sensors that have a range with this step, and the range, deg/s."""
    ranges = [(sensor, sensor.range_of(step_dps)) for sensor in SENSORS]
    return [(sensor, scale) for sensor, scale in ranges if scale is not None]
