"""Layout of the scans of a Linux IIO device: place and form of each channel.

Documentation/ABI/testing/sysfs-bus-iio of the kernel: a channel has the type `[be|le]:[s|u]bits/storagebits[>>shift]`.
Each element is aligned to its own size, and a scan to its largest element.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass

TYPE = re.compile(r"(be|le):([su])(\d{1,2})/(8|16|24|32|64)(?:>>(\d{1,2}))?")


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
