"""Report of a comparison: one HTML file with means of all methods, yaw and its error over time, then every session."""

from collections.abc import Sequence
from dataclasses import replace

from gyrodrift.compare.comparison import ComparedSession, Comparison, Entry, ParamsFrom
from gyrodrift.compare.report.files import absence, best_of, shared, sources
from gyrodrift.compare.report.tables import by_folder, by_session, groups, ranking, session_name
from gyrodrift.evaluation.dataset import YawCurves
from gyrodrift.report.chart import AxisScale, Chart, ChartSeries, Mark, Part, error_scale, line, scale_of, thinned
from gyrodrift.report.page import Section, page, titled
from gyrodrift.report.provenance import Provenance, UsedFile, provenance

SHOWN = 2
"""Number of methods whose curves are visible at first, besides the start calibration: chosen."""


def report_html(comparison: Comparison, made: Provenance) -> str:
    """Page of a comparison with its provenance."""
    sections = [
        _head(comparison, made.set_name),
        ranking(comparison),
        by_folder(comparison),
        over_time(comparison),
        by_session(comparison),
        _methods(comparison),
        provenance(replace(made, sessions=_used(comparison), config=_config_words(comparison))),
    ]
    return page(f"Yaw drift compared on {made.set_name}", sections)


def _head(comparison: Comparison, set_name: str) -> Section:
    """Verdict: the best real-time method, and the next."""
    first, *following = comparison.streaming
    sessions = comparison.sessions
    values = {
        "comparison": comparison,
        "set_name": set_name,
        "minutes": sum(session.session.minutes for session in sessions),
        "first": first,
        "second": following[0] if following else None,
        "mark": shared(comparison, comparison.entries[first]),
        "absent": [f"{method.title} did not run: {absence(method)}." for method in comparison.missing],
        "ahead": sum(
            session.scores[first].e_deg < session.scores[row].e_deg for session in sessions for row in following[:1]
        ),
        "sources": sources(comparison),
    }
    return Section("compare/report/templates/head.html", values)


def _methods(comparison: Comparison) -> Section:
    values = {"entries": comparison.entries, "defaults": ParamsFrom.DEFAULTS, "seconds": comparison.seconds}
    return Section("compare/report/templates/methods.html", values, "Methods and parameters")


def _used(comparison: Comparison) -> list[UsedFile]:
    """Compared sessions, then training sessions."""
    use = "compared" if comparison.train else ""
    used = [UsedFile(session_name(comparison, session), session.session.digest, use) for session in comparison.sessions]
    return used + [
        UsedFile(name, about.digest, "tuning")
        for name, about in zip(comparison.train, comparison.trained_on, strict=True)
    ]


def _config_words(comparison: Comparison) -> str:
    """Sources of the parameters, and the digest of the config."""
    config = comparison.config
    digest = [] if config is None else [f"SHA-256 of {config.name}: {config.sha256}."]
    return " ".join([*sources(comparison), *digest])


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
