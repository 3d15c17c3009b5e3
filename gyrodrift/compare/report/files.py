"""A comparison as a JSON file, as a table for a terminal, and the sources of its parameters in sentences."""

from collections.abc import Iterator, Sequence
from dataclasses import asdict
from functools import partial
from typing import Any

from gyrodrift import __version__
from gyrodrift.compare.comparison import ComparedSession, Comparison, ConfigFile, Entry, ParamsFrom
from gyrodrift.compare.methods.method import Method
from gyrodrift.evaluation.score import Score, Uncertainty
from gyrodrift.io.installation import package_command
from gyrodrift.report.numbers import aligned, significant
from gyrodrift.values.words import counted

DIGITS = 3

NAMED = 6
"""Most training sessions that are named."""


def content(comparison: Comparison, command: str = "") -> dict[str, Any]:
    """Content of `compare.json`."""
    return {
        "command": command,
        "version": __version__,
        "train": list(comparison.train),
        "iterations": comparison.iterations if comparison.train else None,
        "seed": comparison.seed if comparison.train else None,
        "config": _config(comparison.config),
        "best": comparison.entries[best_of(comparison)].method.key,
        "methods": [_entry(comparison, row) for row in range(len(comparison.entries))],
        "missing": [{"method": method.key, "package": method.package} for method in comparison.missing],
        "folders": [
            {"folder": name, "methods": _scores(comparison.entries, means)}
            for name, means in comparison.folders.items()
        ],
        "sessions": [_session(comparison.entries, session) for session in comparison.sessions],
        "notes": list(comparison.notes),
        "seconds": round(comparison.seconds, 3),
    }


def _config(config: ConfigFile | None) -> dict[str, Any] | None:
    if config is None:
        return None
    tuning = None if config.tuning is None else {"filter": config.tuning.filter, "command": config.tuning.command}
    return {"name": config.name, "sha256": config.sha256, "filters": sorted(config.filters), "tuning": tuning}


def _entry(comparison: Comparison, row: int) -> dict[str, Any]:
    entry, stated = comparison.entries[row], comparison.mean_uncertainties[row]
    return {
        "method": entry.method.key,
        "title": entry.title,
        "tuned": entry.is_tuned,
        "offline": entry.method.is_offline,
        "package": entry.method.package or None,
        "version": entry.method.version or None,
        "about": entry.method.about,
        "parameters": dict(entry.params),
        "parameters_from": entry.source.value,
        "trained_on": [session.session.name for session in comparison.trained_on_by(entry)],
        **_errors(comparison.means[row]),
        **_stated(stated),
    }


def _scores(entries: Sequence[Entry], scores: Sequence[Score]) -> list[dict[str, Any]]:
    return [
        {"method": entry.method.key, "tuned": entry.is_tuned, **_errors(score)}
        for entry, score in zip(entries, scores, strict=True)
    ]


def _errors(score: Score) -> dict[str, float]:
    """The score without CRPS, which the uncertainty has."""
    return {name: value for name, value in asdict(score).items() if name != "crps_deg"}


def _session(entries: Sequence[Entry], session: ComparedSession) -> dict[str, Any]:
    return {
        "name": session.session.name,
        "folder": session.folder,
        "sha256": session.session.digest,
        "minutes": session.session.minutes,
        "sample_rate_hz": session.session.sample_rate_hz,
        "methods": [
            {**score, **_stated(stated)}
            for score, stated in zip(_scores(entries, session.scores), session.uncertainties, strict=True)
        ],
    }


def _stated(stated: Uncertainty | None) -> dict[str, float | None]:
    """Coverage and CRPS; null for a method without uncertainty."""
    return {
        "within_2_sigma": None if stated is None else stated.coverage,
        "crps_deg": None if stated is None else stated.crps_deg,
    }


def summary(comparison: Comparison) -> list[str]:
    """Lines for a terminal: means over all sessions, the best first, then E by folder and sources of the parameters."""
    sessions = len(comparison.sessions)
    means = f"mean over {counted(sessions, 'session')}; E, largest error and CRPS in deg"
    lines = [f"{means}, NE in deg/min, PI in deg²; * is the best in real time"]
    lines += aligned(
        [["", "E", "NE", "PI", "largest", "2σ", "CRPS"], *map(partial(_line, comparison), comparison.ranked)]
    )
    lines += [f"{method.title}: {absence(method)}" for method in comparison.missing]
    if len(comparison.folders) > 1:
        lines += ["", "mean E by folder, deg", *_by_folder(comparison)]
    return [*lines, "", *sources(comparison)]


