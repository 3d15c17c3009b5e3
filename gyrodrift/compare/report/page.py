"""Report of a comparison: one HTML file with means of all methods, then every session."""

from collections.abc import Sequence
from dataclasses import replace
from math import isfinite

from gyrodrift.compare.comparison import ComparedSession, Comparison, Entry, ParamsFrom
from gyrodrift.compare.report.figures import bars_svg, key_of, line_style_of, session_svgs
from gyrodrift.compare.report.files import absence, best_of, cells, e_cell, uncertainty_cells
from gyrodrift.compare.report.forest import forest_axis, scale, strip
from gyrodrift.compare.report.sources import shared, sources
from gyrodrift.evaluation.score import Score
from gyrodrift.html.html import (
    facts,
    figure,
    header,
    headings,
    page,
    panels,
    paragraph,
    section,
    span,
    switches,
    table,
    text,
    warnings,
)
from gyrodrift.html.numbers import degrees, significant
from gyrodrift.html.provenance import Provenance, UsedFile, provenance

SHOWN = 2
"""Number of methods whose curves are visible at first, besides the start calibration: chosen."""

MEASURES = (
    "E: mean absolute yaw error. NE: E divided by the duration in minutes. PI: mean squared error. Largest: largest "
    "absolute error. All are means over the sessions."
)
UNCERTAINTY = (
    "Within 2σ: share of samples whose error is within two stated standard deviations; 95 % for a correct uncertainty, "
    "more for one that is too large. CRPS: continuous ranked probability score of the stated normal distribution; "
    "without an uncertainty it equals E."
)
OFFLINE = "An offline method uses the whole session, so no device can run it; it shows a bound."
HOW = (
    "Yaw and reference are unwrapped and start at 0 at the first sample with a reference. Samples whose time does not "
    "advance are left out for all methods. Other packages get times and rates only; packages for three axes get the "
    "data of a level device. All methods integrate by the trapezoidal rule, except HDR, which integrates as published."
)


def report_html(comparison: Comparison, made: Provenance) -> str:
    """Page of a comparison with its provenance."""
    body = [
        _verdict(comparison, made.set_name),
        section("Yaw error by method", *_ranking(comparison)),
        section("By folder", *_folders(comparison)) if len(comparison.folders) > 1 else "",
        section("Yaw and its error over time", *_figures(comparison)),
        section("Session by session", *_sessions(comparison)),
        section(
            "Methods and parameters",
            _entries(comparison.entries),
            paragraph(f"{HOW} Duration: {comparison.seconds:.3g} s."),
        ),
        provenance(replace(made, sessions=_used(comparison), config=_config_words(comparison))),
    ]
    return page(f"Yaw drift compared on {made.set_name}", [part for part in body if part])


def _verdict(comparison: Comparison, set_name: str) -> str:
    count, minutes = len(comparison.sessions), sum(session.session.minutes for session in comparison.sessions)
    extent = f"{count} session{'s' * (count > 1)}, {significant(minutes, 3)} min"
    return header(
        f"gyrodrift compare · {set_name} · {extent}",
        _headline(comparison, set_name),
        warnings("Warnings", [*comparison.notes, *_absences(comparison)]),
        paragraph(_in_words(comparison)),
        paragraph(" ".join(map(text, sources(comparison)))),
    )


def _headline(comparison: Comparison, set_name: str) -> str:
    """Headline with the best real-time method."""
    best = comparison.entries[comparison.streaming[0]]
    mark = shared(comparison, best)
    e_deg = degrees(comparison.means[comparison.streaming[0]].e_deg)
    return f"Smallest yaw error on {set_name}: {best.title}{f' ({mark})' if mark else ''}, {e_deg} on average"


def _in_words(comparison: Comparison) -> str:
    """Sentence that compares the best real-time method with the next."""
    if len(comparison.streaming) < 2:
        return ""
    first, second = comparison.streaming[:2]
    ahead = sum(session.scores[first].e_deg < session.scores[second].e_deg for session in comparison.sessions)
    best, following = (text(comparison.entries[row].title) for row in (first, second))
    count = len(comparison.sessions)
    return (
        f"Next is {following} with {degrees(comparison.means[second].e_deg)}; <b>{best}</b> has the smaller error on "
        f"{ahead} of {count} session{'s' * (count > 1)}. This counts only real-time methods."
    )


