"""Copy of the bytes after the last whole record of a session file, without secrets.

These bytes may be anything. Older versions wrote the config with passwords, so stars replace text that mentions a
password.
"""

import os
import stat
from pathlib import Path
from typing import IO

from gyrodrift.io.system import read_at, set_mode
from gyrodrift.session.mcap.walk import data_blocks
from gyrodrift.values.secret import MENTION

LONGEST_TEXT = 1 << 17
"""Bytes of a config, the longest text with secrets."""

TEXT = bytes(byte for byte in range(256) if byte in b"\t\n\r" or 0x20 <= byte != 0x7F)
IS_TEXT = bytes(byte in TEXT for byte in range(256))
"""Table for `bytes.translate`: 1 for a byte of text, 0 for another byte."""


def keep_tail(path: Path, file: IO[bytes], end: int, size: int) -> Path:
    """Copy the bytes between two offsets to a new file with the permissions of the session file; returns its path."""
    saved = free_path(path, "tail")
    with open(saved, "xb", opener=_open_private) as copy:
        set_mode(copy.fileno(), stat.S_IMODE(os.fstat(file.fileno()).st_mode))
        for offset, block in data_blocks(file, end, size):
            copy.seek(offset - end)
            copy.write(_public(file, offset, block, end))
        copy.truncate(size - end)
        copy.flush()
        os.fsync(copy.fileno())
    return saved


def free_path(path: Path, ending: str) -> Path:
    """Path beside a file for what is kept of it; with a number if an earlier copy or another file has it."""
    free, number = path.with_name(f"{path.name}.{ending}"), 1
    while os.path.lexists(free):
        number += 1
        free = path.with_name(f"{path.name}.{ending}_{number}")
    return free


def _open_private(name: str, flags: int) -> int:
    """Open a new file that no other user can open until its mode is set."""
    return os.open(name, flags, 0o600)


def _public(file: IO[bytes], offset: int, block: bytes, least: int) -> bytes:
    """A block with stars for text that mentions a secret; the text may start before it and end after it."""
    start = max(least, offset - LONGEST_TEXT)
    context = read_at(file.fileno(), offset - start + len(block) + LONGEST_TEXT, start)
    return covered(context)[offset - start : offset - start + len(block)]


def covered(content: bytes) -> bytes:
    """Bytes of the same length, with stars for the text around every mention of a secret."""
    is_text, public = content.translate(IS_TEXT), bytearray(content)
    words, index = content.decode("latin-1"), 0
    while match := MENTION.search(words, index):
        mention_start, index = match.start(), match.end()
        first = is_text.rfind(0, max(0, mention_start - LONGEST_TEXT), mention_start)
        first = max(0, mention_start - LONGEST_TEXT) if first < 0 else first + 1
        text_end = is_text.find(0, index, index + LONGEST_TEXT)
        index = min(len(content), index + LONGEST_TEXT) if text_end < 0 else text_end
        public[first:index] = b"*" * (index - first)
    return bytes(public)
