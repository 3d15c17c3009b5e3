"""Buffer of an IIO device: its channels, its trigger, and the scans that the kernel delivers."""

import os
from contextlib import suppress
from math import isfinite

from gyrodrift.link.port import PortGoneError
from gyrodrift.link.sources import iio_sysfs
from gyrodrift.link.sources.iio_layout import layout_of
from gyrodrift.link.sources.iio_readings import TIMESTAMP, IioDescription
from gyrodrift.link.sources.iio_sysfs import IioDevice, explained
from gyrodrift.values.errors import LinkError

CHANNELS = tuple(f"{kind}_{axis}" for kind in ("anglvel", "accel") for axis in "xyz")
TEMPERATURES = ("temp", "temp0")

BUFFER_SCANS = 1024
"""Length of the kernel's buffer: a second at 1 kHz."""

SCANS_PER_READ = 256
"""Largest number of scans at a time, so that a flood does not block the loop."""

WAKE_SHARE = 0.01
"""Time between two wakeups, s, by which the watermark of the buffer is chosen."""


class Scans:
    """Open buffer of one device, for the channels of these kinds, its temperature and its timestamp."""

    def __init__(self, device: IioDevice, kinds: tuple[str, ...]) -> None:
        self._device = device
        path = iio_sysfs.DEVICE_FILES / device.file
        try:
            self.fd = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
        except OSError as error:
            raise explained(path, error) from error
        try:
            device.try_to_write("buffer/enable", "0")  # after a kill it is still on, and refuses changes
            types = _enabled(device, kinds)
            self.description = checked_description(device, kinds[0], types)
            layout = layout_of(types)
            if layout is None:
                raise _unreadable(device, types)
            self.layout = layout
            _start(device)
        except LinkError:
            os.close(self.fd)
            raise
        self._rest = b""

    def read(self, path: str) -> list[bytes]:
        """Scans that have arrived."""
        try:
            chunk = os.read(self.fd, SCANS_PER_READ * self.layout.size)
        except BlockingIOError:
            return []
        except OSError as error:
            raise PortGoneError(path) from error
        if not chunk:
            raise PortGoneError(path)
        content, size = self._rest + chunk, self.layout.size
        whole = len(content) // size * size
        self._rest = content[whole:]
        return [content[start : start + size] for start in range(0, whole, size)]

    def close(self) -> None:
        """Stop the buffer."""
        self._device.try_to_write("buffer/enable", "0")
        with suppress(OSError):
            os.close(self.fd)


def elements_folder(device: IioDevice) -> str:
    """Folder of the scan elements: `buffer0` has them since Linux 5.11."""
    return "scan_elements" if (device.folder / "scan_elements").is_dir() else "buffer0"


def _enabled(device: IioDevice, kinds: tuple[str, ...]) -> dict[str, str]:
    """Enable the channels of these kinds, temperature and timestamp, disable others, and return their types."""
    folder = elements_folder(device)
    temperature = next((name for name in TEMPERATURES if (device.folder / folder / f"in_{name}_en").exists()), "")
    names = {name: name for name in (*CHANNELS, TIMESTAMP) if name.startswith((*kinds, TIMESTAMP))}
    names[temperature] = TEMPERATURES[0]
    indexed: list[tuple[float, str]] = []
    device.try_to_write("current_timestamp_clock", "monotonic")
    for switch in sorted((device.folder / folder).glob("in_*_en")):
        name = switch.name.removeprefix("in_").removesuffix("_en")
        device.write(f"{folder}/{switch.name}", "1" if name in names else "0")
        if name in names:
            indexed.append((device.number(f"{folder}/in_{name}_index"), name))
    return {
        names[name]: device.text(f"{folder}/in_{name}_type") for _, name in sorted(indexed, key=lambda pair: pair[0])
    }


def checked_description(device: IioDevice, kind: str, types: dict[str, str]) -> IioDescription:
    """Description of the enabled channels.

    Raises
    ------
    LinkError
        A scale is no number, or the rate about z is missing.
    """
    channels = {name: device.channel(name) for name in types}
    has_numbers = all(isfinite(channel.scale) and isfinite(channel.offset) for channel in channels.values())
    if not has_numbers or (kind == "anglvel" and "anglvel_z" not in channels):
        raise _unreadable(device, types)
    return device.described(kind, channels)


def _unreadable(device: IioDevice, types: dict[str, str]) -> LinkError:
    shown = ", ".join(f"{name} {text}" for name, text in types.items())
    return LinkError(f"{device.folder}: its scans cannot be read: {shown or 'no channels'}")


def _start(device: IioDevice) -> None:
    device.try_to_write("buffer/length", str(BUFFER_SCANS))
    device.try_to_write("buffer/watermark", str(max(1, int(device.rate_hz() * WAKE_SHARE))))
    device.write("buffer/enable", "1")
