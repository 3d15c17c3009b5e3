"""Finding of a check of a recording: a contradiction, and the option that resolves it."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class SessionFinding:
    """One finding.

    id
        Name of the check, as in `doctor --json`: `clock_unit`, `rate_unit`, `restarts` and others.
    says
        Observation with numbers, a sentence without a full stop.
    do
        Remedy; may be empty.
    is_error
        Whether the yaw would be wrong. A warning is uncertain or already corrected.
    """

    id: str
    says: str
    do: str = ""
    is_error: bool = False

    def __str__(self) -> str:
        return f"{self.says}; {self.do}" if self.do else self.says
