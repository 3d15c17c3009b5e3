"""Yaw and its error over time in a comparison: a figure without tuning, one with tuning."""

from collections.abc import Sequence

from gyrodrift.compare.comparison import ComparedSession, Comparison
from gyrodrift.compare.report.charts import key_of, mark_of, session_chart
from gyrodrift.compare.report.files import best_of
from gyrodrift.compare.report.tables import groups
from gyrodrift.report.chart import Mark
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
