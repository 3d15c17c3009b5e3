"""What a check is: a name, what it looks at, and a function from the evidence to one finding."""

from collections.abc import Callable
from dataclasses import dataclass

from gyrodrift.doctor.evidence import DeviceEvidence
from gyrodrift.doctor.finding import DeviceFinding


@dataclass(frozen=True, slots=True)
class Check:
    """One of them.

    id
        As `--json` calls its finding.
    about
        What it looks at, in a few words.
    look
        Gives the finding; None where the evidence says nothing of it.
    """

    id: str
    about: str
    look: Callable[[DeviceEvidence], DeviceFinding | None]
