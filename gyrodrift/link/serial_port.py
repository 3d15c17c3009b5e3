"""Serial port of this machine, and whether its name has a UART."""

from dataclasses import dataclass
from pathlib import Path

TERMINALS = Path("/sys/class/tty")
BUILT_IN = "ttyS"
NO_UART = "0"
"""UART type of most ttyS names in sysfs: the driver creates them without hardware."""


@dataclass(frozen=True, slots=True)
class SerialPort:
    """A serial port; `maker`, `product` and `serial_number` come from its USB adapter. Or a device of a source.

    name
        Name that the adapter keeps when it is replugged; the device for other ports; the address of a source.
    usb_id
        Vendor and product as hexadecimal digits, such as `0403:6001`; None without USB.
    """

    name: str
    device: str
    maker: str | None = None
    product: str | None = None
    usb_id: str | None = None
    serial_number: str | None = None


def built_in_ports() -> list[str]:
    """Devices named ttyS with a UART."""
    return [f"/dev/{entry.name}" for entry in sorted(TERMINALS.glob(f"{BUILT_IN}[0-9]*")) if has_uart(entry.name)]


def has_uart(device: str) -> bool:
    """Whether a name has hardware; only ttyS names may lack it."""
    name = Path(device).name
    if not name.startswith(BUILT_IN):
        return True
    try:
        return (TERMINALS / name / "type").read_text(encoding="ascii").strip() != NO_UART
    except OSError:
        return False
