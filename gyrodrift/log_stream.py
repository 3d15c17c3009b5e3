"""Standard error as a stream that never waits: a terminal that was stopped must not stop the samples."""

from collections.abc import Callable
from io import TextIOBase, UnsupportedOperation
from typing import TextIO

from gyrodrift.unwaiting import send_unwaiting

LONGEST_KEPT = 65_536
"""Bytes that wait for a reader that takes none; what comes on top is counted and dropped."""


class UnwaitingStream(TextIOBase):
    """Writes what the reader takes at once, and keeps the rest for the next time.

    A reader that is gone is no error: who logs has other things to do.

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
        return send_unwaiting(fd, data)
    except OSError:  # the other end is closed
        return len(data)
