"""Buffer of an IIO device: its channels, its trigger, and the scans that the kernel delivers.

Documentation/ABI/testing/sysfs-bus-iio of the kernel: a channel has the type `[be|le]:[s|u]bits/storagebits[>>shift]`.
Each element is aligned to its own size, and a scan to its largest element.
"""

import os
import re
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from math import isfinite

from gyrodrift.link.port import PortGoneError
from gyrodrift.link.sources import iio_sysfs
from gyrodrift.link.sources.iio_readings import TIMESTAMP, IioChannel, IioDescription
from gyrodrift.link.sources.iio_sysfs import IioDevice, explained
from gyrodrift.values.errors import LinkError

CHANNELS = tuple(f"{kind}_{axis}" for kind in ("anglvel", "accel") for axis in "xyz")
TEMPERATURES = ("temp", "temp0")
TYPE = re.compile(r"(be|le):([su])(\d{1,2})/(8|16|24|32|64)(?:>>(\d{1,2}))?")

BUFFER_SCANS = 1024
"""Length of the kernel's buffer: a second at 1 kHz."""

SCANS_PER_READ = 256
"""Largest number of scans at a time, so that a flood does not block the loop."""

WAKE_SHARE = 0.01
"""Time between two wakeups, s, by which the watermark of the buffer is chosen."""


@dataclass(frozen=True, slots=True)
class ScanElement:
    """Count of a channel in a scan; `position` and `size` in bytes."""

    position: int
    size: int
    is_little: bool
    is_signed: bool
    bits: int
    shift: int

    def count(self, scan: bytes) -> int:
        """Count of the channel."""
        word = int.from_bytes(scan[self.position : self.position + self.size], "little" if self.is_little else "big")
        count = word >> self.shift & (1 << self.bits) - 1
        return count - (1 << self.bits) if self.is_signed and count >> self.bits - 1 else count


@dataclass(frozen=True, slots=True)
class ScanLayout:
    """Elements of a scan by the name of their channel, and its `size` in bytes."""

    size: int
    elements: Mapping[str, ScanElement]

    def counts(self, scan: bytes) -> dict[str, int]:
        """Counts of all channels."""
        return {name: element.count(scan) for name, element in self.elements.items()}


def layout_of(types: Mapping[str, str]) -> ScanLayout | None:
    """Layout from the types of the enabled channels in the order of their index; None if a type is unknown."""
    elements: dict[str, ScanElement] = {}
    end, largest = 0, 1
    for name, text in types.items():
        match = TYPE.fullmatch(text)
        if match is None:
            return None
        bits, size, shift = int(match[3]), int(match[4]) // 8, int(match[5] or 0)
        if not 0 < bits + shift <= 8 * size or not bits:
            return None
        position = -(-end // size) * size
        elements[name] = ScanElement(position, size, match[1] == "le", match[2] == "s", bits, shift)
        end, largest = position + size, max(largest, size)
    return ScanLayout(-(-end // largest) * largest, elements)


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
            channels = {name: device.channel(name) for name in types}
            layout, description = layout_of(types), description_of(device, kinds[0], channels)
            if layout is None or description is None:
                raise unreadable(device, (f"{name} {text}" for name, text in types.items()))
            self.layout, self.description = layout, description
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


def description_of(device: IioDevice, kind: str, channels: Mapping[str, IioChannel]) -> IioDescription | None:
    """Description of the enabled channels; None if a scale is no number, or the rate about z is missing."""
    has_numbers = all(isfinite(channel.scale) and isfinite(channel.offset) for channel in channels.values())
    is_readable = has_numbers and (kind != "anglvel" or "anglvel_z" in channels)
    return device.described(kind, channels) if is_readable else None


def unreadable(device: IioDevice, channels: Iterable[str]) -> LinkError:
    """Error about a device with these channels."""
    return LinkError(f"{device.folder}: its scans cannot be read: {', '.join(channels) or 'no channels'}")


def _start(device: IioDevice) -> None:
    device.try_to_write("buffer/length", str(BUFFER_SCANS))
    device.try_to_write("buffer/watermark", str(max(1, int(device.rate_hz() * WAKE_SHARE))))
    device.write("buffer/enable", "1")
