"""Evidence about a device: its port, its link, its samples."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from gyrodrift.describe.values import SessionDescription, Stretch
from gyrodrift.doctor.sensors import Sensor
from gyrodrift.link.holder import PortHolder
from gyrodrift.link.protocols.registry import PROTOCOLS
from gyrodrift.link.serial_port import SerialPort
from gyrodrift.outputs.status import DeviceStatus, LinkStatus
from gyrodrift.session.checks.finding import SessionFinding
from gyrodrift.session.session import Session
from gyrodrift.values.errors import LinkError

BY_ID = "/dev/serial/by-id/"
NO_LINE_DRIVERS = frozenset({"cdc_acm"})
"""Drivers of native USB devices, which have no line rate."""


@dataclass(frozen=True, slots=True)
class PortEvidence:
    """A port, seen without opening it.

    access
        Mode, owner and group, such as `crw-rw---- root:dialout`.
    driver
        Kernel driver, such as `ftdi_sio`; None if sysfs has none.
    latency_ms
        Latency timer of the adapter, ms; None without such a timer.
    """

    port: SerialPort
    holder: PortHolder | None = None
    is_pty: bool = False
    access: str = ""
    driver: str | None = None
    latency_ms: int | None = None

    @property
    def has_line_rate(self) -> bool:
        """Whether the port has a line with a baud rate."""
        return self.driver not in NO_LINE_DRIVERS if self.driver else not self.is_pty

    @property
    def has_stable_name(self) -> bool:
        """Whether the port keeps its name after it was unplugged."""
        return self.port.name.startswith(BY_ID)


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
        Fields of the event `rate_unit_differs`; empty without one.
    checked
        Findings about clock and rates of a recording.
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
        """Whether no finding says that the rates have another unit, sign or axis."""
        return not self.units and not any(finding.is_error for finding in self.checked)

    @property
    def rest(self) -> Stretch | None:
        """Longest stretch without motion; None without one."""
        stretches = self.description.stretches if self.description else ()
        return max(stretches, key=lambda stretch: stretch.end_s - stretch.start_s, default=None)

    @property
    def holds_zero(self) -> bool:
        """Whether a healthy device of this kind sends exactly 0 at rest."""
        protocol = PROTOCOLS.get(self.link.protocol)
        return self.is_angle or (protocol is not None and protocol.holds_zero)

    @property
    def is_understood(self) -> bool:
        """Whether samples arrived."""
        return self.session is not None
