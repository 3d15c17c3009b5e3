"""Frames of an unknown binary protocol: a head that repeats at a fixed distance, or at distances that a byte states.

A checksum that is right in all frames proves the baud rate. Without one the bytes may also be other frames at a wrong
baud rate, which repeat, too.
"""

import zlib
from binascii import crc_hqx
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import reduce
from itertools import pairwise
from operator import xor

FRAMES = 8
"""Frames that must agree. A byte is the same in all of them by chance once in 256⁷."""

FRAMES_MAX = 24
SHORTEST, LONGEST = 4, 256
"""Lengths of frames."""

HEAD_MAX = 4
LENGTH_OFFSET_MAX = 7
"""Last offset of a length byte after the beginning of the head."""

COMMON_PAIRS = 4
"""Pairs of bytes, the most common ones, that may be a head."""


DEVICES = (("a STIM of Safran or Sensonor", range(0x90, 0xB0), range(18, 64)),)
"""Devices with the first bytes and the lengths of their frames, where a head alone would be too short a sign."""


@dataclass(frozen=True, slots=True)
class BinaryFrames:
    """Frames of a stream.

    head
        First bytes, which all frames share.
    length
        Length of all frames, bytes; 0 if a byte of each frame states it.
    mean_length
        Mean length, bytes.
    is_checked
        Whether they end with a right checksum.
    """

    head: bytes
    length: int
    mean_length: float
    is_checked: bool

    @property
    def resembles(self) -> str:
        """Device whose frames have this head and length, if the checksum is right; empty if there is none."""
        if not self.is_checked:
            return ""
        return next(
            (name for name, heads, lengths in DEVICES if self.head[0] in heads and self.length in lengths),
            "",
        )

    def described(self, bytes_per_s: float | None) -> str:
        """Head, length and frames per second, in words."""
        length = f"{self.length} bytes" if self.length else "a length that they state"
        pace = "" if not bytes_per_s else f", {bytes_per_s / self.mean_length:.3g} a second"
        checked = ", with right checksums" if self.is_checked else ""
        return f"frames of {length} that begin with {self.head.hex(' ')} (hexadecimal){pace}{checked}"


def binary_frames(content: bytes) -> BinaryFrames | None:
    """Frames of the bytes; None without any."""
    return _of_fixed_length(content) or _of_stated_length(content)


def crc32_mpeg2(content: bytes) -> int:
    """CRC-32 with the polynomial 0x04C11DB7, most significant bit first, of inertial units such as KVH and STIM."""
    crc = 0xFFFFFFFF
    for byte in content:
        crc ^= byte << 24
        for _ in range(8):
            crc = (crc << 1 ^ (0x04C11DB7 if crc & 0x80000000 else 0)) & 0xFFFFFFFF
    return crc


def crc16_reflected(content: bytes, first: int, polynomial: int) -> int:
    """CRC of 16 bits, least significant bit first."""
    crc = first
    for byte in content:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ (polynomial if crc & 1 else 0)
    return crc


def _padded(content: bytes) -> bytes:
    """Bytes up to a multiple of four, as the data sheet of the STIM300 has it."""
    return content + bytes(-len(content) % 4)


CHECKSUMS: tuple[tuple[int, Callable[[bytes], int]], ...] = (
    (4, zlib.crc32),
    (4, crc32_mpeg2),
    (4, lambda content: crc32_mpeg2(_padded(content))),
    *((2, lambda content, first=first: crc_hqx(content, first)) for first in (0, 0xFFFF, 0x1D0F)),
    *(
        (2, lambda content, first=first, polynomial=polynomial: crc16_reflected(content, first, polynomial))
        for first, polynomial in ((0xFFFF, 0xA001), (0, 0xA001), (0, 0x8408), (0xFFFF, 0x8408))
    ),
    (2, sum),
    (1, sum),
    (1, lambda content: -sum(content)),
    (1, lambda content: ~sum(content)),
    (1, lambda content: reduce(xor, content, 0)),
)
"""Number of bytes and function of usual checksums: CRC-32, CRC-16 (CCITT, Modbus, ARC, Kermit, X.25), sums and XOR."""


def has_checksums(frames: list[bytes]) -> bool:
    """Whether all frames end with a right checksum of one kind, after a head of at most HEAD_MAX bytes."""
    return any(
        all(_is_checked(frame, skipped, size, check) for frame in frames)
        for size, check in CHECKSUMS
        for skipped in range(HEAD_MAX + 1)
    )


def _is_checked(frame: bytes, skipped: int, size: int, check: Callable[[bytes], int]) -> bool:
    value, end = check(frame[skipped:-size]) & (256**size - 1), frame[-size:]
    return end in (value.to_bytes(size, "big"), value.to_bytes(size, "little"))


def _of_fixed_length(content: bytes) -> BinaryFrames | None:
    for length in range(SHORTEST, min(LONGEST, len(content) // FRAMES) + 1):
        count = min(FRAMES_MAX, len(content) // length)
        last = content[-count * length :]
        constant = [len(set(last[offset::length])) == 1 for offset in range(length)]
        if all(constant) or not any(same and last[offset] for offset, same in enumerate(constant)):
            continue
        starts = list(_starts(last, constant, length))
        for start in starts:
            frames = [last[start + i * length : start + (i + 1) * length] for i in range(count - 1)]
            if has_checksums(frames):
                return BinaryFrames(_head(frames), length, length, is_checked=True)
        frames = [last[starts[0] + i * length : starts[0] + (i + 1) * length] for i in range(count - 1)]
        return BinaryFrames(_head(frames), length, length, is_checked=False)
    return None


def _starts(last: bytes, constant: list[bool], length: int) -> Iterator[int]:
    """Offsets where a head may begin: a constant byte after the longest run of others first, as after a checksum."""

    def changing_before(offset: int) -> int:
        return next(n for n in range(length) if constant[offset - 1 - n])

    offsets = [offset for offset in range(length) if constant[offset] and last[offset]]
    return iter(sorted(offsets, key=changing_before, reverse=True))


def _head(frames: list[bytes]) -> bytes:
    """First bytes that all frames share."""
    shared = next((n for n, values in enumerate(zip(*frames, strict=False)) if len(set(values)) > 1), HEAD_MAX)
    return frames[0][: max(1, min(shared, HEAD_MAX))]


def _of_stated_length(content: bytes) -> BinaryFrames | None:
    """Frames with a length byte, whose distance from the next head differs from it by a constant."""
    pairs = Counter(content[i : i + 2] for i in range(len(content) - 1))
    for head, _ in pairs.most_common(COMMON_PAIRS):
        offsets = _offsets(content, head)[-FRAMES_MAX:]
        distances = [after - before for before, after in pairwise(offsets)]
        if len(distances) < FRAMES or len(set(distances)) == 1 or not any(head):
            continue
        for offset in range(2, min(LENGTH_OFFSET_MAX, min(distances) - 1) + 1):
            extras = {distance - content[start + offset] for start, distance in zip(offsets, distances, strict=False)}
            if len(extras) == 1 and 0 < extras.pop() < LONGEST:
                frames = [content[before:after] for before, after in pairwise(offsets)]
                mean = sum(distances) / len(distances)
                return BinaryFrames(_head(frames), 0, mean, has_checksums(frames))
    return None


def _offsets(content: bytes, head: bytes) -> list[int]:
    offsets, offset = [], content.find(head)
    while offset >= 0:
        offsets.append(offset)
        offset = content.find(head, offset + len(head))
    return offsets
