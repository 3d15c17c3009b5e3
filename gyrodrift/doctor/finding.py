"""What a check finds: how much it matters, a sentence, what to do, and the number behind it."""

from dataclasses import dataclass
from enum import StrEnum

from gyrodrift.outputs.health import Health, HealthLevel


class Severity(StrEnum):
    """How much it matters, the least first.

    ok
        As it should be.
    note
        Worth knowing; yaw does not suffer.
    warning
        Yaw suffers, or will.
    error
        There is no yaw, or none that can be trusted.
    """

    OK = "ok"
    NOTE = "note"
    WARNING = "warning"
    ERROR = "error"

    @property
    def rank(self) -> int:
        """0 for the least."""
        return list(Severity).index(self)


@dataclass(frozen=True, slots=True)
class DeviceFinding:
    """One sentence about a device.

    id
        Of the check that it comes from.
    says, do
        What is so, and what to do about it; `do` is empty where nothing is to be done.
    value, unit
        The number behind it; None where there is none.
    """

    severity: Severity
    says: str
    do: str = ""
    value: float | None = None
    unit: str = ""
    id: str = ""


def ok(says: str, value: float | None = None, unit: str = "", do: str = "") -> DeviceFinding:
    """As it should be."""
    return DeviceFinding(Severity.OK, says, do, value, unit)


def note(says: str, do: str = "", value: float | None = None, unit: str = "") -> DeviceFinding:
    """Worth knowing."""
    return DeviceFinding(Severity.NOTE, says, do, value, unit)


def warning(says: str, do: str, value: float | None = None, unit: str = "") -> DeviceFinding:
    """Yaw suffers."""
    return DeviceFinding(Severity.WARNING, says, do, value, unit)


def error(says: str, do: str, value: float | None = None, unit: str = "") -> DeviceFinding:
    """No yaw, or none that can be trusted."""
    return DeviceFinding(Severity.ERROR, says, do, value, unit)


def of_error(text: str) -> DeviceFinding:
    """An error's message: what happened stands before the first semicolon, what to do behind it."""
    says, _, do = text.partition("; ")
    return error(sentence(says), sentence(do))


def of_health(health: Health, severity: Severity, do: str, value: float | None = None, unit: str = "") -> DeviceFinding:
    """What a running service would say of the same link, in its words; what it calls bad is an error here."""
    return DeviceFinding(Severity.ERROR if health.level is HealthLevel.BAD else severity, health.says, do, value, unit)


def sentence(text: str) -> str:
    """With a capital and a full stop."""
    text = text.strip()
    if not text:
        return ""
    return text[0].upper() + text[1:] + ("" if text[-1] in ".?!" else ".")


def worst(findings: list[DeviceFinding]) -> Severity:
    """The most severe of them."""
    return max((each.severity for each in findings), key=lambda each: each.rank, default=Severity.OK)
