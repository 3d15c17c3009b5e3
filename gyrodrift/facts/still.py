"""Rest in a stream, block by block: limits relative to the noise of the sensor, for callers that cannot look ahead."""

from dataclasses import dataclass
from math import sqrt

import numpy as np

from gyrodrift.values.arrays import Floats, Mask

HOLE_PERIODS = 3.5
"""Longest step of time without lost samples, in periods."""


@dataclass(frozen=True, slots=True)
class StillRule:
    """Limits of a block of samples at rest, each the larger of a floor and a multiple of the white noise.

    level, level_errors
        Change of the mean: floor, and standard errors of a mean.
    scatter, scatter_sigmas
        Standard deviation within the block: floor, and standard deviations of a sample.
    """

    level: float
    level_errors: float
    scatter: float
    scatter_sigmas: float

    def is_level(self, change: float, noise: float, samples: int) -> bool:
        """Whether the mean of a block of so many samples has not changed."""
        return change <= max(self.level, self.level_errors * noise / sqrt(samples))

    def is_calm(self, deviation: float, noise: float) -> bool:
        """Whether a block with this standard deviation only scatters by noise."""
        return deviation <= max(self.scatter, self.scatter_sigmas * noise)


def has_hole(t_s: Floats, period_s: float) -> bool:
    """Whether samples were lost."""
    return bool(np.diff(t_s).max() > HOLE_PERIODS * period_s)


def quiet_windows(means_dps: Floats, deviations_dps: Floats, ratio: float, shift_dps: float) -> Mask:
    """Windows at rest, relative to the quietest tenth of them, shape (windows,).

    ratio
        Largest standard deviation within a window, over that of the quietest tenth.
    shift_dps
        Largest difference of the mean from that of the quietest tenth, deg/s.
    """
    quiet_dps = float(np.quantile(deviations_dps, 0.1))
    usual_dps = float(np.median(means_dps[deviations_dps <= quiet_dps]))
    is_calm: Mask = deviations_dps <= ratio * quiet_dps + 1e-9
    return is_calm & (np.abs(means_dps - usual_dps) <= shift_dps)
