"""Figures of a comparison: mean error of every method, and yaw and its error over time for every session."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator, NullLocator

from gyrodrift.compare.comparison import ComparedSession, Entry
from gyrodrift.evaluation.curves import YawCurves
from gyrodrift.html.numbers import factor_label, significant
from gyrodrift.html.svg import (
    INK,
    QUIET,
    ROLES,
    STEPS,
    as_svg,
    canvas,
    follows,
    label_factors,
    label_steps,
    styled,
    switched,
    thinned,
)
from gyrodrift.values.arrays import Floats

COLORS = {role: color for color, role in ROLES.items()}

LINEAR_DEG = 1.0
"""Limit of the linear part of the error scale, deg; larger errors are on a logarithmic scale: chosen."""


@dataclass(frozen=True, slots=True)
class LineStyle:
    """Line style of a method in figures and legends."""

    color: str
    dash: str

    @property
    def mark(self) -> tuple[str, str]:
        """Color and shape as classes of the style sheet."""
        return ROLES[self.color], "key dashed" if self.dash == "--" else "key"


def line_style_of(entry: Entry) -> LineStyle:
    """Line style of an entry."""
    return LineStyle(COLORS[entry.method.color], entry.method.dash)


def key_of(entry: Entry) -> str:
    """Key by which the legend switches the curves of an entry."""
    return f"{entry.method.key}-{entry.source.value}"


def bars_svg(entries: Sequence[Entry], e_deg: Sequence[float], rows: Sequence[int]) -> str:
    """Bars of the mean E of these entries on a logarithmic axis, the first row on top."""
    known_deg = [e_deg[row] for row in rows if 0.0 < e_deg[row] < np.inf] or [1.0]
    low, high = 10.0 ** np.floor(np.log10(min(known_deg) / 1.5)), 1.6 * max(known_deg)
    with styled():
        figure = canvas(5.4, 0.55 + 0.26 * len(rows), inset=0.33, bottom=0.42 / (0.55 + 0.26 * len(rows)), top=0.99)
        axes = figure.add_subplot()
        axes.set_xscale("log")
        axes.set_xlim(low, high)
        for position, row in enumerate(rows):
            drawn_deg = min(max(e_deg[row], low), high) if np.isfinite(e_deg[row]) else high
            opacity = 0.95 if entries[row].is_tuned or not any(entry.is_tuned for entry in entries) else 0.5
            axes.barh(
                position, drawn_deg - low, left=low, height=0.66, color=line_style_of(entries[row]).color, alpha=opacity
            )
            label = f" {significant(e_deg[row], 3)}°"
            axes.text(drawn_deg, position, label, va="center", ha="left", fontsize=8.0, color=INK, clip_on=False)
        axes.set_yticks(range(len(rows)), [entries[row].title for row in rows])
        axes.invert_yaxis()
        axes.grid(visible=False, axis="y")
        label_factors(axes.xaxis, low, high, 5)
        axes.set_xlabel("mean E, deg", labelpad=1.0)
        figure.subplots_adjust(right=0.91)
        return as_svg(figure, "bars", "Mean yaw error of every method")


def session_svgs(sessions: Sequence[ComparedSession], entries: Sequence[Entry], shown: Sequence[int]) -> list[str]:
    """A panel for each session with curves: yaw above, its error below, for some of the entries."""
    with styled():
        chosen = [(row, entries[row]) for row in shown]
        return [
            _session_svg(session.curves, chosen, f"{chosen[0][1].source.value}-{number}")
            for number, session in enumerate(sessions)
            if session.curves is not None
        ]


def _session_svg(curves: YawCurves, lines: Sequence[tuple[int, Entry]], name: str) -> str:
    figure = canvas(3.1, 2.7, inset=0.22, bottom=0.13, top=0.97, right=0.97)
    above, below = figure.subplots(2, 1, sharex=True)
    follows(below.axhline(0.0, color=QUIET, linewidth=0.6))
    errors_deg = curves.errors_deg
    for row, entry in reversed(lines):  # the best on top
        style = line_style_of(entry)
        for panel, yaw_deg in ((above, curves.yaw_deg[row]), (below, errors_deg[row])):
            (line,) = panel.plot(
                *thinned(curves.minutes, yaw_deg), color=style.color, linestyle=style.dash, linewidth=1.0
            )
            switched(line, key_of(entry))
    (line,) = above.plot(*thinned(curves.minutes, curves.reference_deg), color=INK, linestyle=":", linewidth=1.2)
    switched(line, "reference")
    label_steps(above.yaxis, 4)
    above.set_ylabel("yaw, deg")
    _scale_errors(below, [errors_deg[row] for row, _ in lines])
    below.set_ylabel("error, deg")
    figure.align_ylabels([above, below])
    below.xaxis.set_major_locator(MaxNLocator(6, steps=STEPS))
    below.set_xlabel("minutes", labelpad=1.0)
    below.set_xlim(0.0, max(float(curves.minutes[-1]), 1e-3))
    return as_svg(figure, name, "Yaw and its error over time, by method")


def _scale_errors(axes: Axes, errors_deg: Sequence[Floats]) -> None:
    """Linear within a degree, logarithmic beyond it, over the range of the errors."""
    all_deg = np.concatenate(list(errors_deg))
    finite_deg = all_deg[np.isfinite(all_deg)]
    low, high = float(finite_deg.min(initial=-LINEAR_DEG)), float(finite_deg.max(initial=LINEAR_DEG))
    decades = 10.0 ** np.arange(0, np.ceil(np.log10(max(-low, high))) + 1)
    axes.set_yscale("symlog", linthresh=LINEAR_DEG)
    axes.set_ylim(1.3 * low, 1.3 * high)
    every = decades[:: max(1, len(decades) // 3)]
    axes.yaxis.set_major_locator(FixedLocator([*(-every[::-1]), 0.0, *every]))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: _signed(value)))


def _signed(value: float) -> str:
    return f"−{factor_label(-value)}" if value < 0.0 else factor_label(value)
