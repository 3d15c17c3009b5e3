"""Columns of a session besides its rate: still flags, temperatures, and the three axes."""

from typing import NamedTuple

import numpy as np

from gyrodrift.arrays import Floats


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


NO_AUXILIARY = Auxiliary(np.empty(0), np.empty(0))
