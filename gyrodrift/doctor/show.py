"""Findings for a person: what is wrong first, in as many columns as there are; one line each in a pipe."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from math import isfinite
from typing import Any, TextIO

from gyrodrift.doctor.finding import DeviceFinding, Severity, worst

MARKS = {
    Severity.ERROR: ("✗", "bold red"),
    Severity.WARNING: ("!", "yellow"),
    Severity.NOTE: ("·", "cyan"),
    Severity.OK: ("✓", "green"),
}
IN_A_PIPE = 100_000


def show(source: str, findings: Sequence[DeviceFinding], stream: TextIO, *, is_quiet: bool) -> None:
    """Print them, the worst first; those that are ok not where it is quiet."""
    from rich.console import Console  # noqa: PLC0415 - --json does without
    from rich.table import Table  # noqa: PLC0415
    from rich.text import Text  # noqa: PLC0415

    is_terminal = stream.isatty()
    console = Console(file=stream, highlight=False, width=None if is_terminal else IN_A_PIPE)
    console.print(Text(source, style="bold"))
    ordered = sorted(findings, key=lambda each: -each.severity.rank)
    for each in ordered:
        if is_quiet and each.severity is Severity.OK:
            continue
        mark, style = MARKS[each.severity]
        body = Text.assemble((f"{each.id}: ", "bold"), each.says, (f" → {each.do}" if each.do else "", ""))
        row = Table.grid(padding=(0, 1))
        row.add_row(Text(mark, style=style), body)
        console.print(row)
    console.print(Text(counted(findings), style=MARKS[worst(list(findings))][1]))


def counted(findings: Sequence[DeviceFinding]) -> str:
    """How many there are of each severity: `1 error, 2 warnings, 3 notes, 20 ok`."""
    words = []
    for severity in reversed(Severity):
        count = sum(each.severity is severity for each in findings)
        if count:
            plural = "" if count == 1 or severity is Severity.OK else "s"
            words.append(f"{count} {severity}{plural}")
    return ", ".join(words) or "nothing to be said"


def as_json(source: str, findings: Sequence[DeviceFinding], more: Mapping[str, Any] | None = None) -> str:
    """One object on one line; a value that is no finite number is null. `more` stands behind the findings."""
    rows = [asdict(each) | {"value": _finite(each.value)} for each in findings]
    keys = ("id", "severity", "says", "do", "value", "unit")
    about: dict[str, Any] = {
        "source": source,
        "severity": worst(list(findings)),
        "findings": [{key: row[key] for key in keys} for row in rows],
    }
    return json.dumps(about | dict(more or {}), ensure_ascii=False, allow_nan=False)


def _finite(value: float | None) -> float | None:
    return None if value is None or not isfinite(value) else float(value)
