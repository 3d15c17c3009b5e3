"""JSON lines on a file descriptor, written without waiting for the reader.

Lines go out in pieces of PIPE_BUF bytes, which a pipe takes whole or not at all. Lines that the reader does not take
are queued up to a limit; then the oldest lines are dropped.
"""

import errno
import os
import select
import sys
import time
from collections import deque
from collections.abc import Iterator, Mapping
from contextlib import suppress
from typing import Any

from gyrodrift.io.waiting import POLLOUT, new_poller, send_unwaiting
from gyrodrift.outputs.json_line import json_line
from gyrodrift.outputs.thinning import Thinning
from gyrodrift.service.listener import NO_WAKES, IdleListener, ReaderGoneError
from gyrodrift.values.sample import Corrected

STDOUT = 1

PIECE_BYTES: int = getattr(select, "PIPE_BUF", 512)
LONGEST_QUEUE_BYTES = 8 << 20
LAST_S = 1.0
"""Longest wait for a slow reader at the end, s; the remaining lines are dropped."""

GONE = (errno.EPIPE, errno.ECONNRESET, *([errno.EINVAL] if sys.platform == "win32" else []))
TERMINAL_GONE = (*GONE, errno.EIO)
"""Errors of a write to a closed reader; for a file, EIO is a failing disk."""


def pieces_of(lines: list[str]) -> Iterator[str]:
    """Lines joined to pieces that a pipe takes whole or not at all."""
    piece = ""
    for line in lines:
        if piece and len(piece) + len(line) > PIECE_BYTES:
            yield piece
            piece = ""
        piece += line
    if piece:
        yield piece


class LineSink(IdleListener):
    """Counts JSON lines, and thins samples to a rate that may change.

    Parameters
    ----------
    rate_hz
        At most this many lines a second of device time; None for every sample.
    """

    def __init__(self, rate_hz: float | None) -> None:
        self.lines = 0
        self.dropped = 0
        self.set_rate(rate_hz)

    def set_rate(self, rate_hz: float | None) -> None:
        """Change the rate."""
        self.thinning = Thinning(rate_hz)

    @property
    def is_wanted(self) -> bool:
        """The reader of the pipe started the service."""
        return True

    def stats(self) -> dict[str, Any]:
        """Number of lines, and of those dropped for a slow reader."""
        return {"lines": self.lines, "lines_dropped": self.dropped}


class JsonLines(LineSink):
    """Writes corrected samples as JSON lines.

    Parameters
    ----------
    fd
        Descriptor to write to; it is not closed here.
    """

    def __init__(self, fd: int, rate_hz: float | None = None) -> None:
        super().__init__(rate_hz)
        self.fd = fd
        self._queue: deque[bytes] = deque()
        self._queue_bytes = 0
        self._sent = 0
        self._poller = new_poller()
        self._poller.register(fd, POLLOUT)
        self._gone = TERMINAL_GONE if os.isatty(fd) else GONE
        self._writable = {fd: POLLOUT}

    def wakes(self) -> Mapping[int, int]:
        """The descriptor while lines are queued."""
        return self._writable if self._queue else NO_WAKES

    def take(self, samples: list[Corrected]) -> None:
        """Queue a line for each sample that is due, and write as much as the reader takes now."""
        self.write([json_line(corrected) for corrected in self.thinning.due(samples)])

    def write(self, lines: list[str]) -> None:
        """Queue lines, and write as much as the reader takes now."""
        if lines:
            self.lines += len(lines)
            self._enqueue(lines)
        while self._queue and self._write():
            pass

    def close(self) -> None:
        """Write the queued lines for at most LAST_S, and drop the rest."""
        until_s = time.monotonic() + LAST_S
        with suppress(ReaderGoneError):
            while self._queue and (left_s := until_s - time.monotonic()) > 0.0:
                if not self._write():
                    self._poller.poll(1e3 * left_s)
        if self._queue:
            self.dropped -= self._queue[0].count(b"\n", 0, self._sent)
        self.dropped += sum(piece.count(b"\n") for piece in self._queue)
        self._queue.clear()
        self._queue_bytes = self._sent = 0

    def _enqueue(self, lines: list[str]) -> None:
        for piece in pieces_of(lines):
            self.append(piece)
        while self._queue_bytes > LONGEST_QUEUE_BYTES and len(self._queue) > 2:
            self._drop_oldest()

    def append(self, piece: str) -> None:
        """Queue lines as one piece, and write nothing."""
        self._queue.append(piece.encode())
        self._queue_bytes += len(piece)

    def _drop_oldest(self) -> None:
        """Drop the oldest piece, unless a part of it was sent."""
        index = 1 if self._sent else 0
        piece = self._queue[index]
        del self._queue[index]
        self._queue_bytes -= len(piece)
        self.dropped += piece.count(b"\n")

    def _write(self) -> bool:
        """Write the first piece as far as the reader takes it; False if it takes nothing."""
        piece = self._queue[0]
        try:
            sent = send_unwaiting(self.fd, piece[self._sent :] if self._sent else piece)
        except OSError as error:
            if error.errno in self._gone:
                raise ReaderGoneError from error
            raise
        self._sent += sent
        if self._sent >= len(piece):
            self._queue.popleft()
            self._queue_bytes -= len(piece)
            self._sent = 0
        return sent > 0
