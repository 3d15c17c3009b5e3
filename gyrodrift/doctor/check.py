"""Check of a device or a recording, made of a function from the evidence to a finding."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

from gyrodrift.doctor.evidence import DeviceEvidence
from gyrodrift.doctor.finding import DeviceFinding
from gyrodrift.facts.host import HostClock
from gyrodrift.facts.session_facts import SessionFacts, StillRate

Part = TypeVar("Part")
Look = Callable[[DeviceEvidence], DeviceFinding | None]


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
    look: Look


def check(look: Look) -> Check:
    """Check with the name and the docstring of a function."""
    return _named(look, look)


def check_of(
    part_of: Callable[[DeviceEvidence], Part | None],
) -> Callable[[Callable[[DeviceEvidence, Part], DeviceFinding | None]], Check]:
    """Check of a part of the evidence: its function gets the part, and is not asked without it."""

    def decorated(look: Callable[[DeviceEvidence, Part], DeviceFinding | None]) -> Check:
        def look_at_part(evidence: DeviceEvidence) -> DeviceFinding | None:
            part = part_of(evidence)
            return None if part is None else look(evidence, part)

        return _named(look, look_at_part)

    return decorated


def facts_of(evidence: DeviceEvidence) -> SessionFacts | None:
    """Facts of the samples."""
    return evidence.facts


def host_of(evidence: DeviceEvidence) -> HostClock | None:
    """Clock of the device against the clock of the host."""
    return evidence.facts and evidence.facts.host


def rest_of(evidence: DeviceEvidence) -> StillRate | None:
    """Bias and noise of the longest rest, if the rates are in deg/s."""
    return evidence.at_rest


def _named(function: Callable[..., DeviceFinding | None], look: Look) -> Check:
    about = (function.__doc__ or "").removesuffix(".")
    return Check(function.__name__, about[:1].lower() + about[1:], look)
