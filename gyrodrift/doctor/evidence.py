"""What was seen of a device, before anything is made of it: its port, its link, its samples."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from gyrodrift.describe.values import SessionDescription, Stretch
from gyrodrift.doctor.sensors import Sensor
from gyrodrift.errors import LinkError
from gyrodrift.link.holder import PortHolder
from gyrodrift.link.protocols.registry import PROTOCOLS
from gyrodrift.link.serial_port import SerialPort
from gyrodrift.outputs.status import DeviceStatus, LinkStatus
from gyrodrift.session.checks.finding import SessionFinding
from gyrodrift.session.session import Session

BY_ID = "/dev/serial/by-id/"
NO_LINE_DRIVERS = frozenset({"cdc_acm"})
"""USB all the way to the chip: the line rate that is set there means nothing."""


@dataclass(frozen=True, slots=True)
class PortEvidence:
    """A port from outside.

    access
        Mode, owner and group, such as `crw-rw---- root:dialout`.
    driver
        Of the kernel, such as `ftdi_sio`; None where sysfs knows none.
    latency_ms
        How long the adapter may hold bytes back, ms; None where it has no such timer.
    """

    port: SerialPort
    holder: PortHolder | None = None
    is_pty: bool = False
    access: str = ""
    driver: str | None = None
    latency_ms: int | None = None

    @property
    def has_line_rate(self) -> bool:
        """Whether bytes go over a line at some baud rate."""
        return self.driver not in NO_LINE_DRIVERS if self.driver else not self.is_pty

    @property
    def has_stable_name(self) -> bool:
        """Whether it comes back under its name after it was unplugged."""
        return self.port.name.startswith(BY_ID)


@dataclass(frozen=True, slots=True)
class DeviceEvidence:
    """All of it; None for what there is none of.

    source
        Port or file.
    recording
        The file, where it was no port.
    failure
        Why the port could not be listened to, or not any further; `search` says why no port was chosen.
    is_angle
        Whether the rate was made of an angle that the device sends.
    units
        Fields of the event that the rate has another unit than it is taken for; empty without one.
    checked
        What the checks of a recording found of its clock and its rates.
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
    session: Session | None = None
    description: SessionDescription | None = None
    sensor: Sensor | None = None

    @property
    def is_in_deg_s(self) -> bool:
        """Whether nothing says that the rates have another unit, sign or axis."""
        return not self.units and not any(finding.is_error for finding in self.checked)

    @property
    def rest(self) -> Stretch | None:
        """The longest stretch without motion."""
        stretches = self.description.stretches if self.description else ()
        return max(stretches, key=lambda each: each.end_s - each.start_s, default=None)

    @property
    def holds_zero(self) -> bool:
        """Whether a healthy device of this kind says exactly 0 at rest."""
        protocol = PROTOCOLS.get(self.link.protocol)
        return self.is_angle or (protocol is not None and protocol.holds_zero)

    @property
    def is_understood(self) -> bool:
        """Whether samples came."""
        return self.session is not None
