"""Layout of the scans of a Linux IIO device: position, form and scale of each channel.

Documentation/ABI/testing/sysfs-bus-iio of the kernel: a channel has the type `[be|le]:[s|u]bits/storagebits[>>shift]`.
Each element is aligned to its own size, and a scan to its largest element. `(raw + offset) * scale` is rad/s, m/s², or
thousandths of °C.
"""

import json
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from math import isfinite
from typing import Any

TYPE = re.compile(r"(be|le):([su])(\d{1,2})/(8|16|24|32|64)(?:>>(\d{1,2}))?")
IDENTITY = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
ROTATION_TOLERANCE = 0.02
"""Largest error of a product of two rows of a mount matrix; device trees have two or three digits."""

MOST_SCAN_BYTES = 1024
MOST_CHANNELS = 32


@dataclass(frozen=True, slots=True)
class IioChannel:
    """Channel of a scan.

    name
        `anglvel_x`, `accel_z`, `temp` or `timestamp`.
    position, size
        Place in the scan, bytes.
    """

    name: str
    position: int
    size: int
    is_little: bool
    is_signed: bool
    bits: int
    shift: int
    scale: float = 1.0
    offset: float = 0.0

    def raw(self, scan: bytes) -> int:
        """Count of this channel in a scan."""
        word = int.from_bytes(scan[self.position : self.position + self.size], "little" if self.is_little else "big")
        count = word >> self.shift & (1 << self.bits) - 1
        return count - (1 << self.bits) if self.is_signed and count >> self.bits - 1 else count

    def value(self, scan: bytes) -> float:
        """Value in the unit of the channel."""
        return (self.raw(scan) + self.offset) * self.scale


@dataclass(frozen=True, slots=True)
class IioLayout:
    """Scans of a device.

    name
        Name of the device.
    rate_hz
        Sampling frequency, Hz; 0 if unknown.
    size
        Length of a scan, bytes.
    matrix
        Mount matrix by rows, which turns from the chip to the board.
    channels
        Channels by name.
    """

    name: str
    rate_hz: float
    size: int
    matrix: tuple[float, ...]
    channels: Mapping[str, IioChannel]

    def vector(self, scan: bytes, kind: str) -> tuple[float, float, float] | None:
        """Vector of a kind in the axes of the board; None without all three axes."""
        axes = [self.channels.get(f"{kind}_{axis}") for axis in "xyz"]
        x, y, z = (None if channel is None else channel.value(scan) for channel in axes)
        if x is None or y is None or z is None:
            return None
        m = self.matrix
        first, second, third = (m[row] * x + m[row + 1] * y + m[row + 2] * z for row in (0, 3, 6))
        return first, second, third


@dataclass(frozen=True, slots=True)
class ChannelEntry:
    """Channel as sysfs describes it, without its place."""

    name: str
    type: str
    scale: float = 1.0
    offset: float = 0.0


def layout_of(
    name: str, rate_hz: float, matrix: tuple[float, ...], entries: Iterable[ChannelEntry]
) -> IioLayout | None:
    """Layout of the enabled channels in the order of their index; None if a type is unknown."""
    channels: dict[str, IioChannel] = {}
    end, largest = 0, 1
    for entry in entries:
        match = TYPE.fullmatch(entry.type)
        if match is None or not isfinite(entry.scale) or not isfinite(entry.offset):
            return None
        bits, size, shift = int(match[3]), int(match[4]) // 8, int(match[5] or 0)
        if not 0 < bits + shift <= 8 * size or not bits:
            return None
        position = -(-end // size) * size
        is_little, is_signed = match[1] == "le", match[2] == "s"
        channels[entry.name] = IioChannel(
            entry.name, position, size, is_little, is_signed, bits, shift, entry.scale, entry.offset
        )
        end, largest = position + size, max(largest, size)
    return IioLayout(name, rate_hz, -(-end // largest) * largest, matrix, channels)


def is_rotation(matrix: tuple[float, ...]) -> bool:
    """Whether nine numbers are a right-handed rotation; a mirrored one would change the sign of a rate."""
    if (
        len(matrix) != len(IDENTITY)
        or not all(map(isfinite, matrix))
        or max(map(abs, matrix)) > 1.0 + ROTATION_TOLERANCE
    ):
        return False
    rows = matrix[:3], matrix[3:6], matrix[6:]
    products = [
        abs(sum(a * b for a, b in zip(rows[i], rows[j], strict=True)) - (i == j)) for i in range(3) for j in range(i, 3)
    ]
    (a, b, c), (d, e, f), (g, h, i) = rows
    determinant = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
    return max(products) <= ROTATION_TOLERANCE and determinant > 0.0


def description(layout: IioLayout, entries: Iterable[ChannelEntry]) -> bytes:
    """Layout as JSON, for the stream of packets."""
    channels = [[entry.name, entry.type, entry.scale, entry.offset] for entry in entries]
    content = {"name": layout.name, "rate_hz": layout.rate_hz, "matrix": layout.matrix, "channels": channels}
    return json.dumps(content).encode()


def described(content: bytes) -> IioLayout | None:
    """Layout of a description; None if it has another form."""
    try:
        fields: dict[str, Any] = json.loads(content)
        entries = [
            ChannelEntry(str(name), str(form), float(scale), float(offset))
            for name, form, scale, offset in fields["channels"][:MOST_CHANNELS]
        ]
        matrix = tuple(map(float, fields["matrix"]))
        rate_hz = float(fields["rate_hz"])
        layout = layout_of(str(fields["name"])[:64], rate_hz, matrix, entries)
    except (ValueError, TypeError, KeyError, AttributeError, OverflowError, RecursionError):
        return None
    if layout is None or layout.size > MOST_SCAN_BYTES or not is_rotation(matrix) or not isfinite(rate_hz):
        return None
    return layout