def _absences(comparison: Comparison) -> list[str]:
    return [f"{method.title} did not run: {absence(method)}." for method in comparison.missing]


def _ranking(comparison: Comparison) -> list[str]:
    """Bars of the mean E, then the table of means, the best first, with a forest plot."""
    says_sigma = any(comparison.mean_uncertainties)
    units = ["E, deg", "NE, deg/min", "PI, deg²", "largest, deg", *["within 2σ", "CRPS, deg"] * says_sigma]
    scores = [score for session in comparison.sessions for score in session.scores]
    axis = forest_axis([score.e_deg for score in [*scores, *comparison.means]])
    names = [_session_name(comparison, session) for session in comparison.sessions]
    rows = []
    for row in comparison.ranked:
        entry, mean = comparison.entries[row], comparison.means[row]
        errors_deg = [session.scores[row].e_deg for session in comparison.sessions]
        drawn = strip(axis, names, errors_deg, mean.e_deg, entry.method.color)
        stated = uncertainty_cells(comparison.mean_uncertainties[row]) if says_sigma else []
        rows.append([_name(comparison, row), *cells(mean), *stated, drawn])
    rows += [[text(method.title), *["–"] * len(units), ""] for method in comparison.missing]
    head = headings(["method", *units, "E of each session (dots) and its mean (bar), deg"], words=1)
    count = len(comparison.sessions)
    caption = (
        f"Means over {count} session{'s' * (count > 1)}, the smallest E first. The axis of the dots is logarithmic."
    )
    foot = ["", *[""] * len(units), scale(axis)]
    words = [MEASURES, *[UNCERTAINTY] * says_sigma, *[OFFLINE] * any(e.method.is_offline for e in comparison.entries)]
    return [_bars(comparison), table(caption, head, rows, foot, words=1), paragraph(" ".join(words), "note")]


def _bars(comparison: Comparison) -> str:
    """Figure of the mean E of every method."""
    e_deg = [mean.e_deg for mean in comparison.means]
    dim = " Pale: not tuned." if any(entry.is_tuned for entry in comparison.entries) else ""
    caption = f"<b>Mean E of every method</b>, on a logarithmic axis.{dim}"
    return figure(caption, bars_svg(comparison.entries, e_deg, comparison.ranked), "compact")


def _name(comparison: Comparison, row: int) -> str:
    """Name of a row with its marks."""
    entry = comparison.entries[row]
    mark = shared(comparison, entry)
    marks = [span("best", "best")] * (best_of(comparison) == row) + [span(f"▲ {mark}", "mark")] * bool(mark)
    return " ".join([text(entry.title), *marks])


def _folders(comparison: Comparison) -> list[str]:
    """Tables with a row of means for each folder."""
    rows = [(name, means) for name, means in comparison.folders.items()]
    return _by_method(comparison, "Mean E in degrees, by folder", "folder", rows)


def _by_method(
    comparison: Comparison,
    caption: str,
    what: str,
    rows: Sequence[tuple[str, Sequence[Score]]],
    means: Sequence[Score] = (),
) -> list[str]:
    """Tables with a column for each entry, the best first: one without tuning, one with tuning."""
    tables = []
    for kind, shown in _groups(comparison):
        least = [min(scores[row].e_deg for row in shown) for _, scores in rows]
        body = [
            [text(name), *(_emphasized(scores[row], lowest) for row in shown)]
            for (name, scores), lowest in zip(rows, least, strict=True)
        ]
        last = ["mean", *(e_cell(means[row]) for row in shown)] if means else []
        head = headings([what, *(text(comparison.entries[row].method.title) for row in shown)])
        tables.append(table(f"{caption}, methods {kind}; the smallest of each row in bold.", head, body, last))
    return tables


def _emphasized(score: Score, lowest_deg: float) -> str:
    return f"<b>{e_cell(score)}</b>" if isfinite(lowest_deg) and score.e_deg == lowest_deg else e_cell(score)


def _groups(comparison: Comparison) -> list[tuple[str, list[int]]]:
    """Rows of the entries without and with tuning, the best first."""
    given = [row for row in comparison.ranked if not comparison.entries[row].is_tuned]
    tuned = [row for row in comparison.ranked if comparison.entries[row].is_tuned]
    has_config = any(entry.source is ParamsFrom.CONFIG for entry in comparison.entries)
    kind = "with the config's parameters or their defaults" if has_config else "with their defaults"
    return [(kind, given), *[("tuned", tuned)] * bool(tuned)]


