"""Packets of sources that deliver samples instead of bytes: two bytes of head, kind, length, content.

A recording with `--raw` holds packets as they arrived, and the decoder of the source splits them again.
"""

import re
from abc import abstractmethod
from struct import Struct

from gyrodrift.link.protocols.frames import FrameDecoder

HEAD = b"\xa7\x1d"
HEADER = Struct("<2sBH")
LONGEST_BYTES = 4096
"""Longest content: more than a description of a device, or any frame of CAN FD (64 bytes) needs."""


def packet(kind: int, content: bytes) -> bytes:
    """Packet of a kind, 0 to 255, with at most `LONGEST_BYTES` of content."""
    return HEADER.pack(HEAD, kind, len(content)) + content


class PacketDecoder(FrameDecoder):
    """Decoder of packets."""

    head = HEAD
    header = re.compile(re.escape(HEAD))
    header_bytes = len(HEAD)

    def length(self, buffer: bytes, position: int) -> int | None:
        """Length of header and content."""
        if len(buffer) - position < HEADER.size:
            return None
        _, _, content_bytes = HEADER.unpack_from(buffer, position)
        return HEADER.size + content_bytes if content_bytes <= LONGEST_BYTES else 0

    def is_whole(self, frame: bytes) -> bool:
        """Whether the content is valid for its kind."""
        return self.is_valid(frame[2], frame[HEADER.size :])

    @abstractmethod
    def is_valid(self, kind: int, content: bytes) -> bool:
        """Whether a content has a form of its kind."""
