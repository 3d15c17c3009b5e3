"""A comparison as numbers in a file, and as a table on a terminal."""

import json
from collections.abc import Sequence
from dataclasses import asdict
from math import isfinite
from pathlib import Path
from typing import Any

from gyrodrift import __version__
from gyrodrift.compare.comparison import ComparedSession, Comparison, Entry
from gyrodrift.compare.methods.method import Method
from gyrodrift.evaluation.score import Score
from gyrodrift.files import write_whole
from gyrodrift.html.numbers import significant
from gyrodrift.installation import package_command

DIGITS = 3


def write_json(path: Path, comparison: Comparison, command: str = "") -> None:
    """Write the numbers, whole or not at all; what is infinite is null.

    Raises
    ------
    UsageError
        Where the place cannot be written to.
    """
    content = {
        "command": command,
        "version": __version__,
        "train": list(comparison.train),
        "iterations": comparison.iterations if comparison.train else None,
        "seed": comparison.seed if comparison.train else None,
        "methods": [_entry(*pair) for pair in zip(comparison.entries, comparison.means, strict=True)],
        "missing": [{"method": method.key, "package": method.package} for method in comparison.missing],
        "folders": [
            {"folder": name, "methods": _scores(comparison.entries, means)}
            for name, means in comparison.folders.items()
        ],
        "sessions": [_session(comparison.entries, one) for one in comparison.sessions],
        "notes": list(comparison.notes),
        "seconds": round(comparison.seconds, 3),
    }
    write_whole(path, [json.dumps(content, indent=1, allow_nan=False, ensure_ascii=False), "\n"])


def _entry(entry: Entry, mean: Score) -> dict[str, Any]:
    return {
        "method": entry.method.key,
        "title": entry.title,
        "tuned": entry.is_tuned,
        "offline": entry.method.is_offline,
        "package": entry.method.package or None,
        "version": entry.method.version or None,
        "about": entry.method.about,
        "parameters": dict(entry.params),
        **_numbers(mean),
    }


def _scores(entries: Sequence[Entry], scores: Sequence[Score]) -> list[dict[str, Any]]:
    return [
        {"method": entry.method.key, "tuned": entry.is_tuned, **_numbers(score)}
        for entry, score in zip(entries, scores, strict=True)
    ]


def _session(entries: Sequence[Entry], one: ComparedSession) -> dict[str, Any]:
    return {
        "name": one.session.name,
        "folder": one.folder,
        "sha256": one.session.digest,
        "minutes": one.session.minutes,
        "sample_rate_hz": one.session.sample_rate_hz,
        "methods": _scores(entries, one.scores),
    }


def _numbers(score: Score) -> dict[str, float | None]:
    return {name: value if isfinite(value) else None for name, value in asdict(score).items()}


def summary(comparison: Comparison) -> list[str]:
    """The table of means over all sessions, with several folders that of E by folder, and what is not in them."""
    sessions = len(comparison.sessions)
    lines = [
        f"mean over {sessions} session{'s' * (sessions > 1)}; E and largest error in deg, NE in deg/min, PI in deg²"
    ]
    rows = [[entry.title, *cells(mean)] for entry, mean in zip(comparison.entries, comparison.means, strict=True)]
    lines += _aligned([["", "E", "NE", "PI", "largest"], *rows])
    lines += [f"{method.title}: {absence(method)}" for method in comparison.missing]
    if len(comparison.folders) > 1:
        lines += ["", "mean E by folder, deg", *_by_folder(comparison)]
    if not comparison.train:
        lines += ["", "nothing is tuned here: give sessions to tune every method on with --train"]
    return lines


def cells(score: Score) -> list[str]:
    """E, NE, PI and the largest error, each with three digits."""
    return [significant(value, DIGITS) for value in (score.e_deg, score.ne, score.pi_deg2, score.worst_deg)]


def e_cell(score: Score) -> str:
    """E alone."""
    return significant(score.e_deg, DIGITS)


def absence(method: Method) -> str:
    """Why a method has no numbers."""
    return f"its package {method.package} is not installed ({package_command(method.package)})"


def _by_folder(comparison: Comparison) -> list[str]:
    entries = comparison.entries
    names = ["", *(entry.method.key for entry in entries)]
    marks = ["", *("tuned" if entry.is_tuned else "" for entry in entries)]
    head = [names, marks] if comparison.train else [names]
    rows = [[name, *map(e_cell, means)] for name, means in comparison.folders.items()]
    return _aligned([*head, *rows])


def _aligned(rows: Sequence[Sequence[str]]) -> list[str]:
    """Columns as wide as they have to be, the first to the left and the numbers to the right."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        "  ".join(cell.ljust(width) if at == 0 else cell.rjust(width) for at, (cell, width) in pairs).rstrip()
        for pairs in (list(enumerate(zip(row, widths, strict=True))) for row in rows)
    ]
