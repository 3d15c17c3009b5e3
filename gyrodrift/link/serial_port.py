"""A serial port of this machine as the system describes it, and whether there is a UART behind its name."""

from dataclasses import dataclass
from pathlib import Path

TERMINALS = Path("/sys/class/tty")
BUILT_IN = "ttyS"
NO_UART = "0"
"""What sysfs says is behind most of the ttyS names: the driver makes them in advance."""


@dataclass(frozen=True, slots=True)
class SerialPort:
    """A port that is there; `maker`, `product` and `serial_number` are those of a USB adapter, where it tells them.

    name
        Under which the adapter comes back after it was unplugged; of other ports the device.
    usb_id
        Vendor and product, four hexadecimal digits each, such as `0403:6001`; None where it is no USB adapter.
    """

    name: str
    device: str
    maker: str | None = None
    product: str | None = None
    usb_id: str | None = None
    serial_number: str | None = None


def built_in_ports() -> list[str]:
    """The ttyS devices that have a UART."""
    return [f"/dev/{entry.name}" for entry in sorted(TERMINALS.glob(f"{BUILT_IN}[0-9]*")) if has_uart(entry.name)]


def has_uart(device: str) -> bool:
    """Whether there is hardware behind a name; every port but a ttyS has it when it is there at all."""
    name = Path(device).name
    if not name.startswith(BUILT_IN):
        return True
    try:
        return (TERMINALS / name / "type").read_text().strip() != NO_UART
    except OSError:
        return False
