"""The figures of a comparison: of each session yaw by every method beside the reference, and how far each is off."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator, NullLocator

from gyrodrift.arrays import Floats
from gyrodrift.compare.comparison import ComparedSession, Entry
from gyrodrift.evaluation.curves import YawCurves
from gyrodrift.html.numbers import factor_label
from gyrodrift.html.svg import (
    INK,
    QUIET,
    ROLES,
    STEPS,
    as_svg,
    canvas,
    follows,
    label_steps,
    styled,
    switched,
    thinned,
)

COLOURS = {role: colour for colour, role in ROLES.items()}

LINEAR_DEG = 1.0
"""Errors within a degree are drawn to scale, larger ones by factors: some methods are off by turns."""


@dataclass(frozen=True, slots=True)
class Look:
    """How a method is drawn, in figures and in their legend."""

    colour: str
    dash: str

    @property
    def mark(self) -> tuple[str, str]:
        """Colour and shape as classes of the style sheet."""
        return ROLES[self.colour], "key dashed" if self.dash == "--" else "key"


def look_of(entry: Entry) -> Look:
    """As its method says."""
    return Look(COLOURS[entry.method.colour], entry.method.dash)


def key_of(entry: Entry) -> str:
    """What its curves are switched by."""
    return f"{entry.method.key}-{entry.source.value}"


def session_svgs(sessions: Sequence[ComparedSession], entries: Sequence[Entry], shown: Sequence[int]) -> list[str]:
    """A panel a session that has curves, of some of the entries: yaw above, and below how far it is off."""
    with styled():
        chosen = [(at, entries[at]) for at in shown]
        return [
            _session_svg(one.curves, chosen, f"{chosen[0][1].source.value}-{number}")
            for number, one in enumerate(sessions)
            if one.curves is not None
        ]


def _session_svg(curves: YawCurves, lines: Sequence[tuple[int, Entry]], name: str) -> str:
    figure = canvas(3.1, 2.7, inset=0.22, bottom=0.13, top=0.97, right=0.97)
    above, below = figure.subplots(2, 1, sharex=True)
    follows(below.axhline(0.0, color=QUIET, linewidth=0.6))
    errors_deg = curves.errors_deg
    for at, entry in reversed(lines):  # the best one on top
        look = look_of(entry)
        for panel, yaw_deg in ((above, curves.yaw_deg[at]), (below, errors_deg[at])):
            (line,) = panel.plot(
                *thinned(curves.minutes, yaw_deg), color=look.colour, linestyle=look.dash, linewidth=1.0
            )
            switched(line, key_of(entry))
    (line,) = above.plot(*thinned(curves.minutes, curves.reference_deg), color=INK, linestyle=":", linewidth=1.2)
    switched(line, "reference")
    label_steps(above.yaxis, 4)
    above.set_ylabel("yaw, deg")
    _scale_errors(below, [errors_deg[at] for at, _ in lines])
    below.set_ylabel("error, deg")
    figure.align_ylabels([above, below])
    below.xaxis.set_major_locator(MaxNLocator(6, steps=STEPS))
    below.set_xlabel("minutes", labelpad=1.0)
    below.set_xlim(0.0, max(float(curves.minutes[-1]), 1e-3))
    return as_svg(figure, name, "Yaw and its error over time, by method")


def _scale_errors(axes: Axes, errors_deg: Sequence[Floats]) -> None:
    """To scale within a degree, and beyond it by decades, as far as there are errors."""
    everything = np.concatenate(list(errors_deg))
    known = everything[np.isfinite(everything)]
    low, high = float(known.min(initial=-LINEAR_DEG)), float(known.max(initial=LINEAR_DEG))
    decades = 10.0 ** np.arange(0, np.ceil(np.log10(max(-low, high))) + 1)
    axes.set_yscale("symlog", linthresh=LINEAR_DEG)
    axes.set_ylim(1.3 * low, 1.3 * high)
    every = decades[:: max(1, len(decades) // 3)]
    axes.yaxis.set_major_locator(FixedLocator([*(-every[::-1]), 0.0, *every]))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: _signed(value)))


def _signed(value: float) -> str:
    return f"−{factor_label(-value)}" if value < 0.0 else factor_label(value)
