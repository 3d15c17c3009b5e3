"""A finding of a check of a recording: what contradicts what, and the option that mends it."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class SessionFinding:
    """One finding.

    id
        Of the check, as `doctor --json` calls it: `clock_unit`, `rate_unit`, `restarts` and others.
    says
        What is so, with the numbers, as a sentence without its full stop.
    do
        What mends it; empty where nothing has to be done.
    is_error
        Whether the yaw of this recording would be wrong. A warning is less sure, or is put right.
    """

    id: str
    says: str
    do: str = ""
    is_error: bool = False

    def __str__(self) -> str:
        return f"{self.says}; {self.do}" if self.do else self.says
