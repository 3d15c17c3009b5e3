"""The csv protocol: text lines `t_us,rate_dps[,encoder_deg[,temp_c]]`, as a hobby sketch prints them.

Such lines carry no checksum, so a damaged one may still parse. Two habits of real sketches catch most of that:
a device keeps its number of columns, and a reader that joins in the middle of a line sees a shortened first
line. So the first line is held until two more have come, and a line with another number of columns counts as
damaged until three in a row have it.
"""

import re
from math import isfinite, nan

from gyrodrift.link.protocols.decoder import DecoderCounters, DeviceDescription
from gyrodrift.link.protocols.protocol import WireProtocol
from gyrodrift.sample import Reading

MAX_LINE_BYTES = 256
MAX_RATE_DPS = 2e4
"""Several times what gyros on the market measure; a larger number is a damaged line."""

COLUMN_CHANGE_LINES = 3
JOIN_GAP_US = 1_000_000
"""A first step of time above this, and above four times the second one, comes of a shortened first line."""

NUMBER = rb"\s*+[-+]?+(?:\d++(?:\.\d*+)?+(?:[eE][-+]?+\d++)?+|\.\d++(?:[eE][-+]?+\d++)?+|nan|NaN|NAN|inf|INF)\s*+"
"""Nothing is tried twice: a line of digits alone takes no longer than any other."""

LINE = re.compile(rb"\s*+(\d{1,20}+)\s*+,(%b)(?:,(%b))?+(?:,(%b))?+" % (NUMBER, NUMBER, NUMBER))


class CsvDecoder:
    """Lines ended by LF or CRLF; comments start with `#`."""

    name = "csv"

    def __init__(self) -> None:
        self.counters = DecoderCounters()
        self.device = DeviceDescription()
        self._pending = b""
        self._overlong = False
        self._columns = 0
        self._column_change: list[tuple[int, Reading]] = []
        self._first: list[tuple[int, Reading]] | None = []

    def push(self, chunk: bytes) -> list[Reading]:
        """Split at line ends and parse each whole line."""
        readings: list[Reading] = []
        *lines, pending = (self._pending + chunk).split(b"\n")
        for line in lines:
            self._line(line, readings)
            self._overlong = False
        if len(pending) > MAX_LINE_BYTES:
            self._overlong = True
            pending = pending[:1]
        self._pending = pending
        return readings

    def _line(self, line: bytes, readings: list[Reading]) -> None:
        overlong = self._overlong or len(line) > MAX_LINE_BYTES
        text = line.strip()
        if not overlong and (not text or text.startswith(b"#")):
            return
        parsed = None if overlong else _parse(text)
        if parsed is None:
            self.counters.damaged += 1
            return
        self.counters.frames += 1
        if self._first is None:
            self._accept(*parsed, readings)
        else:
            self._join(*parsed, readings)

    def _join(self, columns: int, reading: Reading, readings: list[Reading]) -> None:
        held = self._first or []
        held.append((columns, reading))
        if len(held) < 3:
            self._first = held
            return
        self._first = None
        if not _first_line_is_whole(held):
            held.pop(0)
            self.counters.frames -= 1
            self.counters.damaged += 1
        self._columns = held[0][0]
        for entry in held:
            self._accept(*entry, readings)

    def _accept(self, columns: int, reading: Reading, readings: list[Reading]) -> None:
        if columns == self._columns:
            self._reject_column_change()
            readings.append(reading)
            return
        self._column_change = [entry for entry in self._column_change if entry[0] == columns]
        self._column_change.append((columns, reading))
        if len(self._column_change) == COLUMN_CHANGE_LINES:
            self._columns = columns
            readings.extend(held for _, held in self._column_change)
            self._column_change = []

    def _reject_column_change(self) -> None:
        self.counters.frames -= len(self._column_change)
        self.counters.damaged += len(self._column_change)
        self._column_change.clear()


def _parse(text: bytes) -> tuple[int, Reading] | None:
    match = LINE.fullmatch(text)
    if match is None:
        return None
    t_us, *values = (group for group in match.groups() if group is not None)
    rate_dps, *others = (float(value) for value in values)
    if isfinite(rate_dps) and abs(rate_dps) > MAX_RATE_DPS:
        return None
    known = (value if isfinite(value) else nan for value in others)  # an angle or temperature without end is none
    return 2 + len(others), Reading(int(t_us) & 0xFFFFFFFF, None, rate_dps, *known)


def _first_line_is_whole(held: list[tuple[int, Reading]]) -> bool:
    (columns, first), (columns_next, second), (_, third) = held
    step_us = ((second.t_us or 0) - (first.t_us or 0)) & 0xFFFFFFFF
    step_next_us = ((third.t_us or 0) - (second.t_us or 0)) & 0xFFFFFFFF
    return columns == columns_next and (step_us <= JOIN_GAP_US or step_us <= 4 * step_next_us)


PROTOCOL = WireProtocol("csv", "lines t_us,rate_dps[,encoder_deg[,temp_c]]", CsvDecoder, has_clock=True, rank=10)
