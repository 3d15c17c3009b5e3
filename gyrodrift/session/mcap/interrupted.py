"""Detection of session files that were never closed, by their last bytes, and locks of files being written.

Light, because every recording first examines its folder.
"""

import os
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import IO

from gyrodrift.io.system import lock_file, read_at
from gyrodrift.session.mcap.layout import CLOSED_TAIL, CLOSED_TAIL_BYTES, MAGIC
from gyrodrift.values.errors import DataError

MOST_BARE_BYTES = 1 << 16
"""Largest file of zeros that a power cut leaves of a short recording, bytes."""


def is_closed(file: IO[bytes]) -> bool:
    """Whether a file ends like a finished MCAP file."""
    size = os.fstat(file.fileno()).st_size
    tail = read_at(file.fileno(), CLOSED_TAIL_BYTES, max(0, size - CLOSED_TAIL_BYTES))
    return tail.startswith(CLOSED_TAIL) and tail.endswith(MAGIC)


def is_bare(file: IO[bytes]) -> bool:
    """Whether a recording was cut off before its first record: nothing or zeros after the magic bytes.

    Such a file is not touched, because another program may be about to write it.
    """
    head = read_at(file.fileno(), MOST_BARE_BYTES + 1, 0)
    return len(head) <= MOST_BARE_BYTES and MAGIC.startswith(head.rstrip(b"\0"))


def lock(path: Path, file: IO[bytes]) -> None:
    """Lock a file for writing or repair by this process only, until it is closed.

    Raises
    ------
    DataError
        Another process has the lock.
    """
    try:
        lock_file(file, wait=False)
    except BlockingIOError:
        raise DataError(f"{path}: is being written by another process") from None


def interrupted(folder: Path) -> Iterator[Path]:
    """Yield the `.mcap` files of a folder that were never closed and are not being written.

    Files that cannot be read or disappear meanwhile are skipped.
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
