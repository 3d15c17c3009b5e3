"""The report of a comparison: one HTML file for a person, with the table first, and then every session."""

from collections.abc import Sequence
from dataclasses import replace
from math import isfinite

from gyrodrift.compare.comparison import PLOTTED, ComparedSession, Comparison, Entry, ParamsFrom
from gyrodrift.compare.report.figures import key_of, look_of, session_svgs
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

MEASURES = (
    "E is the mean absolute yaw error, NE is E divided by the session's minutes, PI the mean squared error, largest "
    "the largest absolute error; each is a mean over sessions."
)
UNCERTAINTY = (
    "Within 2σ is the share of samples whose error is within two of the standard deviations that the method states of "
    "its yaw: 95 % where it is honest, more where it is too careful. CRPS, the continuous ranked probability score, is "
    "the mean absolute error of what is stated as a normal distribution; without an uncertainty it is E."
)
OFFLINE = "What an offline method sees no device can see: it is a bound, not a rival."
HOW = (
    "Yaw and reference are compared unwrapped, both from 0 at the first sample that has a reference; samples whose "
    "time does not advance are left out for all alike. Each method is given times and rates and no more; where a "
    "package wants three axes, the device lies level."
)


def report_html(comparison: Comparison, made: Provenance) -> str:
    """The page of a comparison, and where it comes from."""
    body = [
        _verdict(comparison, made.set_name),
        section("Yaw error by method", *_ranking(comparison)),
        section("By folder", *_folders(comparison)) if len(comparison.folders) > 1 else "",
        section("Yaw and its error over time", *_figures(comparison)),
        section("Session by session", *_sessions(comparison)),
        section("What ran", _entries(comparison.entries), paragraph(f"{HOW} It took {comparison.seconds:.3g} s.")),
        provenance(replace(made, sessions=_used(comparison), config=_config_words(comparison))),
    ]
    return page(f"Yaw drift compared on {made.set_name}", [part for part in body if part])


def _verdict(comparison: Comparison, set_name: str) -> str:
    count, minutes = len(comparison.sessions), sum(one.session.minutes for one in comparison.sessions)
    extent = f"{count} session{'s' * (count > 1)}, {significant(minutes, 3)} minutes"
    return header(
        f"gyrodrift compare · {set_name} · {extent}",
        _headline(comparison, set_name),
        warnings("Before believing it", [*comparison.notes, *_absences(comparison)]),
        paragraph(_in_words(comparison)),
        paragraph(" ".join(map(text, sources(comparison)))),
    )


def _headline(comparison: Comparison, set_name: str) -> str:
    """The best of those that a device can run."""
    best = comparison.entries[comparison.streaming[0]]
    seen = shared(comparison, best)
    e_deg = degrees(comparison.means[comparison.streaming[0]].e_deg)
    return f"Least yaw error on {set_name}: {best.title}{f' ({seen})' if seen else ''}, {e_deg} on average"


def _in_words(comparison: Comparison) -> str:
    """How clear it is that the best one is."""
    if len(comparison.streaming) < 2:
        return ""
    first, second = comparison.streaming[:2]
    ahead = sum(one.scores[first].e_deg < one.scores[second].e_deg for one in comparison.sessions)
    best, following = (text(comparison.entries[at].title) for at in (first, second))
    count = len(comparison.sessions)
    return (
        f"Next is {following} with {degrees(comparison.means[second].e_deg)}; <b>{best}</b> has the smaller error on "
        f"{ahead} of {count} session{'s' * (count > 1)}. Only methods that stream are meant here."
    )


def _absences(comparison: Comparison) -> list[str]:
    return [f"{method.title} did not run: {absence(method)}." for method in comparison.missing]


def _ranking(comparison: Comparison) -> list[str]:
    """The table of means, the best first, with a forest plot."""
    says_sigma = any(comparison.mean_uncertainties)
    units = ["E, deg", "NE, deg/min", "PI, deg²", "largest, deg", *["within 2σ", "CRPS, deg"] * says_sigma]
    numbers = [one for score in comparison.sessions for one in score.scores]
    axis = forest_axis([score.e_deg for score in [*numbers, *comparison.means]])
    names = [_session_name(comparison, one) for one in comparison.sessions]
    rows = []
    for at in comparison.ranked:
        entry, mean = comparison.entries[at], comparison.means[at]
        errors_deg = [one.scores[at].e_deg for one in comparison.sessions]
        drawn = strip(axis, names, errors_deg, mean.e_deg, entry.method.colour)
        stated = uncertainty_cells(comparison.mean_uncertainties[at]) if says_sigma else []
        rows.append([_name(comparison, at), *cells(mean), *stated, drawn])
    rows += [[text(method.title), *["–"] * len(units), ""] for method in comparison.missing]
    head = headings(["method", *units, "E of each session (dots) and its mean (bar), deg"], words=1)
    count = len(comparison.sessions)
    caption = f"Means over {count} session{'s' * (count > 1)}, the least E first. The axis of the dots counts factors."
    foot = ["", *[""] * len(units), scale(axis)]
    words = [MEASURES, *[UNCERTAINTY] * says_sigma, *[OFFLINE] * any(e.method.is_offline for e in comparison.entries)]
    return [table(caption, head, rows, foot, words=1), paragraph(" ".join(words), "note")]


