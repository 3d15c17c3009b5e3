"""A port from outside: who holds it, who may open it, what adapter it is; nothing here opens it."""

import os
import stat
from contextlib import suppress
from pathlib import Path

from gyrodrift.doctor.evidence import PortEvidence
from gyrodrift.link import serial_port
from gyrodrift.link.holder import holder_of
from gyrodrift.link.port import PTY_SLAVE_MAJORS, serial_ports, stable_name
from gyrodrift.link.serial_port import SerialPort


def look_at_port(path: str) -> PortEvidence | None:
    """What the system says of a port; None where there is no such device."""
    device = os.path.realpath(path)
    try:
        status = Path(device).stat()
    except OSError:
        return None
    known = {each.device: each for each in serial_ports()}
    return PortEvidence(
        port=known.get(device, SerialPort(stable_name(path), device)),
        holder=holder_of(path),
        is_pty=os.major(status.st_rdev) in PTY_SLAVE_MAJORS,
        access=f"{stat.filemode(status.st_mode)} {_owner(status.st_uid)}:{_group(status.st_gid)}",
        driver=_driver(device),
        latency_ms=latency_ms(device),
    )


def latency_ms(device: str) -> int | None:
    """The latency timer of the adapter as it is now, ms: opening a port for low latency sets it; None without one."""
    try:
        return int((_of_sysfs(device) / "latency_timer").read_text())
    except (OSError, ValueError):
        return None


def _driver(device: str) -> str | None:
    try:
        return (_of_sysfs(device) / "driver").readlink().name
    except OSError:
        return None


def _of_sysfs(device: str) -> Path:
    return serial_port.TERMINALS / Path(device).name / "device"


def _owner(user_id: int) -> str:
    with suppress(KeyError, ImportError):  # Windows has no user database
        import pwd  # noqa: PLC0415

        return pwd.getpwuid(user_id).pw_name
    return str(user_id)


def _group(group_id: int) -> str:
    with suppress(KeyError, ImportError):
        import grp  # noqa: PLC0415

        return grp.getgrgid(group_id).gr_name
    return str(group_id)
