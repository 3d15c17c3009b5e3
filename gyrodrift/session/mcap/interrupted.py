"""Telling session files that were never closed from others, by their last bytes; and who is writing one.

Light, since every recording begins with a look at its folder.
"""

import os
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import IO

from gyrodrift.errors import DataError
from gyrodrift.session.mcap.layout import CLOSED_TAIL, CLOSED_TAIL_BYTES, MAGIC
from gyrodrift.system import lock_file, read_at

MOST_BARE_BYTES = 1 << 16
"""Of zeros, that a power cut leaves of a file into which little was written."""


def is_closed(file: IO[bytes]) -> bool:
    """Whether it ends as a finished MCAP file does."""
    size = os.fstat(file.fileno()).st_size
    tail = read_at(file.fileno(), CLOSED_TAIL_BYTES, max(0, size - CLOSED_TAIL_BYTES))
    return tail.startswith(CLOSED_TAIL) and tail.endswith(MAGIC)


def is_bare(file: IO[bytes]) -> bool:
    """Whether a recording was cut off before a record of it was written: nothing, or zeros, behind the first word.

    Such a file is left alone, since it may be another program's, which is about to write.
    """
    head = read_at(file.fileno(), MOST_BARE_BYTES + 1, 0)
    return len(head) <= MOST_BARE_BYTES and MAGIC.startswith(head.rstrip(b"\0"))


def lock(path: Path, file: IO[bytes]) -> None:
    """Make this process the only one that writes or repairs the file, for as long as it is open.

    Raises
    ------
    DataError
        Where another process does.
    """
    try:
        lock_file(file, wait=False)
    except BlockingIOError:
        raise DataError(f"{path}: is being written by another process") from None


def interrupted(folder: Path) -> Iterator[Path]:
    """The `.mcap` files of a folder that were never closed and that nobody is writing.

    What cannot be looked into, or is gone in the meantime, is passed over.
    """
    for path in sorted(folder.glob("*.mcap")):
        is_left_open = False
        with suppress(OSError):
            is_left_open = path.is_file() and _is_left_open(path)
        if is_left_open:
            yield path


def _is_left_open(path: Path) -> bool:
    with path.open("rb") as file:
        if is_closed(file) or is_bare(file):
            return False
        try:
            lock(path, file)
        except DataError:
            return False
        return True
