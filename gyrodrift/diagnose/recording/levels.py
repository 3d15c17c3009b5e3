"""Distinct values of a recording: the step between them, and whether they lie on a grid."""

from dataclasses import dataclass

import numpy as np

from gyrodrift.diagnose.recording.order_statistics import distinct
from gyrodrift.diagnose.recording.outliers import NEXT_LEVEL
from gyrodrift.values.arrays import Floats

LEAST_GAPS = 10
"""Least number of small gaps that determine a step. Chosen: fewer may agree by chance."""

LEVELS_TRIED = 4000
"""About the number of levels that are tried for decimals and for a grid. Chosen: more levels take time and change
nothing."""

UNITS = (1.0, 180.0 / np.pi, np.pi / 180.0)
"""Factors between the written values and these: written as they are, in radians, or converted once too often. Derived:
degrees per radian, and radians per degree."""

DECIMALS = 10
"""Number of decimals that are tried: 0 to 9. Chosen: simulators write nine digits and more."""

FINEST = 2.0**-31
"""Share of the span below which a step comes from the digits. Derived: counts of sensors and encoders have at most 31
bits."""


@dataclass(frozen=True, slots=True)
class Levels:
    """Distinct values of a recording.

    values
        Rising values, shape (n,).
    text
        Unit of the last decimal in which they were written; 0 if they have too many decimals.
    """

    values: Floats
    text: float

    @property
    def step(self) -> float | None:
        """Step between the values; None if they have no step, or only that of their decimals."""
        step = self.densest
        # A step of more than ten units of the last decimal is tested with the rounding of the text as a tolerance.
        # A finer step is accepted only if the values are exact multiples of it.
        exact = self if step > 10.0 * self.text else Levels(self.values, 0.0)
        is_text = step <= 1.5 * self.text or len(self.values) <= LEAST_GAPS or step < FINEST * np.ptp(self.values)
        # At least four fifths of the small gaps must be whole steps, to a twentieth of a step.
        return None if is_text or off_grid(exact, step, near=0.05) > 0.2 else step

    def has_gaps_below(self, least: float) -> bool:
        """Whether at least LEAST_GAPS gaps are smaller than `least`, the rounding of the text included."""
        return int(np.count_nonzero(np.diff(self.values) < least - self.text)) >= LEAST_GAPS

    @property
    def densest(self) -> float:
        """Mean of the gaps near their 5 % quantile; 0 for a single value.

        Smaller gaps are ignored: means and interpolated values have some that are no step.
        """
        gaps = np.diff(self.values)
        if not len(gaps):
            return 0.0
        grain = float(np.quantile(gaps, 0.05))
        return float(gaps[(gaps > 0.5 * grain) & (gaps < NEXT_LEVEL * grain)].mean())


def levels_of(values: Floats) -> Levels:
    """Distinct values, and the unit of their last decimal."""
    levels = distinct(values)
    return Levels(levels, _text(levels[:: max(1, len(levels) // LEVELS_TRIED)]))


def has_steps(values: Floats) -> bool:
    """Whether values come in steps that are coarser than their decimals."""
    return levels_of(values).step is not None


def off_grid(levels: Levels, step: float, near: float) -> float:
    """Share of the small gaps between levels that are no multiple of a step; 0 with too few gaps.

    near
        Relative tolerance of the step.
    """
    gaps = np.diff(levels.values) / step
    gaps = gaps[gaps < 5.5]  # beyond five steps, the error of the step adds up too much
    if len(gaps) < LEAST_GAPS:
        return 0.0
    whole = np.rint(gaps)
    # Values of the same level have the same text. Therefore a gap of less than half a step is no rounding error.
    is_off = (whole == 0.0) | (np.abs(gaps - whole) > near * whole + levels.text / step)
    return float(np.mean(is_off))


def _text(values: Floats) -> float:
    """Unit of the last decimal in which all values can be written, in the unit of the values; 0 without one."""
    for decimals in range(DECIMALS):
        for unit in UNITS:
            written = values * 10.0**decimals / unit
            if np.all(np.abs(written - np.rint(written)) < 1e-4):
                return float(unit * 10.0**-decimals)
    return 0.0


def coherence(levels: Levels, cpr: float) -> float:
    """Coherence of angles with a grid of counts, |mean of exp(2πi·angle/count)|: 1 on the grid, about 1/√n off it."""
    chosen = levels.values[:: max(1, len(levels.values) // LEVELS_TRIED)]
    return float(np.abs(np.mean(np.exp(2j * np.pi * chosen * (cpr / 360.0)))))
