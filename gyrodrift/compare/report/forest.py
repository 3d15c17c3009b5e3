"""A forest plot in the cells of a table: sessions as dots and their mean as a bar, on one axis for all rows.

A strip fills its cell, and its text has the size of the text of the page.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, floor, log10

import numpy as np
from markupsafe import Markup

from gyrodrift.report.numbers import factor_label, log_share
from gyrodrift.report.page import macro

TEMPLATE = "compare/report/templates/forest.html"

DOTS = 60
"""Most dots in a strip; more sessions are thinned at even steps from the best to the worst: chosen."""

MARGIN_PERCENT = 3.0
FEW_DECADES = 1.3
"""Length of an axis in decades below which it has marks at 1, 2 and 5: chosen."""

MARKS = 6


@dataclass(frozen=True, slots=True)
class ForestAxis:
    """A logarithmic axis of errors, deg."""

    low_deg: float
    high_deg: float

    def percent(self, error_deg: float) -> float:
        """Position of an error in percent of the width; an error outside of the axis is drawn at its end."""
        return MARGIN_PERCENT + (100.0 - 2.0 * MARGIN_PERCENT) * log_share(error_deg, self.low_deg, self.high_deg)

    @property
    def marks_deg(self) -> list[float]:
        """Errors at the marks, deg."""
        times = (1.0, 2.0, 5.0) if log10(self.high_deg / self.low_deg) < FEW_DECADES else (1.0,)
        powers = range(floor(log10(self.low_deg)), ceil(log10(self.high_deg)) + 1)
        inside = [time * 10.0**power for power in powers for time in times]
        kept = [mark for mark in inside if self.low_deg <= mark <= self.high_deg]
        return kept[:: ceil(len(kept) / MARKS) or 1]


def forest_axis(errors_deg: Sequence[float]) -> ForestAxis:
    """Axis for all positive and finite errors."""
    finite_deg = [error_deg for error_deg in errors_deg if 0.0 < error_deg < np.inf]
    low, high = min(finite_deg, default=0.1), max(finite_deg, default=1.0)
    if high < 1.5 * low:
        low, high = low / 2.0, high * 2.0
    return ForestAxis(low / 1.15, high * 1.15)


def strip(axis: ForestAxis, names: Sequence[str], errors_deg: Sequence[float], mean_deg: float, color: str) -> Markup:
    """Strip of a row: a dot for each session, a line from the smallest to the largest error, a bar at the mean."""
    ranked = sorted(zip(errors_deg, names, strict=True))
    rows = np.unique(np.linspace(0, len(ranked) - 1, DOTS).astype(int)).tolist()
    return macro(TEMPLATE, "strip")(axis, color, [ranked[row] for row in rows], mean_deg)


def scale(axis: ForestAxis) -> Markup:
    """The axis, for the last row of the table."""
    return macro(TEMPLATE, "scale")(axis, [(mark_deg, factor_label(mark_deg)) for mark_deg in axis.marks_deg])
