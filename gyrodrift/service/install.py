"""The service as systemd runs it: a unit, and a udev rule for an adapter that is plugged in."""

import shlex
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from gyrodrift.files import shipped_config

UNIT = Path("/etc/systemd/system/gyrodrift.service")
RULES = Path("/etc/udev/rules.d/60-gyrodrift.rules")
CONTROL = "%t/gyrodrift/control"
"""In the runtime directory, which systemd makes for the service."""

HOMES = ("/home", "/root")

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
    """
    read = "/dev/gyro" if usb else port
    written = {UNIT: unit(read, config, outputs)}
    if usb:
        serial = f', ATTRS{{serial}}=="{usb.serial}"' if usb.serial else ""
        rule = shipped_config("systemd/60-gyrodrift.rules").read_text()
        written[RULES] = rule.format(vendor=usb.vendor, product=usb.product, serial=serial)
    return written


def unit(port: str, config: Path | None, outputs: Sequence[str]) -> str:
    """The unit that serves a port."""
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
            port=port.replace("%", "%%"),
            docs=Path(__file__).parents[2] / "docs" / "service.md",
            serve=f"{_words(serve)} --control {CONTROL}",
            reload=f"{_words([*python, 'ctl'])} {CONTROL} reload",
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
            serial = folder / "serial"
            return UsbIdentity(
                (folder / "idVendor").read_text().strip(),
                (folder / "idProduct").read_text().strip(),
                serial.read_text().strip() if serial.is_file() else "",
            )
    return None


def _words(words: Sequence[str]) -> str:
    """As systemd reads a command line: quoted, with % and $ as themselves."""
    return " ".join(shlex.quote(word).replace("%", "%%").replace("$", "$$") for word in words)
