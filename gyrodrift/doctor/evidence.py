"""Evidence about a device or a recording, and checks: functions from the evidence to a finding."""

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar

from gyrodrift.doctor.finding import DeviceFinding
from gyrodrift.doctor.port import PortEvidence
from gyrodrift.doctor.sensors import Sensor
from gyrodrift.facts.session_facts import SessionFacts, StillRate
from gyrodrift.link.protocols.registry import PROTOCOLS
from gyrodrift.outputs.status import DeviceStatus, LinkStatus
from gyrodrift.session.checks.finding import SessionFinding
from gyrodrift.values.errors import LinkError

Part = TypeVar("Part")


@dataclass(frozen=True, slots=True)
class DeviceEvidence:
    """All evidence; missing parts are None.

    source
        Port or file.
    recording
        File, if it is not a port.
    failure
        Error that ended listening; `search` is the reason why no port was chosen.
    is_angle
        Whether the rate comes from an angle that the device sends.
    units
        Fields of the event `rate_unit_differs` or `rate_doubted`; empty without one.
    checked
        Findings about clock and rates of a recording.
    facts
        Facts of the samples, if any arrived in time that can be used.
    raw
        First bytes from the port.
    """

    source: str
    recording: Path | None = None
    search: str = ""
    port: PortEvidence | None = None
    failure: LinkError | None = None
    link: LinkStatus = field(default_factory=LinkStatus)
    device: DeviceStatus = field(default_factory=DeviceStatus)
    has_clock: bool = True
    is_angle: bool = False
    units: dict[str, Any] = field(default_factory=dict)
    checked: tuple[SessionFinding, ...] = ()
    facts: SessionFacts | None = None
    sensor: Sensor | None = None
    raw: bytes = b""

    @property
    def is_in_deg_s(self) -> bool:
        """Whether no finding says that the rates have another unit, sign or axis."""
        return not self.units and not any(finding.is_error for finding in self.checked)

    @property
    def at_rest(self) -> StillRate | None:
        """Bias and noise of the longest rest; None without one, or if the rates have another unit."""
        return self.facts.at_rest if self.facts is not None and self.is_in_deg_s else None

    @property
    def step_dps(self) -> float | None:
        """Step of the rate, deg/s: the stated one, or the measured one if it is coarser; None without both."""
        if self.facts is None:
            return None
        measured_dps, stated_dps = self.facts.step_dps, self.device.dps_per_lsb
        return max(stated_dps, measured_dps or 0.0) if stated_dps else measured_dps

    @property
    def holds_zero(self) -> bool:
        """Whether a healthy device of this kind sends exactly 0 at rest."""
        protocol = PROTOCOLS.get(self.link.protocol)
        return self.is_angle or (protocol is not None and protocol.holds_zero)

    @property
    def is_understood(self) -> bool:
        """Whether samples arrived."""
        return self.facts is not None


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
