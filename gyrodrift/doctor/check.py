"""Check of a device or a recording, made of a function from the evidence to a finding."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

from gyrodrift.doctor.evidence import DeviceEvidence
from gyrodrift.doctor.finding import DeviceFinding
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


def checks(*looks: Look) -> tuple[Check, ...]:
    """Checks with the names and the docstrings of functions."""
    return tuple(_check(look, look) for look in looks)


def checks_of(
    part_of: Callable[[DeviceEvidence], Part | None],
    *looks: Callable[[DeviceEvidence, Part], DeviceFinding | None],
) -> tuple[Check, ...]:
    """Checks of a part of the evidence: their functions get it too, and are not called without it."""

    def with_part(look: Callable[[DeviceEvidence, Part], DeviceFinding | None]) -> Look:
        return lambda evidence: None if (part := part_of(evidence)) is None else look(evidence, part)

    return tuple(_check(look, with_part(look)) for look in looks)


def facts_of(evidence: DeviceEvidence) -> SessionFacts | None:
    """Facts of the samples."""
    return evidence.facts


def rest_of(evidence: DeviceEvidence) -> StillRate | None:
    """Bias and noise of the longest rest, if the rates are in deg/s."""
    return evidence.at_rest


def _check(function: Callable[..., DeviceFinding | None], look: Look) -> Check:
    about = (function.__doc__ or "").removesuffix(".")
    return Check(function.__name__, about[:1].lower() + about[1:], look)
