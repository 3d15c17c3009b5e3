"""Frames of an unknown binary protocol: head, length and frames a second are named, noise and text are none."""

import struct
import zlib
from collections.abc import Callable
from math import sin
from pathlib import Path
from random import Random

import pytest
from sources_support import Host
from support import speaking_on

from gyrodrift.link.binary_frames import binary_frames
from gyrodrift.values.errors import DeviceSilentError

DICE = Random(1)


def summed(i: int) -> bytes:
    body = struct.pack("<BI3f", 7, i, 0.1, 0.2, sin(i))
    return b"\xa5\x5a" + body + bytes((sum(body) & 0xFF,))


def unchecked(i: int) -> bytes:
    return b"\xc3\x3c" + struct.pack("<I3f", i, *(DICE.gauss(0.0, 1.0) for _ in range(3)))


def of_stated_length(_i: int) -> bytes:
    body = DICE.randbytes(DICE.choice((4, 8, 12)))
    return b"\xd1\xe2" + bytes((len(body),)) + body + struct.pack(">H", sum(body) + len(body))


def stim(i: int) -> bytes:
    """Rates in counts of 2⁻¹⁴ deg/s."""
    rates = b"".join(struct.pack(">i", int(DICE.gauss(0.3, 0.05) * 2**14))[1:] for _ in range(3))
    content = b"\x90" + rates + bytes((0, i & 0xFF)) + struct.pack(">H", 400)
    return content + struct.pack(">I", zlib.crc32(content))


@pytest.mark.parametrize(
    ("frame", "head", "length", "is_checked"),
    [
        (summed, b"\xa5\x5a\x07", 20, True),
        (unchecked, b"\xc3\x3c", 18, False),
        (of_stated_length, b"\xd1\xe2", 0, True),
        (stim, b"\x90\x00", 18, True),
    ],
)
def test_head_and_length_are_found(
    frame: Callable[[int], bytes],
    head: bytes,
    length: int,
    is_checked: bool,  # noqa: FBT001 - of the case
) -> None:
    stream = b"".join(map(frame, range(200)))
    for cut in (0, 1, 7):
        frames = binary_frames(stream[cut:])
        assert frames is not None
        assert (frames.head, frames.length, frames.is_checked) == (head, length, is_checked)


@pytest.mark.parametrize("content", [bytes(5000), b"\x55" * 5000, b"\x00\xff" * 3000, Random(2).randbytes(20_000)])
def test_noise_has_no_frames(content: bytes) -> None:
    assert binary_frames(content) is None


@pytest.mark.promise("Text and units")
def test_the_link_names_the_frames(port: Path) -> None:
    """A binary protocol that gyrodrift does not know is told by its head, and no unusual baud rate is suspected."""
    with speaking_on(port) as device, Host(port, timeout_s=4.0) as host:
        with pytest.raises(DeviceSilentError, match="18 bytes that begin with 90 00") as refused:
            host.hear(device, map(stim, range(500)), 0.02)
        assert "as a STIM of Safran" in str(refused.value)
        assert "--baud" not in str(refused.value)
