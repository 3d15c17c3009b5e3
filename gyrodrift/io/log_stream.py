"""Standard error as a stream that never waits: a stopped terminal must not stop the samples."""

from collections.abc import Callable
from io import TextIOBase, UnsupportedOperation
from typing import TextIO

from gyrodrift.io.unwaiting import send_unwaiting

LONGEST_KEPT = 65_536
"""Bytes that wait for a slow reader; later lines are counted and dropped."""

AT_ONCE = 4096
"""Bytes that a pipe takes whole, or not at all (PIPE_BUF of Linux): the process of the outputs writes to it too."""


class UnwaitingStream(TextIOBase):
    """Writes as much as the reader takes now, and keeps the rest for the next write.

    A closed reader is no error.

    Parameters
    ----------
    stream
        Standard error; a stream without a descriptor is written to directly.
    notice
        Gives the line about a number of dropped lines.
    """

    def __init__(self, stream: TextIO, notice: Callable[[int], str]) -> None:
        self._stream, self._notice = stream, notice
        self._kept = b""
        self._dropped = 0

    def write(self, text: str) -> int:
        """Write, keep or drop a text; returns its length."""
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
        """Write as much of the kept text as the reader takes."""
        fd = _descriptor(self._stream)
        if fd is None:
            self._stream.flush()
        elif self._kept:
            self._send(fd)

    def fileno(self) -> int:
        """Descriptor of the stream."""
        return self._stream.fileno()

    def isatty(self) -> bool:
        """Whether the stream is a terminal."""
        return self._stream.isatty()

    def _send(self, fd: int) -> None:
        while self._kept:
            sent = _send(fd, _whole_lines(self._kept))
            if not sent:
                return
            self._kept = self._kept[sent:]
            if self._dropped and not self._kept:
                self._kept, self._dropped = self._notice(self._dropped).encode(), 0


def _descriptor(stream: TextIO) -> int | None:
    try:
        return stream.fileno()
    except (OSError, UnsupportedOperation, ValueError, AttributeError):
        return None


def _whole_lines(data: bytes) -> bytes:
    """The lines at the beginning that a pipe takes whole; a piece of a line that is longer."""
    return data[: data.rfind(b"\n", 0, AT_ONCE) + 1 or AT_ONCE] if len(data) > AT_ONCE else data


def _send(fd: int, data: bytes) -> int:
    """Number of bytes written; all of them if the reader is closed."""
    try:
        return send_unwaiting(fd, data)
    except OSError:  # the other end is closed
        return len(data)
