"""The systemd unit of a service, and the udev rule of its USB adapter. Words in them are escaped, or refused."""

import re
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import quote

from gyrodrift.io.files import shipped_config
from gyrodrift.link.sources.registry import source_of
from gyrodrift.values.errors import UsageError

UNIT = Path("/etc/systemd/system/gyrodrift.service")
RULES = Path("/etc/udev/rules.d/60-gyrodrift.rules")
CONTROL = "%t/gyrodrift/control"
"""Control socket in the runtime directory, which systemd creates for the service."""

HOMES = ("/home", "/root")

LONGEST_ATTRIBUTE = 4096
"""Bytes of an attribute in /sys: the kernel writes no more than a page."""

COMMANDS = (
    ("systemctl", "daemon-reload"),
    ("udevadm", "control", "--reload"),
    ("systemctl", "enable", "--now", "gyrodrift.service"),
)
"""Commands to run after the files were written."""

PLAIN = re.compile(r"[A-Za-z0-9/_.:,+=@~-]+")
"""Characters without a special meaning in a unit file."""

USB_NUMBER = re.compile(r"[0-9A-Fa-f]{4}")
"""A vendor or product number, as the kernel writes it (Linux, Documentation/ABI/testing/sysfs-bus-usb)."""

NOT_PLAIN_IN_A_SERIAL = re.compile(r"[^A-Za-z0-9_.:-]")
ANY_ONE_BYTE = "?"
"""udev matches by shell patterns (udev(7)): `?` is any one byte."""

LONGEST_SERIAL = 256
"""USB allows 126 characters; a longer text is no serial number."""

NO_PROGRAM = frozenset("\"'\\$")
"""Characters that systemd refuses in the path of a program (systemd.service(5))."""


@dataclass(frozen=True, slots=True)
class UsbIdentity:
    """Identity of a USB adapter for udev: vendor, product, and serial number (empty if it has none)."""

    vendor: str
    product: str
    serial: str = ""


def files(port: str, config: Path | None, outputs: Sequence[str], usb: UsbIdentity | None) -> Mapping[Path, str]:
    """Files to write, by path; without a rule if the port is no USB adapter.

    Parameters
    ----------
    port
        Port of the command line; with a rule the service reads /dev/gyro.

    Raises
    ------
    UsageError
        If a name cannot be written into a unit or a rule.
    """
    service_port = "/dev/gyro" if usb else port
    written = {UNIT: unit(service_port, config, outputs)}
    if usb:
        serial = f', ATTRS{{serial}}=="{serial_pattern(usb.serial)}"' if usb.serial else ""
        rule = shipped_config("systemd/60-gyrodrift.rules").read_text()
        written[RULES] = rule.format(vendor=usb_number(usb.vendor), product=usb_number(usb.product), serial=serial)
    return written


def unit(port: str, config: Path | None, outputs: Sequence[str]) -> str:
    """Text of the unit for a port."""
    if port.startswith("-"):
        raise UsageError(f"--port {port}: a service needs a port of its own, such as /dev/ttyUSB0")
    source = source_of(port)
    python = (sys.executable, "-m", "gyrodrift")
    serve = [*python, "serve", "--port", port, "--timeout", "0", "--log-format", "text"]
    if config is not None:
        serve += ["--config", str(config.resolve())]
    for output in outputs:
        serve += ["--output", output]
    paths = [sys.executable, __file__, *([str(config.resolve())] if config else [])]
    return (
        shipped_config("systemd/gyrodrift.service")
        .read_text()
        .format(
            port=plain_text(port),
            docs=file_url(str(Path(__file__).parents[2] / "docs" / "service.md")),
            serve=f"{command_line(serve)} --control {CONTROL}",
            reload=f"{command_line([*python, 'ctl'])} {CONTROL} reload",
            source="".join(f"\n{line}" for line in (source.unit if source else ())),
            home="read-only" if any(path.startswith(HOMES) for path in paths) else "yes",
        )
    )


def usb_identity(port: str, devices: Path = Path("/sys/class/tty")) -> UsbIdentity | None:
    """USB adapter behind a serial port; None if there is none."""
    if source_of(port) is not None:
        return None
    device = devices / Path(port).resolve().name / "device"
    if not device.exists():
        return None
    for folder in (device.resolve(), *device.resolve().parents):
        if (folder / "idVendor").is_file():
            names = ("idVendor", "idProduct", "serial")
            return UsbIdentity(*(_attribute(folder / name) for name in names))
    return None


def _attribute(path: Path) -> str:
    """Text of a file in /sys, one character per byte; empty if there is no such file."""
    if not path.is_file():
        return ""
    with path.open("rb") as file:
        return file.read(LONGEST_ATTRIBUTE).rstrip().decode("latin-1")


def command_line(words: Sequence[str]) -> str:
    """Write a command as `ExecStart=` reads it (systemd.service(5), COMMAND LINES).

    Raises
    ------
    UsageError
        If a word has characters that a unit file cannot hold.
    """
    if NO_PROGRAM & set(words[0]):
        raise UsageError(
            f"{words[0]!r}: systemd runs no program with a quote, $ or \\ in its path; install it elsewhere"
        )
    return " ".join(_word(word) for word in words)


def _word(text: str) -> str:
    if not text.isprintable():
        raise UsageError(f"{text!r} has characters that a unit file cannot hold: use a path of printable characters")
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("%", "%%").replace("$", "$$")
    return text if PLAIN.fullmatch(text) else f'"{escaped}"'


def plain_text(text: str) -> str:
    """Text for a description, with `_` for special characters."""
    return "".join(letter if PLAIN.fullmatch(letter) else "_" for letter in text)


def file_url(path: str) -> str:
    """URL of a path for `Documentation=`."""
    return f"file://{quote(path)}".replace("%", "%%")


def usb_number(text: str) -> str:
    """Check a vendor or product number.

    Raises
    ------
    UsageError
        If it is not four hexadecimal digits.
    """
    if not USB_NUMBER.fullmatch(text):
        raise UsageError(
            f"the USB number {text!r} of the adapter is not four hexadecimal digits: no udev rule is written"
        )
    return text


def serial_pattern(serial: str) -> str:
    """Udev pattern of a serial number: letters, digits and `_.:-` stay, other bytes become `?`."""
    pattern = NOT_PLAIN_IN_A_SERIAL.sub(ANY_ONE_BYTE, serial[:LONGEST_SERIAL])
    return f"{pattern}*" if len(serial) > LONGEST_SERIAL else pattern
