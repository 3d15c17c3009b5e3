"""One JSON object a line on a file descriptor, without ever waiting for whoever reads it.

A pipe that polls as writable takes PIPE_BUF bytes at once; so lines go out in such pieces, and what the reader
does not take is kept up to a bound, then dropped, oldest first and whole lines only.
"""

import os
import select
from collections import deque
from collections.abc import Iterator, Mapping
from typing import Any

from gyrodrift.sample import Corrected
from gyrodrift.service.outputs.output import ReaderGoneError

STDOUT = 1

PIECE_BYTES = select.PIPE_BUF
LONGEST_QUEUE_BYTES = 8 << 20
LAST_WAIT_MS = 500
SAME_TIME_S = 1e-6
"""Device clocks count microseconds; closer than this is the same time."""

MEASURED = '{"seq":%d,"t_s":%.6f,"rate_dps":%.5f,"corrected_dps":%.5f,"yaw_deg":%.4f,"bias_dps":%.5f'
CERTAINTY = ',"yaw_sigma_deg":%.4f,"confidence":%.4f'
ENCODER = ',"encoder_deg":%.4f'
TEMPERATURE = ',"temp_c":%.2f'
"""A line, part by part. Device clocks count microseconds; a hundredth of a millidegree per second is 0.036 deg in an
hour, less than the bias instability of any such gyro; 1e-4 deg is a count of 3.6 million, finer than encoders of
turntables; a probability and a thermometer mean less than what is written. Recordings keep every digit. The `%` of
whole parts takes a third of the time of an f-string of every digit."""

NOTHING: Mapping[int, int] = {}


def open_output(options: Mapping[str, Any]) -> "JsonLines":
    """Lines on stdout; `rate_hz` thins them out."""
    return JsonLines(STDOUT, **options)


class JsonLines:
    """Writes corrected samples as JSON lines.

    Parameters
    ----------
    fd
        Descriptor to write to; it is not closed here.
    rate_hz
        At most this many lines a second of device time; None for every sample.
    """

    def __init__(self, fd: int, rate_hz: float | None = None) -> None:
        self.lines = 0
        self.dropped = 0
        self.fd = fd
        self._every_s = 1.0 / rate_hz if rate_hz else 0.0
        self._due_s = float("-inf")
        self._queue: deque[bytes] = deque()
        self._queue_bytes = 0
        self._sent = 0
        self._poller = select.poll()
        self._poller.register(fd, select.POLLOUT)
        self._writable = {fd: select.POLLOUT}

    def wakes(self) -> Mapping[int, int]:
        """The descriptor while lines are left that the reader has not taken."""
        return self._writable if self._queue else NOTHING

    def take(self, samples: list[Corrected]) -> None:
        """Queue a line for each sample that thinning leaves, and write as much as the reader takes now."""
        lines = [json_line(corrected) for corrected in (self._thinned(samples) if self._every_s else samples)]
        if lines:
            self.lines += len(lines)
            self._enqueue(lines)
        while self._queue and self._poller.poll(0):
            self._write()

    def tick(self, now_s: float) -> None:
        """Nothing: lines leave as they come, or when the descriptor wakes the service."""

    def stats(self) -> dict[str, Any]:
        """Lines handed over, and how many of them the reader was too slow for."""
        return {"lines": self.lines, "lines_dropped": self.dropped}

    def close(self) -> None:
        """Give a slow reader a moment to take what is left."""
        self.take([])
        while self._queue and self._poller.poll(LAST_WAIT_MS):
            self._write()

    def _thinned(self, samples: list[Corrected]) -> Iterator[Corrected]:
        """Those that are due, in device time."""
        for corrected in samples:
            t_s = corrected.sample.t_device_s
            if t_s >= self._due_s - SAME_TIME_S:
                self._due_s = self._due_s + self._every_s if t_s < self._due_s + self._every_s else t_s + self._every_s
                yield corrected

    def _enqueue(self, lines: list[str]) -> None:
        piece = lines[0]
        for line in lines[1:]:
            if len(piece) + len(line) > PIECE_BYTES:
                self._append(piece)
                piece = ""
            piece += line
        self._append(piece)
        while self._queue_bytes > LONGEST_QUEUE_BYTES and len(self._queue) > 2:
            self._drop_oldest()

    def _append(self, piece: str) -> None:
        self._queue.append(piece.encode())
        self._queue_bytes += len(piece)

    def _drop_oldest(self) -> None:
        """Drop the oldest piece that has not begun to be sent."""
        at = 1 if self._sent else 0
        piece = self._queue[at]
        del self._queue[at]
        self._queue_bytes -= len(piece)
        self.dropped += piece.count(b"\n")

    def _write(self) -> None:
        piece = self._queue[0]
        try:
            sent = os.write(self.fd, piece[self._sent :] if self._sent else piece)
        except BlockingIOError:
            return
        except (BrokenPipeError, ConnectionResetError) as error:
            raise ReaderGoneError from error
        self._sent += sent
        if self._sent >= len(piece):
            self._queue.popleft()
            self._queue_bytes -= len(piece)
            self._sent = 0


def json_line(corrected: Corrected) -> str:
    """The line for one sample, each number with the digits that mean something; absent values are left out."""
    (seq, t_s, _, rate_dps, encoder_deg, temp_c), corrected_dps, yaw_deg, bias_dps, yaw_sigma_deg, confidence = (
        corrected
    )
    line = MEASURED % (seq, t_s, rate_dps, corrected_dps, yaw_deg, bias_dps)
    if yaw_sigma_deg == yaw_sigma_deg:  # noqa: PLR0124 - false for NaN alone, and the fastest way to ask
        line += CERTAINTY % (yaw_sigma_deg, confidence)
    if encoder_deg == encoder_deg:  # noqa: PLR0124
        line += ENCODER % encoder_deg
    if temp_c == temp_c:  # noqa: PLR0124
        line += TEMPERATURE % temp_c
    return line + "}\n"