def _name(comparison: Comparison, at: int) -> str:
    """Of a row, with what marks it."""
    entry = comparison.entries[at]
    seen = shared(comparison, entry)
    marks = [span("best", "best")] * (best_of(comparison) == at) + [span(f"▲ {seen}", "mark")] * bool(seen)
    return " ".join([text(entry.title), *marks])


def _folders(comparison: Comparison) -> list[str]:
    """A row of means for each folder."""
    rows = [(name, means) for name, means in comparison.folders.items()]
    return _by_method(comparison, "Mean E in degrees, by folder", "folder", rows)


def _by_method(
    comparison: Comparison,
    caption: str,
    what: str,
    rows: Sequence[tuple[str, Sequence[Score]]],
    means: Sequence[Score] = (),
) -> list[str]:
    """A table with a column for each entry, the best first: one of those as they came, and one of the tuned ones."""
    found = []
    for kind, shown in _groups(comparison):
        least = [min(scores[at].e_deg for at in shown) for _, scores in rows]
        body = [
            [text(name), *(_emphasised(scores[at], lowest) for at in shown)]
            for (name, scores), lowest in zip(rows, least, strict=True)
        ]
        last = ["mean", *(e_cell(means[at]) for at in shown)] if means else []
        head = headings([what, *(text(comparison.entries[at].method.title) for at in shown)])
        found.append(table(f"{caption}, methods {kind}; the least of each row in bold.", head, body, last))
    return found


def _emphasised(score: Score, lowest_deg: float) -> str:
    return f"<b>{e_cell(score)}</b>" if isfinite(lowest_deg) and score.e_deg == lowest_deg else e_cell(score)


def _groups(comparison: Comparison) -> list[tuple[str, list[int]]]:
    """Numbers of the entries by what they ran with, the best first."""
    given = [at for at in comparison.ranked if not comparison.entries[at].is_tuned]
    tuned = [at for at in comparison.ranked if comparison.entries[at].is_tuned]
    has_config = any(one.source is ParamsFrom.CONFIG for one in comparison.entries)
    kind = "with the config's parameters or their defaults" if has_config else "with their defaults"
    return [(kind, given), *[("tuned", tuned)] * bool(tuned)]


def _figures(comparison: Comparison) -> list[str]:
    plotted = [one for one in comparison.sessions if one.curves is not None]
    of = len(comparison.sessions)
    said = f" Of {of} sessions, more than {PLOTTED}, the first of each folder." if len(plotted) < of else ""
    return [_figure(comparison, kind, plotted, shown, said) for kind, shown in _groups(comparison)]


def _figure(
    comparison: Comparison, kind: str, plotted: Sequence[ComparedSession], shown: Sequence[int], said: str
) -> str:
    entries = comparison.entries
    marks = [(key_of(entries[at]), *look_of(entries[at]).mark, text(entries[at].method.title)) for at in shown]
    key = switches([("reference", "ink", "key dotted", "reference"), *marks])
    caption = (
        f"<b>Methods {kind}.</b> Above yaw, below its error: within a degree to scale, larger ones by factors of ten."
        f"{said}<br/>{key}"
    )
    names = [_panel_name(one) for one in plotted]
    return figure(caption, panels(names, session_svgs(plotted, entries, shown)))


def _panel_name(one: ComparedSession) -> str:
    name = text(one.session.name)
    return f'<b title="{name}">{name}</b>' + span(f"{text(one.folder)}, {one.session.minutes:.3g} minutes", "note")


def _sessions(comparison: Comparison) -> list[str]:
    rows = [(_session_name(comparison, one), one.scores) for one in comparison.sessions]
    return _by_method(comparison, "E in degrees", "session", rows, comparison.means)


def _session_name(comparison: Comparison, one: ComparedSession) -> str:
    return f"{one.folder}/{one.session.name}" if len(comparison.folders) > 1 else one.session.name


def _entries(entries: Sequence[Entry]) -> str:
    return facts([(text(entry.title), _entry(entry)) for entry in entries])


def _entry(entry: Entry) -> str:
    values = ", ".join(f"<code>{name} {significant(value, 4)}</code>" for name, value in entry.params.items())
    package = f"<code>{entry.method.package} {entry.method.version}</code>" if entry.method.package else ""
    said = text(entry.method.about) if entry.source is ParamsFrom.DEFAULTS else ""
    return ". ".join(part for part in (package, values, said) if part)


def _used(comparison: Comparison) -> list[UsedFile]:
    """The sessions: those compared, and those tuned on."""
    is_tuned = bool(comparison.train)
    used = [
        UsedFile(_session_name(comparison, one), one.session.digest, "compared" if is_tuned else "")
        for one in comparison.sessions
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
