"""Standard error as a stream that never waits: a terminal that was stopped must not stop the samples."""

import os
import select
import socket
import stat
from collections.abc import Callable
from io import TextIOBase, UnsupportedOperation
from typing import TextIO

LONGEST_KEPT = 65_536
"""Bytes that wait for a reader that takes none; what comes on top is counted and dropped."""

PIECE_BYTES = 512
"""What a pipe that polls as writable takes at once, by POSIX; of a terminal that is only known of one byte."""


class UnwaitingStream(TextIOBase):
    """Writes what the reader takes at once, and keeps the rest for the next time.

    The file is opened anew for each piece, since not to wait is a property of an open file that other programs on the
    same terminal share; where that is not allowed, as after `su` or in a container with a user of its own, it is
    written to in pieces that a reader with any room takes. A reader that is gone is no error: who logs has other
    things to do.

    Parameters
    ----------
    stream
        Standard error, or what stands for it; one without a descriptor is written to as it is.
    told
        The line that says how many were dropped.
    """

    def __init__(self, stream: TextIO, told: Callable[[int], str]) -> None:
        self._stream, self._told = stream, told
        self._kept = b""
        self._dropped = 0

    def write(self, text: str) -> int:
        """Write, keep or drop a text; its length in any case."""
        fd = _descriptor(self._stream)
        if fd is None:
            return self._stream.write(text)
        data = text.encode(errors="backslashreplace")
        if len(self._kept) + len(data) > LONGEST_KEPT:
            self._dropped += 1
        else:
            self._kept += data
        self._send(fd)
        return len(text)

    def flush(self) -> None:
        """Hand on what has been kept, as far as it is taken."""
        fd = _descriptor(self._stream)
        if fd is None:
            self._stream.flush()
        elif self._kept:
            self._send(fd)

    def fileno(self) -> int:
        """Of the stream itself."""
        return self._stream.fileno()

    def isatty(self) -> bool:
        """As the stream itself."""
        return self._stream.isatty()

    def _send(self, fd: int) -> None:
        while self._kept:
            sent = _send(fd, self._kept)
            if not sent:
                return
            self._kept = self._kept[sent:]
            if self._dropped and not self._kept:
                self._kept, self._dropped = self._told(self._dropped).encode(), 0


def _descriptor(stream: TextIO) -> int | None:
    try:
        return stream.fileno()
    except (OSError, UnsupportedOperation, ValueError, AttributeError):
        return None


def _send(fd: int, data: bytes) -> int:
    """Bytes that were taken; all of them where nobody will ever read them."""
    try:
        if stat.S_ISSOCK(os.fstat(fd).st_mode):
            with socket.socket(fileno=os.dup(fd)) as end:
                return end.send(data, socket.MSG_DONTWAIT)
        try:
            own = os.open(f"/proc/self/fd/{fd}", os.O_WRONLY | os.O_NONBLOCK | os.O_APPEND | os.O_NOCTTY | os.O_CLOEXEC)
        except PermissionError:
            return _send_a_piece(fd, data)
        try:
            return os.write(own, data)
        finally:
            os.close(own)
    except BlockingIOError:
        return 0
    except OSError:  # the other end is closed
        return len(data)


def _send_a_piece(fd: int, data: bytes) -> int:
    """Likewise, of a file that cannot be opened anew: no more than what never waits where there is room at all."""
    poller = select.poll()
    poller.register(fd, select.POLLOUT)
    if not poller.poll(0):
        return 0
    return os.write(fd, data[:1] if os.isatty(fd) else data[:PIECE_BYTES])
