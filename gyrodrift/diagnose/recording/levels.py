"""The values that a recording holds, as levels: which step they come in, and whether they lie on a grid."""

from dataclasses import dataclass

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.recording.order_statistics import distinct
from gyrodrift.diagnose.recording.outliers import NEXT_LEVEL

LEAST_GAPS = 10
"""Fewer small gaps say nothing of a step."""

LEVELS_TRIED = 4000
"""So many levels are enough for decimals and for a grid; more take time."""

UNITS = (1.0, 180.0 / np.pi, np.pi / 180.0)
"""Text may have been in degrees, in radians, or converted once too often."""

DECIMALS = 10
"""Numbers of decimals that are tried: simulators write nine digits and more."""

FINEST = 2.0**-31
"""Share of the span below which a step is one of digits: counts of sensors and encoders have 31 bits at most."""


@dataclass(frozen=True, slots=True)
class Levels:
    """The values that a recording holds.

    values
        Rising, each once, shape (n,).
    text
        Distance of the decimals that they were written in; 0 where there are too many to have been text.
    """

    values: Floats
    text: float

    @property
    def step(self) -> float | None:
        """The step that they come in, or None where they come in none but that of the text."""
        step = self.densest
        # Where the decimals are nearly as coarse as the step, only a step that they hold exactly can be told.
        # A step of ten units of the last decimal is seen through the rounding.
        exact = self if step > 10.0 * self.text else Levels(self.values, 0.0)
        is_text = step <= 1.5 * self.text or len(self.values) <= LEAST_GAPS or step < FINEST * np.ptp(self.values)
        # All but a fifth of the small gaps are whole steps, to a twentieth of a step.
        return None if is_text or off_grid(exact, step, near=0.05) > 0.2 else step

    def has_gaps_below(self, least: float) -> bool:
        """Whether more than a few neighbours are closer than that, beyond what their decimals do."""
        return int(np.count_nonzero(np.diff(self.values) < least - self.text)) >= LEAST_GAPS

    @property
    def densest(self) -> float:
        """Distance of neighbours where they lie densest, but for a few that are closer by chance; 0 for one value."""
        gaps = np.diff(self.values)
        if not len(gaps):
            return 0.0
        grain = float(np.quantile(gaps, 0.05))  # means and interpolated values have some that no step explains
        return float(gaps[(gaps > 0.5 * grain) & (gaps < NEXT_LEVEL * grain)].mean())


def levels_of(values: Floats) -> Levels:
    """What values there are, and in which decimals."""
    held = distinct(values)
    return Levels(held, _text(held[:: max(1, len(held) // LEVELS_TRIED)]))


def has_steps(values: Floats) -> bool:
    """Whether values come in steps."""
    return levels_of(values).step is not None


def off_grid(levels: Levels, step: float, near: float) -> float:
    """Share of the small gaps between levels that are no whole number of a step; 0 where there are too few of them.

    `near` is how far off the step may be, as a share of itself.
    """
    gaps = np.diff(levels.values) / step
    gaps = gaps[gaps < 5.5]  # beyond five steps, an error of the step adds up to too much
    if len(gaps) < LEAST_GAPS:
        return 0.0
    whole = np.rint(gaps)
    # Two values of one step are one and the same text: a gap of less than half a step is never its rounding.
    is_off = (whole == 0.0) | (np.abs(gaps - whole) > near * whole + levels.text / step)
    return float(np.mean(is_off))


def _text(values: Floats) -> float:
    for decimals in range(DECIMALS):
        for unit in UNITS:
            written = values * 10.0**decimals / unit
            if np.all(np.abs(written - np.rint(written)) < 1e-4):
                return float(unit * 10.0**-decimals)
    return 0.0


def coherence(levels: Levels, cpr: float) -> float:
    """How well angles lie on a grid of counts: 1 on it, about 1/√n off it."""
    chosen = levels.values[:: max(1, len(levels.values) // LEVELS_TRIED)]
    return float(np.abs(np.mean(np.exp(2j * np.pi * chosen * (cpr / 360.0)))))
