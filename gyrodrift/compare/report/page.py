"""The report of a comparison: one HTML file for a person, with the table first, and then every session."""

from collections.abc import Sequence

from gyrodrift.compare.comparison import PLOTTED, ComparedSession, Comparison, Entry
from gyrodrift.compare.report.figures import look_of, session_svgs
from gyrodrift.compare.report.files import absence, cells, e_cell
from gyrodrift.html.html import (
    command_line,
    facts,
    figure,
    header,
    headings,
    legend,
    page,
    panels,
    paragraph,
    section,
    span,
    table,
    text,
    warnings,
)
from gyrodrift.html.numbers import degrees, significant

MEASURES = (
    "E is the mean absolute yaw error in degrees, NE is E divided by the session's minutes, PI the mean squared error "
    "in deg², largest the largest absolute error in degrees; each is a mean over sessions."
)

NAMED = 6
"""So many of the training sessions are named."""

HOW = (
    "Yaw and reference are compared unwrapped, both from 0 at the first sample that has a reference; samples whose "
    "time does not advance are left out for all alike. Each method is given times and rates and no more; where a "
    "package wants three axes, the device lies level."
)


def report_html(comparison: Comparison, command: str = "") -> str:
    """The page of a comparison, with the command that made it."""
    body = [
        _verdict(comparison),
        section("By folder", *_folders(comparison)) if len(comparison.folders) > 1 else "",
        section("Yaw and its error over time", *_figures(comparison)),
        section("Session by session", _sessions_table(comparison)),
        section("What ran", _entries(comparison.entries), _how(comparison, command)),
    ]
    return page("Comparison of drift reducers", [part for part in body if part])


def _verdict(comparison: Comparison) -> str:
    rows = [[text(e.title), *cells(mean)] for e, mean in zip(comparison.entries, comparison.means, strict=True)]
    rows += [[text(method.title), *["–"] * 4] for method in comparison.missing]
    count = len(comparison.sessions)
    caption = f"Means over {count} session{'s' * (count > 1)}."
    return header(
        "gyrodrift compare · report",
        _headline(comparison),
        warnings("Before believing it", [*comparison.notes, *_absences(comparison)]),
        paragraph(MEASURES),
        table(caption, headings(["method", "E", "NE", "PI", "largest"]), rows),
        paragraph(_tuning_words(comparison)),
    )


def _headline(comparison: Comparison) -> str:
    """The best of those that a device can run."""
    streams = [pair for pair in zip(comparison.entries, comparison.means, strict=True) if not pair[0].method.is_offline]
    entry, mean = min(streams, key=lambda pair: pair[1].e_deg)
    return f"Least yaw error of what streams: {entry.title}, {degrees(mean.e_deg)} on average"


def _absences(comparison: Comparison) -> list[str]:
    return [f"{method.title} did not run: {absence(method)}." for method in comparison.missing]


def _tuning_words(comparison: Comparison) -> str:
    if not comparison.train:
        return "Every method ran with its defaults. Nothing is tuned: <code>--train</code> gives sessions to tune on."
    names = ", ".join(map(text, comparison.train[:NAMED]))
    more = len(comparison.train) - NAMED
    names += f" and {more} more" if more > 0 else ""
    return (
        f"Tuned rows: each method's own parameters, by the search that <code>tune</code> uses, {comparison.iterations} "
        f"evaluations and seed {comparison.seed} for each, on {names}; where the search ended above the defaults, "
        "these are kept. What an offline method sees no device can see: it is a bound, not a rival."
    )


def _folders(comparison: Comparison) -> list[str]:
    """A row of means for each folder."""
    rows = [[text(name), *map(e_cell, means)] for name, means in comparison.folders.items()]
    return [table("Mean E in degrees, by folder.", headings(["folder", *_titles(comparison)]), rows)]


def _titles(comparison: Comparison) -> list[str]:
    """Headings of columns, in two lines where that makes them narrow."""
    return [text(entry.title).replace(", ", ",<br/>") for entry in comparison.entries]


def _figures(comparison: Comparison) -> list[str]:
    plotted = [one for one in comparison.sessions if one.curves is not None]
    of = len(comparison.sessions)
    said = f" Of {of} sessions, more than {PLOTTED}, the first of each folder." if len(plotted) < of else ""
    entries = comparison.entries
    defaults = [at for at, entry in enumerate(entries) if not entry.is_tuned]
    with_tuned = [at for at, entry in enumerate(entries) if entry.is_tuned]
    parts = [_figure("with defaults", plotted, entries, defaults, said)]
    return [*parts, _figure("tuned", plotted, entries, with_tuned, said)] if with_tuned else parts


def _figure(
    kind: str, plotted: Sequence[ComparedSession], entries: Sequence[Entry], shown: Sequence[int], said: str
) -> str:
    marks = [(*look_of(entries[at]).mark, text(entries[at].method.title)) for at in shown]
    key = legend([("ink", "key dotted", "reference"), *marks])
    caption = (
        f"<b>Methods {kind}.</b> {key}<br/>Errors within a degree are to scale, larger ones by factors of ten.{said}"
    )
    names = [_panel_name(one) for one in plotted]
    return figure(caption, panels(names, session_svgs(plotted, entries, shown, kind.replace(" ", "-"))))


def _panel_name(one: ComparedSession) -> str:
    name = text(one.session.name)
    return f'<b title="{name}">{name}</b>' + span(f"{text(one.folder)}, {one.session.minutes:.3g} minutes", "note")


def _sessions_table(comparison: Comparison) -> str:
    several = len(comparison.folders) > 1
    rows = [[_session_name(one, several=several), *map(e_cell, one.scores)] for one in comparison.sessions]
    foot = ["mean", *map(e_cell, comparison.means)]
    return table("E in degrees.", headings(["session", *_titles(comparison)]), rows, foot)


def _session_name(one: ComparedSession, *, several: bool) -> str:
    return text(f"{one.folder}/{one.session.name}" if several else one.session.name)


def _entries(entries: Sequence[Entry]) -> str:
    return facts([(text(entry.title), _entry(entry)) for entry in entries])


def _entry(entry: Entry) -> str:
    values = ", ".join(f"<code>{name} {significant(value, 4)}</code>" for name, value in entry.params.items())
    package = f"<code>{entry.method.package} {entry.method.version}</code>" if entry.method.package else ""
    said = "" if entry.is_tuned else text(entry.method.about)
    return ". ".join(part for part in (package, values, said) if part)


def _how(comparison: Comparison, command: str) -> str:
    said = f"{HOW} It took {comparison.seconds:.3g} s."
    return paragraph(said) + command_line(command)
