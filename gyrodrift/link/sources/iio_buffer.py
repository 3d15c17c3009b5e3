"""Buffer of an IIO device: its channels, its trigger, and the scans that the kernel delivers."""

import os
from contextlib import suppress

from gyrodrift.link.port import PortGoneError
from gyrodrift.link.sources import iio_sysfs
from gyrodrift.link.sources.iio_layout import IDENTITY, ChannelEntry, IioLayout, description, layout_of
from gyrodrift.link.sources.iio_sysfs import TIMESTAMP, IioDevice, explained
from gyrodrift.values.errors import LinkError

CHANNELS = (("anglvel", "x"), ("anglvel", "y"), ("anglvel", "z"), ("accel", "x"), ("accel", "y"), ("accel", "z"))
TEMP = ("temp", "")

BUFFER_SCANS = 1024
"""Length of the kernel's buffer: a second at 1 kHz."""

SCANS_PER_READ = 256
"""Largest number of scans at a time, so that a flood does not block the loop."""

WAKE_SHARE = 0.01
"""Time between two wakeups, s, by which the watermark of the buffer is chosen."""


class Scans:
    """Open buffer of one device."""

    def __init__(self, device: IioDevice, kinds: tuple[str, ...]) -> None:
        self.device = device
        path = iio_sysfs.DEVICE_FILES / device.file
        try:
            self.fd = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
        except OSError as error:
            raise explained(path, error) from error
        try:
            device.try_to_write("buffer/enable", "0")  # after a kill it is still on, and refuses changes
            self.entries = _enabled(device, kinds)
            self._layout = scan_layout(device, kinds[0], self.entries)
            _start(device)
        except LinkError:
            os.close(self.fd)
            raise
        self._rest = b""

    def description(self) -> bytes:
        """Layout for the stream."""
        return description(self._layout, self.entries)

    def read(self, path: str) -> list[bytes]:
        """Scans that have arrived."""
        try:
            chunk = os.read(self.fd, SCANS_PER_READ * self._layout.size)
        except BlockingIOError:
            return []
        except OSError as error:
            raise PortGoneError(path) from error
        if not chunk:
            raise PortGoneError(path)
        content, size = self._rest + chunk, self._layout.size
        whole = len(content) // size * size
        self._rest = content[whole:]
        return [content[start : start + size] for start in range(0, whole, size)]

    def close(self) -> None:
        """Stop the buffer."""
        self.device.try_to_write("buffer/enable", "0")
        with suppress(OSError):
            os.close(self.fd)


def elements_folder(device: IioDevice) -> str:
    """Folder of the scan elements: `buffer0` has them since Linux 5.11."""
    return "scan_elements" if (device.folder / "scan_elements").is_dir() else "buffer0"


def _enabled(device: IioDevice, kinds: tuple[str, ...]) -> list[ChannelEntry]:
    """Enable the channels of these kinds, temperature and timestamp, disable others, and return them by index."""
    folder = elements_folder(device)
    enabled_names = {f"in_{kind}_{axis}": (kind, axis) for kind, axis in CHANNELS if kind in kinds}
    enabled_names |= {"in_temp": TEMP, "in_temp0": TEMP, f"in_{TIMESTAMP}": (TIMESTAMP, "")}
    entries: list[tuple[float, ChannelEntry]] = []
    device.try_to_write("current_timestamp_clock", "monotonic")
    for switch in sorted((device.folder / folder).glob("in_*_en")):
        name = switch.name.removesuffix("_en")
        device.write(f"{folder}/{switch.name}", "1" if name in enabled_names else "0")
        if name in enabled_names:
            index, form = device.number(f"{folder}/{name}_index"), device.text(f"{folder}/{name}_type")
            entries.append((index, device.channel(*enabled_names[name], form)))
    return [entry for _, entry in sorted(entries, key=lambda pair: pair[0])]


def scan_layout(device: IioDevice, kind: str, entries: list[ChannelEntry]) -> IioLayout:
    """Layout of the enabled channels.

    Raises
    ------
    LinkError
        A type is unknown, or the rate about z is missing.
    """
    layout = layout_of(device.name, device.rate_hz(), device.matrix(kind) or IDENTITY, entries)
    if layout is None or (kind == "anglvel" and "anglvel_z" not in layout.channels):
        types = ", ".join(f"{entry.name} {entry.type}" for entry in entries)
        raise LinkError(f"{device.folder}: its scans cannot be read: {types or 'no channels'}")
    return layout


def _start(device: IioDevice) -> None:
    device.try_to_write("buffer/length", str(BUFFER_SCANS))
    device.try_to_write("buffer/watermark", str(max(1, int(device.rate_hz() * WAKE_SHARE))))
    device.write("buffer/enable", "1")
