"""A forest plot in the cells of a table: sessions as dots and their mean as a bar, on one axis for all rows.

A strip fills its cell, and its text has the size of the text of the page.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import ceil, floor, log10

import numpy as np

from gyrodrift.html.html import text
from gyrodrift.html.numbers import factor_label, significant

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
        inside_deg = min(max(error_deg, self.low_deg), self.high_deg)
        share = log10(inside_deg / self.low_deg) / log10(self.high_deg / self.low_deg)
        return MARGIN_PERCENT + (100.0 - 2.0 * MARGIN_PERCENT) * share

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


def strip(axis: ForestAxis, names: Sequence[str], errors_deg: Sequence[float], mean_deg: float, color: str) -> str:
    """Strip of a row: a dot for each session, a line from the smallest to the largest error, a bar at the mean."""
    ranked = sorted(zip(errors_deg, names, strict=True))
    drawn = [ranked[index] for index in np.unique(np.linspace(0, len(ranked) - 1, DOTS).astype(int)).tolist()]
    ends = [axis.percent(ranked[index][0]) for index in (0, -1)]
    dots = "".join(_dot(axis, name, error_deg) for error_deg, name in drawn)
    mean = axis.percent(mean_deg)
    label = (
        f"mean {significant(mean_deg, 3)} deg, from {significant(ranked[0][0], 3)} to {significant(ranked[-1][0], 3)}"
    )
    return (
        f'<svg class="strip {color}" role="img" aria-label="{label}">{"".join(_grid(axis, 100.0))}'
        f'<line class="spread" x1="{ends[0]:.2f}%" x2="{ends[1]:.2f}%" y1="50%" y2="50%"/>{dots}'
        f'<rect class="mean" x="{mean:.2f}%" y="12%" height="76%"/></svg>'
    )


def _dot(axis: ForestAxis, name: str, error_deg: float) -> str:
    title = f"<title>{text(name)}: {significant(error_deg, 3)} deg</title>"
    return f'<circle cx="{axis.percent(error_deg):.2f}%" cy="50%" r="3.2">{title}</circle>'


def _grid(axis: ForestAxis, high_percent: float) -> Iterator[str]:
    for mark_deg in axis.marks_deg:
        x = axis.percent(mark_deg)
        yield f'<line class="grid" x1="{x:.2f}%" x2="{x:.2f}%" y1="0" y2="{high_percent:.0f}%"/>'


def scale(axis: ForestAxis) -> str:
    """The axis, for the last row of the table."""
    labels = "".join(
        f'<text x="{axis.percent(mark_deg):.2f}%" y="85%">{factor_label(mark_deg)}</text>'
        for mark_deg in axis.marks_deg
    )
    return (
        f'<svg class="strip scale" role="img" aria-label="logarithmic axis">{"".join(_grid(axis, 25.0))}{labels}</svg>'
    )
