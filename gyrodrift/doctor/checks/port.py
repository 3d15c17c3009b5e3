"""The port: whether it is there, who may open it, who holds it, its name and its adapter."""

import os

from gyrodrift.doctor.check import Check
from gyrodrift.doctor.evidence import DeviceEvidence
from gyrodrift.doctor.finding import DeviceFinding, error, note, of_error, ok, sentence, warning
from gyrodrift.errors import DeviceSilentError, PortBusyError, PortDeniedError, UnitError

OPENED = (PortBusyError, PortDeniedError, DeviceSilentError, UnitError)
"""Failures that say more than that the port is not there."""

LATENCY_OK_MS = 2
"""The driver takes 1 ms for low latency; the chip's own default is 16 ms (FTDI AN232B-04)."""

ROOT = 0


def port(evidence: DeviceEvidence) -> DeviceFinding | None:
    """Which port it is."""
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
    """Whether this user may open it, and by which group."""
    if isinstance(evidence.failure, PortDeniedError):
        return of_error(_without_name(evidence))
    if evidence.port is None or isinstance(evidence.failure, PortBusyError):
        return None
    if os.geteuid() == ROOT:
        return ok(f"It was opened by root, who may open every port; for others it is {evidence.port.access}.")
    return ok(f"You may open it: {evidence.port.access}.")


def holder(evidence: DeviceEvidence) -> DeviceFinding | None:
    """Who has it open."""
    if isinstance(evidence.failure, PortBusyError):
        return of_error(_without_name(evidence))
    if evidence.port is None or isinstance(evidence.failure, PortDeniedError):
        return None
    if evidence.port.holder is not None:
        return error(f"The port is in use by {evidence.port.holder}.", "Stop that program first.")
    return ok("Nobody else has it open.")


def name(evidence: DeviceEvidence) -> DeviceFinding | None:
    """Whether it comes back under the same name."""
    if evidence.port is None or evidence.port.driver is None:
        return None
    known = evidence.port.port
    if evidence.port.has_stable_name:
        return ok(f"It comes back as {known.name}, whatever it is plugged into.")
    if known.usb_id is None:
        return ok(f"{known.device} is built in: its name stays.")
    return note(
        f"Plugged in again, {known.device} may have another number: it has no name in /dev/serial/by-id.",
        "Start udev, or write a rule with SYMLINK+=; a container needs /dev/serial as a volume.",
    )


def adapter(evidence: DeviceEvidence) -> DeviceFinding | None:
    """What stands between the wire and the host."""
    outside = evidence.port
    if outside is None:
        return None
    if outside.driver is None:
        return ok("It is a pseudo-terminal: a simulated device, or a bridge.") if outside.is_pty else None
    known = outside.port
    about = " ".join(filter(None, (known.maker, known.product, known.usb_id and f"({known.usb_id})")))
    return ok(f"The adapter is {about or 'not named'}, with the driver {outside.driver}.")


def latency_timer(evidence: DeviceEvidence) -> DeviceFinding | None:
    """How long the adapter holds bytes back."""
    held_ms = evidence.port.latency_ms if evidence.port else None
    if evidence.port is None or held_ms is None:
        return None
    if held_ms <= LATENCY_OK_MS:
        return ok(f"The latency timer of the adapter is {held_ms} ms.", held_ms, "ms")
    terminal = evidence.port.port.device.rpartition("/")[2]
    return warning(
        f"The adapter holds bytes back for up to {held_ms} ms.",
        f"'echo 1 | sudo tee /sys/bus/usb-serial/devices/{terminal}/latency_timer' until it is unplugged; for good, "
        'ACTION=="add", SUBSYSTEM=="usb-serial", ATTR{latency_timer}="1" in /etc/udev/rules.d/99-gyro.rules.',
        held_ms,
        "ms",
    )


def _without_name(evidence: DeviceEvidence) -> str:
    return str(evidence.failure).removeprefix(f"{evidence.source}: ").removeprefix(f"{evidence.link.port}: ")


CHECKS = (
    Check("port", "is there such a port; with auto, which one a gyro speaks at", port),
    Check("permission", "may this user open it, and which group may", permission),
    Check("holder", "does another program have it open", holder),
    Check("name", "does it come back under the same name", name),
    Check("adapter", "maker, product and driver", adapter),
    Check("latency_timer", "how long an FTDI adapter holds bytes back", latency_timer),
)
