"""What stands behind the last whole record of a session file, kept in a file of its own, without secrets.

Nobody knows what is in it. Older versions wrote the config with its passwords, so text that mentions one is covered.
"""

import os
import stat
from pathlib import Path
from typing import IO

from gyrodrift.secret import MENTION
from gyrodrift.session.mcap.walk import data_blocks
from gyrodrift.system import read_at, set_mode

LONGEST_TEXT = 1 << 17
"""Bytes of a config, the longest text that has secrets."""

TEXT = bytes(byte for byte in range(256) if byte in b"\t\n\r" or 0x20 <= byte != 0x7F)
IS_TEXT = bytes(byte in TEXT for byte in range(256))
"""For `bytes.translate`: 1 for a byte of text, 0 for another."""


def keep_tail(path: Path, file: IO[bytes], end: int, size: int) -> Path:
    """Copy what stands between two places of a session file; where to. Nobody may read it who may not read that."""
    saved, number = path.with_name(f"{path.name}.tail"), 1
    while os.path.lexists(saved):  # an earlier one, or whatever it is
        number += 1
        saved = path.with_name(f"{path.name}.tail_{number}")
    with open(saved, "xb", opener=_for_us_alone) as copy:
        set_mode(copy.fileno(), stat.S_IMODE(os.fstat(file.fileno()).st_mode))
        for at, block in data_blocks(file, end, size):
            copy.seek(at - end)
            copy.write(_public(file, at, block, end))
        copy.truncate(size - end)
        copy.flush()
        os.fsync(copy.fileno())
    return saved


def _for_us_alone(name: str, flags: int) -> int:
    """Open a new file that nobody else can open before its mode is set."""
    return os.open(name, flags, 0o600)


def _public(file: IO[bytes], at: int, block: bytes, least: int) -> bytes:
    """A block with stars for text that mentions a secret; the text may begin before it and end behind it."""
    start = max(least, at - LONGEST_TEXT)
    around = read_at(file.fileno(), at - start + len(block) + LONGEST_TEXT, start)
    return covered(around)[at - start : at - start + len(block)]


def covered(content: bytes) -> bytes:
    """Bytes of the same length, with stars for text around each mention of a secret."""
    is_text, public = content.translate(IS_TEXT), bytearray(content)
    words, at = content.decode("latin-1"), 0
    while found := MENTION.search(words, at):
        before, at = found.start(), found.end()
        first = is_text.rfind(0, max(0, before - LONGEST_TEXT), before)
        first = max(0, before - LONGEST_TEXT) if first < 0 else first + 1
        behind = is_text.find(0, at, at + LONGEST_TEXT)
        at = min(len(content), at + LONGEST_TEXT) if behind < 0 else behind
        public[first:at] = b"*" * (at - first)
    return bytes(public)