def _figures(comparison: Comparison) -> list[str]:
    plotted = [session for session in comparison.sessions if session.curves is not None]
    of = len(comparison.sessions)
    remark = f" The first of each folder, of {of} sessions." if len(plotted) < of else ""
    return [_figure(comparison, kind, plotted, shown, remark) for kind, shown in _groups(comparison)]


def _figure(
    comparison: Comparison, kind: str, plotted: Sequence[ComparedSession], shown: Sequence[int], remark: str
) -> str:
    entries = comparison.entries
    plotted = _largest_first(comparison, plotted)
    marks = [
        (key_of(entries[row]), *line_style_of(entries[row]).mark, text(entries[row].method.title)) for row in shown
    ]
    legend = switches([("reference", "ink", "key dotted", "reference"), *marks])
    for row in set(shown) - _first_shown(comparison, shown):
        switch = f'data-switch="{key_of(entries[row])}"'
        legend = legend.replace(switch, f'data-off="" {switch}')
    caption = (
        f"<b>Methods {kind}.</b> Yaw, and below its error: linear within a degree, logarithmic beyond it. The first "
        "session has the largest error of the best method. Click a name to show or hide its curves."
        f"{remark}<br/>{legend}"
    )
    names = [_panel_name(session) for session in plotted]
    drawn = panels(names, session_svgs(plotted, entries, shown))
    return figure(caption, drawn.replace('class="panel"', 'class="panel wide"', 1))


def _largest_first(comparison: Comparison, plotted: Sequence[ComparedSession]) -> list[ComparedSession]:
    """Plotted sessions, the one with the largest error of the best method first."""
    best = best_of(comparison)
    first = max(plotted, key=lambda session: session.scores[best].e_deg)
    return [first, *(session for session in plotted if session is not first)]


def _first_shown(comparison: Comparison, shown: Sequence[int]) -> set[int]:
    """Rows whose curves are shown at first: the best real-time methods, and the start calibration."""
    start = [row for row in shown if comparison.entries[row].method.key == "start"]
    real_time = [row for row in shown if not comparison.entries[row].method.is_offline and row not in start]
    return {*real_time[:SHOWN], *start}


def _panel_name(session: ComparedSession) -> str:
    name = text(session.session.name)
    return f'<b title="{name}">{name}</b>' + span(f"{text(session.folder)}, {session.session.minutes:.3g} min", "note")


def _sessions(comparison: Comparison) -> list[str]:
    rows = [(_session_name(comparison, session), session.scores) for session in comparison.sessions]
    return _by_method(comparison, "E in degrees", "session", rows, comparison.means)


def _session_name(comparison: Comparison, session: ComparedSession) -> str:
    return f"{session.folder}/{session.session.name}" if len(comparison.folders) > 1 else session.session.name


def _entries(entries: Sequence[Entry]) -> str:
    return facts([(text(entry.title), _entry(entry)) for entry in entries])


def _entry(entry: Entry) -> str:
    values = ", ".join(f"<code>{name} {significant(value, 4)}</code>" for name, value in entry.params.items())
    package = f"<code>{entry.method.package} {entry.method.version}</code>" if entry.method.package else ""
    about = text(entry.method.about) if entry.source is ParamsFrom.DEFAULTS else ""
    return ". ".join(part for part in (package, values, about) if part)


def _used(comparison: Comparison) -> list[UsedFile]:
    """Compared sessions, then training sessions."""
    is_tuned = bool(comparison.train)
    used = [
        UsedFile(_session_name(comparison, session), session.session.digest, "compared" if is_tuned else "")
        for session in comparison.sessions
    ]
    return used + [
        UsedFile(name, about.digest, "tuning")
        for name, about in zip(comparison.train, comparison.trained_on, strict=True)
    ]


def _config_words(comparison: Comparison) -> str:
    """Sources of the parameters, and the digest of the config."""
    config = comparison.config
    digest = [] if config is None else [f"SHA-256 of {config.name}: {config.sha256}."]
    return " ".join([*sources(comparison), *digest])
