"""The gyro: true rate in, 16-bit counts out."""

import numpy as np
from numpy.typing import NDArray

from firmware_sim.motion import Floats
from firmware_sim.rig import Base

COUNTS_MOST = 32767


class Gyro:
    """Adds bias and white noise and rounds to counts. Blocks of any size give the same counts."""

    def __init__(self, base: Base, rng: np.random.Generator) -> None:
        self._base = base
        self._rng = rng
        self._sigma_dps = base.noise_dps_rthz * np.sqrt(base.sample_rate_hz / 2.0)

    def measure(self, rate_dps: Floats) -> tuple[NDArray[np.int16], NDArray[np.bool_]]:
        """Counts for true rates in deg/s, and where they were clipped; both of the shape of the input."""
        noise_dps = self._sigma_dps * self._rng.standard_normal(rate_dps.shape)
        counts = np.rint((rate_dps + self._base.bias_dps + noise_dps) / self._base.dps_per_lsb)
        is_clipped = np.abs(counts) > COUNTS_MOST
        return np.clip(counts, -COUNTS_MOST, COUNTS_MOST).astype(np.int16), is_clipped
