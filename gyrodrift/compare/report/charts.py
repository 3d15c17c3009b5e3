"""Charts of a comparison: mean error of every method, and yaw and its error over time for every session."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from markupsafe import Markup

from gyrodrift.compare.comparison import Entry
from gyrodrift.evaluation.curves import YawCurves
from gyrodrift.report.chart import AxisScale, Chart, ChartSeries, Mark, Part, error_scale, line, scale_of, thinned
from gyrodrift.report.numbers import significant
from gyrodrift.report.page import bar


class MeanBar(NamedTuple):
    """Name of a method, bar of its mean E on a logarithmic scale, and the number."""

    title: str
    bar: Markup
    e_deg: str


def key_of(entry: Entry) -> str:
    """Key by which the legend switches the curves of an entry."""
    return f"{entry.method.key}-{entry.source.value}"


def mark_of(entry: Entry) -> Mark:
    """Legend entry of an entry."""
    return Mark(key_of(entry), entry.method.color, "key dashed" if _dash(entry) else "key", entry.method.title)


def _dash(entry: Entry) -> str:
    return "dashed" if entry.method.dash == "--" else ""


def mean_bars(entries: Sequence[Entry], e_deg: Sequence[float], rows: Sequence[int]) -> list[MeanBar]:
    """Bars of the mean E of these rows; pale if another row is tuned and this is not."""
    known_deg = [e_deg[row] for row in rows if 0.0 < e_deg[row] < np.inf] or [1.0]
    low, high = 10.0 ** np.floor(np.log10(min(known_deg) / 1.5)), max(known_deg)
    has_tuned = any(entry.is_tuned for entry in entries)
    bars = []
    for row in rows:
        drawn_deg = min(max(e_deg[row], low), high) if np.isfinite(e_deg[row]) else high
        share, words = float(np.log(drawn_deg / low) / np.log(high / low)), f"{significant(e_deg[row], 3)}°"
        is_pale = has_tuned and not entries[row].is_tuned
        bars.append(MeanBar(entries[row].title, bar(share, words, entries[row].method.color, is_pale=is_pale), words))
    return bars


def session_chart(curves: YawCurves, lines: Sequence[tuple[int, Entry]]) -> Chart:
    """Yaw above, its error below, for some rows of the comparison; the first is drawn last."""
    yaws, errors = [], [line(y=0.0, color="quiet", width=0.8)]
    for row, entry in reversed(lines):
        for part, yaw_deg in ((yaws, curves.yaw_deg[row]), (errors, curves.errors_deg[row])):
            x, y = thinned(curves.minutes, yaw_deg)
            name = entry.method.title
            part.append(
                ChartSeries(x, y, entry.method.color, key=key_of(entry), name=name, width=1.3, dash=_dash(entry))
            )
    reference = thinned(curves.minutes, curves.reference_deg)
    yaws.append(ChartSeries(*reference, "ink", key="reference", name="reference", width=1.6, dash="dotted"))
    drawn_deg = [curves.reference_deg, *(curves.yaw_deg[row] for row, _ in lines)]
    parts = [
        Part(scale_of("yaw, deg", drawn_deg), yaws),
        Part(error_scale("error, deg", [curves.errors_deg[row] for row, _ in lines]), errors),
    ]
    x_scale = AxisScale("minutes", 0.0, max(float(curves.minutes[-1]), 1e-3))
    return Chart("Yaw and its error over time, by method", x_scale, parts, 300)