def _line(comparison: Comparison, row: int) -> list[str]:
    """Row of the table; the best real-time method is marked."""
    mark = "* " if row == best_of(comparison) else "  "
    return [
        mark + comparison.entries[row].title,
        *cells(comparison.means[row]),
        *uncertainty_cells(comparison.mean_uncertainties[row]),
    ]


def best_of(comparison: Comparison) -> int:
    """Row with the smallest mean E among real-time methods; among all methods if no method runs in real time."""
    return (*comparison.streaming, *comparison.ranked)[0]


def uncertainty_cells(stated: Uncertainty | None) -> list[str]:
    """Cells of coverage within two standard deviations and of CRPS."""
    return ["–", "–"] if stated is None else [f"{100.0 * stated.coverage:.0f} %", significant(stated.crps_deg, DIGITS)]


def cells(score: Score) -> list[str]:
    """Cells of E, NE, PI and the largest error."""
    return [significant(value, DIGITS) for value in (score.e_deg, score.ne, score.pi_deg2, score.worst_deg)]


def e_cell(score: Score) -> str:
    """Cell of E."""
    return significant(score.e_deg, DIGITS)


def absence(method: Method) -> str:
    """Reason for a method without numbers."""
    return f"its package {method.package} is not installed ({package_command(method.package)})"


def _by_folder(comparison: Comparison) -> list[str]:
    entries = comparison.entries
    names = ["", *(entry.method.key for entry in entries)]
    marks = ["", *("tuned" if entry.is_tuned else "" for entry in entries)]
    head = [names, marks] if comparison.train else [names]
    rows = [[name, *map(e_cell, means)] for name, means in comparison.folders.items()]
    return aligned([*head, *rows])


def sources(comparison: Comparison) -> list[str]:
    """A sentence for each source, as plain text."""
    return [*_given(comparison), _trained(comparison)]


def _given(comparison: Comparison) -> Iterator[str]:
    by_config = [entry for entry in comparison.entries if entry.source is ParamsFrom.CONFIG]
    for entry in by_config:
        yield _by_config(comparison, entry)
    yield f"Every {'other ' * bool(by_config)}method ran with its defaults."


def _by_config(comparison: Comparison, entry: Entry) -> str:
    """Source of the parameters of a filter in a config."""
    config = comparison.config
    name, tuning = (config.name, config.tuning) if config is not None else ("", None)
    ran = f"{entry.method.title} ran with the parameters of {name}"
    if tuning is None or tuning.filter != entry.method.key:
        return f"{ran}, which has no provenance."
    if tuning.is_default:
        return f"{ran}, which are its defaults: tune found no better parameters on held-out sessions."
    effort = [f"{tuning.iterations} evaluations"] if tuning.iterations is not None else []
    effort += [f"seed {tuning.seed}"] if tuning.seed is not None else []
    details = f" ({', '.join(effort)})" if effort else ""
    return f"{ran}, tuned{details} on {_count(len(tuning.training), 'session')}: {_overlap(comparison, entry)}."


def _overlap(comparison: Comparison, entry: Entry) -> str:
    count = len(comparison.trained_on_by(entry))
    return f"{count} of them are compared here" if count else "none of them is compared here"


def _trained(comparison: Comparison) -> str:
    if not comparison.train:
        return "Nothing was tuned here; --train tunes every method on other sessions."
    unnamed = len(comparison.train) - NAMED
    names = ", ".join(comparison.train[:NAMED]) + (f" and {unnamed} more" if unnamed > 0 else "")
    return (
        f"Tuned rows: every method with {comparison.iterations} evaluations and seed {comparison.seed} on {names}. "
        "Parameters that the search did not improve are kept."
    )


def _count(count: int, noun: str) -> str:
    return f"{count} {noun}{'s' * (count != 1)}"


def shared(comparison: Comparison, entry: Entry) -> str:
    """Mark of a row whose training sessions are compared here; empty for other rows."""
    count = len(comparison.trained_on_by(entry))
    return f"tuned on {count} of these" if count else ""
