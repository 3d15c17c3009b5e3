"""The service as systemd runs it: a unit, and a udev rule for an adapter that is plugged in."""

import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from gyrodrift.errors import UsageError
from gyrodrift.files import shipped_config
from gyrodrift.service.unit_words import command_line, file_url, plain_text, serial_pattern, usb_number

UNIT = Path("/etc/systemd/system/gyrodrift.service")
RULES = Path("/etc/udev/rules.d/60-gyrodrift.rules")
CONTROL = "%t/gyrodrift/control"
"""In the runtime directory, which systemd makes for the service."""

HOMES = ("/home", "/root")

LONGEST_ATTRIBUTE = 4096
"""Bytes of an attribute in /sys: the kernel writes no more than a page."""

COMMANDS = (
    ("systemctl", "daemon-reload"),
    ("udevadm", "control", "--reload"),
    ("systemctl", "enable", "--now", "gyrodrift.service"),
)
"""What has to be run once the files are there."""


@dataclass(frozen=True, slots=True)
class UsbIdentity:
    """How udev knows an adapter: numbers of its maker and kind, and a serial number where it has one."""

    vendor: str
    product: str
    serial: str = ""


def files(port: str, config: Path | None, outputs: Sequence[str], usb: UsbIdentity | None) -> Mapping[Path, str]:
    """What is to be written, by path; without a rule where the port is no USB adapter.

    Parameters
    ----------
    port
        The port as a person named it; with a rule, the service reads the name that the rule gives.

    Raises
    ------
    UsageError
        Where something from outside cannot be written into a unit or a rule.
    """
    read = "/dev/gyro" if usb else port
    written = {UNIT: unit(read, config, outputs)}
    if usb:
        serial = f', ATTRS{{serial}}=="{serial_pattern(usb.serial)}"' if usb.serial else ""
        rule = shipped_config("systemd/60-gyrodrift.rules").read_text()
        written[RULES] = rule.format(vendor=usb_number(usb.vendor), product=usb_number(usb.product), serial=serial)
    return written


def unit(port: str, config: Path | None, outputs: Sequence[str]) -> str:
    """The unit that serves a port."""
    if port.startswith("-"):
        raise UsageError(f"--port {port}: a service needs a port of its own, such as /dev/ttyUSB0")
    python = (sys.executable, "-m", "gyrodrift")
    serve = [*python, "serve", "--port", port, "--timeout", "0", "--log-format", "text"]
    if config is not None:
        serve += ["--config", str(config.resolve())]
    for output in outputs:
        serve += ["--output", output]
    places = [sys.executable, __file__, *([str(config.resolve())] if config else [])]
    return (
        shipped_config("systemd/gyrodrift.service")
        .read_text()
        .format(
            port=plain_text(port),
            docs=file_url(str(Path(__file__).parents[2] / "docs" / "service.md")),
            serve=f"{command_line(serve)} --control {CONTROL}",
            reload=f"{command_line([*python, 'ctl'])} {CONTROL} reload",
            home="read-only" if any(place.startswith(HOMES) for place in places) else "yes",
        )
    )


def usb_identity(port: str, devices: Path = Path("/sys/class/tty")) -> UsbIdentity | None:
    """Of the adapter behind a port; None where it is none."""
    device = devices / Path(port).resolve().name / "device"
    if not device.exists():
        return None
    for folder in (device.resolve(), *device.resolve().parents):
        if (folder / "idVendor").is_file():
            names = ("idVendor", "idProduct", "serial")
            return UsbIdentity(*(_attribute(folder / name) for name in names))
    return None


def _attribute(path: Path) -> str:
    """The text of a file in /sys, one character a byte; empty where there is none."""
    if not path.is_file():
        return ""
    with path.open("rb") as file:
        return file.read(LONGEST_ATTRIBUTE).rstrip().decode("latin-1")
