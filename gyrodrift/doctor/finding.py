"""Finding of a check: its severity, a sentence, the advice, and the number behind it."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from enum import StrEnum
from typing import Any

from gyrodrift.io.json_numbers import finite
from gyrodrift.outputs.health import Health, HealthLevel


class Severity(StrEnum):
    """Severity of a finding, lowest first.

    ok
        As it should be.
    note
        Good to know; yaw does not suffer.
    warning
        Yaw suffers, or will suffer.
    error
        No yaw, or a yaw that cannot be trusted.
    """

    OK = "ok"
    NOTE = "note"
    WARNING = "warning"
    ERROR = "error"

    @property
    def rank(self) -> int:
        """Position in the order of severities, from 0."""
        return list(Severity).index(self)


@dataclass(frozen=True, slots=True)
class DeviceFinding:
    """Sentence about a device.

    id
        Id of the check.
    says, do
        The state, and the advice; `do` is empty if there is nothing to do.
    value, unit
        The number behind the sentence; None without a number.
    """

    severity: Severity
    says: str
    do: str = ""
    value: float | None = None
    unit: str = ""
    id: str = ""


def ok(says: str, value: float | None = None, unit: str = "", do: str = "") -> DeviceFinding:
    """Finding of severity ok."""
    return DeviceFinding(Severity.OK, says, do, value, unit)


def note(says: str, do: str = "", value: float | None = None, unit: str = "") -> DeviceFinding:
    """Finding of severity note."""
    return DeviceFinding(Severity.NOTE, says, do, value, unit)


def warning(says: str, do: str, value: float | None = None, unit: str = "") -> DeviceFinding:
    """Finding of severity warning."""
    return DeviceFinding(Severity.WARNING, says, do, value, unit)


def error(says: str, do: str, value: float | None = None, unit: str = "") -> DeviceFinding:
    """Finding of severity error."""
    return DeviceFinding(Severity.ERROR, says, do, value, unit)


def of_error(text: str) -> DeviceFinding:
    """Finding from the message of an exception: the problem, a semicolon, the advice."""
    says, _, do = text.partition("; ")
    return error(sentence(says), sentence(do))


def of_health(health: Health, severity: Severity, do: str, value: float | None = None, unit: str = "") -> DeviceFinding:
    """Finding in the words of a running service; its level BAD becomes an error."""
    return DeviceFinding(Severity.ERROR if health.level is HealthLevel.BAD else severity, health.says, do, value, unit)


def sentence(text: str) -> str:
    """Text with a capital letter and a full stop."""
    text = text.strip()
    if not text:
        return ""
    return text[0].upper() + text[1:] + ("" if text[-1] in ".?!" else ".")


def worst(findings: Sequence[DeviceFinding]) -> Severity:
    """Highest severity; ok without findings."""
    return max((finding.severity for finding in findings), key=lambda severity: severity.rank, default=Severity.OK)


def as_json(source: str, findings: Sequence[DeviceFinding], extra: Mapping[str, Any] | None = None) -> str:
    """One JSON object on one line, with the keys of `extra` at its end; a value that is not finite is null."""
    rows = [
        {"id": finding.id, **asdict(finding), "value": None if finding.value is None else finite(float(finding.value))}
        for finding in findings
    ]
    report: dict[str, Any] = {"source": source, "severity": worst(findings), "findings": rows}
    return json.dumps(report | dict(extra or {}), ensure_ascii=False, allow_nan=False)
