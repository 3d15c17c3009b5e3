"""Findings as text, the worst first, at the width of the terminal; in a pipe one line per finding. Also as JSON."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from enum import Enum
from math import isfinite
from typing import TYPE_CHECKING, Any, TextIO

from gyrodrift.doctor.finding import DeviceFinding, Severity, worst

if TYPE_CHECKING:
    from rich.table import Table
    from rich.text import Text

MARKS = {
    Severity.ERROR: ("✗", "bold red"),
    Severity.WARNING: ("!", "yellow"),
    Severity.NOTE: ("·", "cyan"),
    Severity.OK: ("✓", "green"),
}
PIPE_WIDTH = 100_000
WIDE = 120
"""Columns of a terminal from which the advice has its own column."""

DRIFT = "drift_"
"""Beginning of the ids of the expected drift, which is always of interest."""


class Detail(Enum):
    """Findings to show: problems, problems and the expected drift, or all."""

    PROBLEMS = "problems"
    SUMMARY = "summary"
    ALL = "all"

    def shows(self, finding: DeviceFinding) -> bool:
        """Whether a finding is shown."""
        if self is Detail.ALL or finding.severity is not Severity.OK:
            return True
        return self is Detail.SUMMARY and finding.id.startswith(DRIFT)


def show(source: str, findings: Sequence[DeviceFinding], stream: TextIO, detail: Detail) -> None:
    """Print the findings of a port or recording, and their count by severity."""
    from rich.console import Console
    from rich.text import Text

    console = Console(file=stream, highlight=False, width=None if stream.isatty() else PIPE_WIDTH)
    shown = sorted(filter(detail.shows, findings), key=lambda finding: -finding.severity.rank)
    console.print(Text(source, style="bold"))
    if not stream.isatty():
        console.print(*(Text.assemble(MARKS[finding.severity][0], " ", _body(finding)) for finding in shown), sep="\n")
    elif shown:
        console.print(_wide(shown) if console.width >= WIDE else _narrow(shown))
    hidden = len(findings) - len(shown)
    hint = f" ({hidden} not shown; --verbose shows all)" if hidden and detail is Detail.SUMMARY else ""
    console.print(Text(f"{counted(findings)}{hint}", style=MARKS[worst(findings)][1]))


def _body(finding: DeviceFinding) -> "Text":
    """A finding and its advice on one line."""
    from rich.text import Text

    return Text.assemble((f"{finding.id}: ", "bold"), finding.says, f" → {finding.do}" if finding.do else "")


def _narrow(findings: Sequence[DeviceFinding]) -> "Table":
    """One column of findings with their advice."""
    from rich.table import Table
    from rich.text import Text

    table = Table.grid(padding=(0, 1))
    for finding in findings:
        mark, style = MARKS[finding.severity]
        table.add_row(Text(mark, style=style), _body(finding))
    return table


def _wide(findings: Sequence[DeviceFinding]) -> "Table":
    """Columns for the check, the finding and the advice, over the whole width."""
    from rich.table import Table
    from rich.text import Text

    table = Table.grid(padding=(0, 2, 0, 0), expand=True)
    table.add_column(no_wrap=True)
    table.add_column(no_wrap=True, style="bold")
    table.add_column(ratio=3)
    table.add_column(ratio=2)
    for finding in findings:
        mark, style = MARKS[finding.severity]
        advice = f"→ {finding.do}" if finding.do else ""
        table.add_row(Text(mark, style=style), Text(finding.id), Text(finding.says), Text(advice))
    return table


def counted(findings: Sequence[DeviceFinding]) -> str:
    """Count of findings by severity: `1 error, 2 warnings, 3 notes, 20 ok`."""
    counts = []
    for severity in reversed(Severity):
        count = sum(finding.severity is severity for finding in findings)
        if count:
            plural = "" if count == 1 or severity is Severity.OK else "s"
            counts.append(f"{count} {severity}{plural}")
    return ", ".join(counts) or "no findings"


def as_json(source: str, findings: Sequence[DeviceFinding], extra: Mapping[str, Any] | None = None) -> str:
    """One JSON object on one line, with the keys of `extra` at its end; a value that is not finite is null."""
    rows = [asdict(finding) | {"value": _finite(finding.value)} for finding in findings]
    keys = ("id", "severity", "says", "do", "value", "unit")
    report: dict[str, Any] = {
        "source": source,
        "severity": worst(findings),
        "findings": [{key: row[key] for key in keys} for row in rows],
    }
    return json.dumps(report | dict(extra or {}), ensure_ascii=False, allow_nan=False)


def _finite(value: float | None) -> float | None:
    return None if value is None or not isfinite(value) else float(value)
