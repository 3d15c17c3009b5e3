"""Check: an id, a description, and a function from the evidence to a finding."""

from collections.abc import Callable
from dataclasses import dataclass

from gyrodrift.doctor.evidence import DeviceEvidence
from gyrodrift.doctor.finding import DeviceFinding


@dataclass(frozen=True, slots=True)
class Check:
    """A check of a device or a recording.

    id
        Id of its finding in `--json`.
    about
        Description, as in docs/doctor.md.
    look
        Function that returns the finding, or None without data.
    """

    id: str
    about: str
    look: Callable[[DeviceEvidence], DeviceFinding | None]
