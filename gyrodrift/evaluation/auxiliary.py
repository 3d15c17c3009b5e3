"""Columns of a session besides its rate: still flags, temperatures, the three axes, and the device's own yaw."""

from typing import NamedTuple

import numpy as np

from gyrodrift.values.arrays import Floats


class Auxiliary(NamedTuple):
    """Auxiliary data, shape (n,); NaN for a sample without it, shape (0,) for a session without it.

    still
        1 if another sensor reports rest, 0 if it reports motion.
    temp_c
        Temperature of the sensor, °C.
    """

    still: Floats
    temp_c: Floats

    def filled(self, count: int) -> "Auxiliary":
        """Copy in which an empty column has `count` NaN."""
        return Auxiliary(*(column if len(column) else np.full(count, np.nan) for column in self))


class InertialColumns(NamedTuple):
    """Three rates in deg/s and specific forces in m/s² of the sensor, shape (n, 3); NaN where a force is missing."""

    gyro_dps: Floats
    accel_mps2: Floats


class DeviceColumns(NamedTuple):
    """Yaw and its standard deviation by the device's own filter, deg, shape (n,).

    A sample without a result has that of the last sample with one, or else the first result.
    """

    yaw_deg: Floats
    yaw_sigma_deg: Floats


def hold_last(column: Floats) -> Floats:
    """Column in which each missing value is the last one before it, or else the first one; NaN without any value."""
    rows = np.where(np.isnan(column), -1, np.arange(len(column)))
    known_rows = rows[rows >= 0]
    last_rows = np.maximum.accumulate(rows)
    filled: Floats = column[np.maximum(last_rows, known_rows[0] if len(known_rows) else 0)]
    return filled


NO_AUXILIARY = Auxiliary(np.empty(0), np.empty(0))
