"""Yaw and its error over time in a comparison: a figure without tuning, one with tuning."""

from collections.abc import Sequence

from gyrodrift.compare.comparison import ComparedSession, Comparison, Entry
from gyrodrift.compare.report.files import best_of
from gyrodrift.compare.report.tables import groups
from gyrodrift.evaluation.curves import YawCurves
from gyrodrift.report.chart import AxisScale, Chart, ChartSeries, Mark, Part, error_scale, line, scale_of, thinned
from gyrodrift.report.page import Section, titled

SHOWN = 2
"""Number of methods whose curves are visible at first, besides the start calibration: chosen."""


def over_time(comparison: Comparison) -> Section:
    """The section of the figures."""
    plotted = _largest_first(comparison)
    values = {
        "figures": [_figure(comparison, kind, plotted, shown) for kind, shown in groups(comparison)],
        "count": len(comparison.sessions),
        "plotted": len(plotted),
    }
    return Section("compare/report/templates/over_time.html", values, "Yaw and its error over time")


def _figure(
    comparison: Comparison, kind: str, plotted: Sequence[ComparedSession], shown: Sequence[int]
) -> dict[str, object]:
    lines = [(row, comparison.entries[row]) for row in shown]
    visible = _visible_first(comparison, shown)
    panels = [
        (
            titled(session.session.name, f"{session.folder}, {session.session.minutes:.3g} min"),
            session_chart(curves, lines),
        )
        for session in plotted
        if (curves := session.curves) is not None
    ]
    return {
        "kind": kind,
        "panels": panels,
        "marks": [Mark("reference", "ink", "key dotted", "reference"), *(mark_of(entry) for _, entry in lines)],
        "off": [key_of(entry) for row, entry in lines if row not in visible],
    }


def _largest_first(comparison: Comparison) -> list[ComparedSession]:
    """Plotted sessions, the one with the largest error of the best method first."""
    plotted = [session for session in comparison.sessions if session.curves is not None]
    best = best_of(comparison)
    first = max(plotted, key=lambda session: session.scores[best].e_deg)
    return [first, *(session for session in plotted if session is not first)]


def _visible_first(comparison: Comparison, shown: Sequence[int]) -> set[int]:
    """Rows whose curves are shown at first: the best real-time methods, and the start calibration."""
    start = [row for row in shown if comparison.entries[row].method.key == "start"]
    real_time = [row for row in shown if not comparison.entries[row].method.is_offline and row not in start]
    return {*real_time[:SHOWN], *start}


def key_of(entry: Entry) -> str:
    """Key by which the legend switches the curves of an entry."""
    return f"{entry.method.key}-{entry.source.value}"


def mark_of(entry: Entry) -> Mark:
    """Legend entry of an entry."""
    return Mark(key_of(entry), entry.method.color, "key dashed" if _dash(entry) else "key", entry.method.title)


def _dash(entry: Entry) -> str:
    return "dashed" if entry.method.dash == "--" else ""


def session_chart(curves: YawCurves, lines: Sequence[tuple[int, Entry]]) -> Chart:
    """Yaw above, its error below, for some rows of the comparison; the first is drawn last."""
    yaws: list[ChartSeries] = []
    errors = [line(y=0.0, color="quiet", width=0.8)]
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
