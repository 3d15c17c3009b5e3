"""Bias against temperature, from a rest during which the device warms up: a robust line and its checks."""

from dataclasses import dataclass, field
from math import isnan, sqrt

import numpy as np

from gyrodrift.calibrate.rest import MOVED_DPS, RestMeasurement
from gyrodrift.facts.arrays import median_slope, robust_sigma
from gyrodrift.values.arrays import Floats
from gyrodrift.values.errors import CalibrationError
from gyrodrift.values.sample import Sample

BLOCK_S = 5.0
BLOCKS_MIN = 24
"""Two minutes: fewer blocks do not show whether they lie on a line."""

SPAN_MIN_C = 3.0
"""Below, bias wander in time looks like a temperature slope."""

SLOPE_ERRORS = 4.0
"""Smallest slope that counts, in standard errors."""

SCATTER_SHARE = 0.5
"""Largest scatter around the line, as a share of the scatter without a line."""


@dataclass(frozen=True, slots=True)
class BiasLine:
    """Bias at `temp_c`, deg/s, slope with standard error, deg/s per °C, valid between `low_c` and `high_c`, °C."""

    bias_dps: float
    temp_c: float
    slope_dps_per_c: float
    slope_se_dps_per_c: float
    low_c: float
    high_c: float


@dataclass(slots=True)
class Warming:
    """Temperature run; blocks with motion or without a temperature are skipped.

    last_dps
        Bias of the last block, deg/s.
    """

    rest: RestMeasurement
    last_dps: float
    seconds: float = 0.0
    _temps_c: list[float] = field(default_factory=list)
    _biases_dps: list[float] = field(default_factory=list)
    _block: list[Sample] = field(default_factory=list)

    def take(self, samples: list[Sample]) -> None:
        """Add samples."""
        for sample in samples:
            self._block.append(sample)
            if sample.t_device_s - self._block[0].t_device_s >= BLOCK_S:
                self._end()

    @property
    def temp_c(self) -> float:
        """Temperature of the last block, °C; NaN without a block."""
        return self._temps_c[-1] if self._temps_c else float("nan")

    def line(self) -> BiasLine:
        """Line through all blocks.

        Raises
        ------
        CalibrationError
            There are too few blocks, the temperature changed too little, or the bias does not lie on a line.
        """
        return line_of(np.array(self._temps_c), np.array(self._biases_dps))

    def _end(self) -> None:
        rates = np.array([sample.rate_dps for sample in self._block])
        temp_c, bias_dps = float(np.mean([sample.temp_c for sample in self._block])), float(rates.mean())
        self.seconds += self._block[-1].t_device_s - self._block[0].t_device_s
        halves = rates[: len(rates) // 2].mean() - rates[len(rates) // 2 :].mean()
        moved = abs(bias_dps - self.last_dps) > MOVED_DPS or abs(halves) > MOVED_DPS
        self._block.clear()
        if moved or isnan(temp_c):
            return
        self._temps_c.append(temp_c)
        self._biases_dps.append(bias_dps)
        self.last_dps = bias_dps


def line_of(temps_c: Floats, biases_dps: Floats) -> BiasLine:
    """Robust line through blocks, both arrays of shape (n,).

    Raises
    ------
    CalibrationError
        See `Warming.line`.
    """
    if len(temps_c) < BLOCKS_MIN:
        raise CalibrationError(
            f"{len(temps_c)} blocks of {BLOCK_S:g} s at rest with a temperature; {BLOCKS_MIN} are needed"
        )
    low_c, high_c = float(temps_c.min()), float(temps_c.max())
    if high_c - low_c < SPAN_MIN_C:
        raise CalibrationError(
            f"the temperature changed by only {high_c - low_c:.1f} °C, from {low_c:.1f} to {high_c:.1f}; at least "
            f"{SPAN_MIN_C:g} °C are needed: start with a cold device"
        )
    slope = median_slope(temps_c, biases_dps, 0.1 * (high_c - low_c))
    residual_dps = biases_dps - slope * temps_c
    level_dps, scatter_dps = float(np.median(residual_dps)), robust_sigma(residual_dps)
    slope_se = scatter_dps / (float(np.std(temps_c)) * sqrt(len(temps_c)))
    before_dps = robust_sigma(biases_dps)
    if abs(slope) < SLOPE_ERRORS * slope_se or scatter_dps > SCATTER_SHARE * before_dps:
        raise CalibrationError(
            f"the bias does not follow the temperature along a line ({slope:+.5f} ± {slope_se:.5f} deg/s per °C, "
            f"{scatter_dps:.4f} of {before_dps:.4f} deg/s of scatter remain)"
        )
    temp_c = float(np.median(temps_c))
    return BiasLine(level_dps + slope * temp_c, temp_c, slope, slope_se, low_c, high_c)
