"""Checks of the port: existence, permission, holder, name and adapter."""

import os

from gyrodrift.doctor.evidence import DeviceEvidence, checks
from gyrodrift.doctor.finding import DeviceFinding, error, note, of_error, ok, sentence, warning
from gyrodrift.values.errors import DeviceSilentError, PortBusyError, PortDeniedError, UnitError

OPENED = (PortBusyError, PortDeniedError, DeviceSilentError, UnitError)
"""Failures of a port that exists."""

LATENCY_OK_MS = 2
"""The driver sets 1 ms for low latency; the default of the chip is 16 ms (FTDI AN232B-04)."""

ROOT = 0


def port(evidence: DeviceEvidence) -> DeviceFinding | None:
    """Whether the port exists; with auto, the port of the gyro."""
    if evidence.search:
        says, _, do = evidence.search.removeprefix("--port auto: ").partition("; ")
        return error(sentence(says), sentence(do.replace("\n", "; ")))
    if evidence.recording is not None:
        return None
    if evidence.failure is not None and not isinstance(evidence.failure, OPENED):
        return of_error(_without_name(evidence))
    device = evidence.port.port.device if evidence.port else evidence.source
    return ok(f"The port is {device}.")


def permission(evidence: DeviceEvidence) -> DeviceFinding | None:
    """Whether this user may open it."""
    if isinstance(evidence.failure, PortDeniedError):
        return of_error(_without_name(evidence))
    if evidence.port is None or isinstance(evidence.failure, PortBusyError):
        return None
    if hasattr(os, "geteuid") and os.geteuid() == ROOT:
        return ok(f"Root may open every port; other users have {evidence.port.access}.")
    return ok(f"You may open the port: {evidence.port.access}.")


def holder(evidence: DeviceEvidence) -> DeviceFinding | None:
    """Whether another program has it open."""
    if isinstance(evidence.failure, PortBusyError):
        return of_error(_without_name(evidence))
    if evidence.port is None or isinstance(evidence.failure, PortDeniedError):
        return None
    if evidence.port.holder is not None:
        return error(f"The port is in use by {evidence.port.holder}.", "Stop that program first.")
    return ok("No other program has the port open.")


def name(evidence: DeviceEvidence) -> DeviceFinding | None:
    """Whether it keeps its name."""
    if evidence.port is None or evidence.port.driver is None:
        return None
    serial_port = evidence.port.port
    if evidence.port.has_stable_name:
        return ok(f"It keeps the name {serial_port.name} in every socket.")
    if serial_port.usb_id is None:
        return ok(f"{serial_port.device} is built in and keeps its name.")
    return note(
        f"{serial_port.device} may get another number when replugged: it has no name in /dev/serial/by-id.",
        "Start udev, or write a udev rule with SYMLINK+=. A container needs /dev/serial as a volume.",
    )


def adapter(evidence: DeviceEvidence) -> DeviceFinding | None:
    """Maker, product and driver."""
    outside = evidence.port
    if outside is None:
        return None
    if outside.driver is None:
        return ok("It is a pseudo-terminal: a simulated device, or a bridge.") if outside.is_pty else None
    serial_port = outside.port
    usb_id = serial_port.usb_id and f"({serial_port.usb_id})"
    about = " ".join(filter(None, (serial_port.maker, serial_port.product, usb_id)))
    return ok(f"The adapter is {about or 'unnamed'}, with the driver {outside.driver}.")


def latency_timer(evidence: DeviceEvidence) -> DeviceFinding | None:
    """Delay in an FTDI adapter."""
    timer_ms = evidence.port.latency_ms if evidence.port else None
    if evidence.port is None or timer_ms is None:
        return None
    if timer_ms <= LATENCY_OK_MS:
        return ok(f"The latency timer of the adapter is {timer_ms} ms.", timer_ms, "ms")
    terminal = evidence.port.port.device.rpartition("/")[2]
    return warning(
        f"The adapter delays bytes by up to {timer_ms} ms.",
        f"'echo 1 | sudo tee /sys/bus/usb-serial/devices/{terminal}/latency_timer' until it is unplugged; to keep it, "
        'ACTION=="add", SUBSYSTEM=="usb-serial", ATTR{latency_timer}="1" in /etc/udev/rules.d/99-gyro.rules.',
        timer_ms,
        "ms",
    )


def _without_name(evidence: DeviceEvidence) -> str:
    return str(evidence.failure).removeprefix(f"{evidence.source}: ").removeprefix(f"{evidence.link.port}: ")


CHECKS = checks(port, permission, holder, name, adapter, latency_timer)
