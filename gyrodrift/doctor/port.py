"""Evidence about a port, without opening it: its holder, permissions and adapter."""

import os
import stat
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from gyrodrift.link import serial_port
from gyrodrift.link.holder import PortHolder, holder_of
from gyrodrift.link.port import PTY_SLAVE_MAJORS, serial_ports, stable_name
from gyrodrift.link.serial_port import SerialPort
from gyrodrift.link.sources.registry import address_of

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


def look_at_port(path: str) -> PortEvidence | None:
    """Evidence about a port; None if the device does not exist, or the path is the address of a source."""
    if address_of(path) is not None:
        return None
    device = os.path.realpath(path)
    try:
        status = Path(device).stat()
    except OSError:
        return None
    owner, group = _named(Path(device).owner, status.st_uid), _named(Path(device).group, status.st_gid)
    ports = {port.device: port for port in serial_ports()}
    return PortEvidence(
        port=ports.get(device, SerialPort(stable_name(path), device)),
        holder=holder_of(path),
        is_pty=hasattr(os, "major") and os.major(status.st_rdev) in PTY_SLAVE_MAJORS,
        access=f"{stat.filemode(status.st_mode)} {owner}:{group}",
        driver=_driver(device),
        latency_ms=latency_ms(device),
    )


def latency_ms(device: str) -> int | None:
    """Present latency timer of the adapter, ms; None without one. Opening a port for low latency changes it."""
    try:
        return int((_of_sysfs(device) / "latency_timer").read_text(encoding="ascii"))
    except (OSError, ValueError):
        return None


def _driver(device: str) -> str | None:
    try:
        return (_of_sysfs(device) / "driver").readlink().name
    except OSError:
        return None


def _of_sysfs(device: str) -> Path:
    return serial_port.TERMINALS / Path(device).name / "device"


def _named(name_of: Callable[[], str], number: int) -> str:
    """Name of a user or group, or its number without a name."""
    with suppress(KeyError, NotImplementedError):  # Windows has no user database
        return name_of()
    return str(number)
