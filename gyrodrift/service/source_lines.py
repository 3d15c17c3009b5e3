"""JSON lines of several sources on one descriptor: the pieces of the sources are written in turn.

Each source has its own queue, so a source that floods does not push the lines of another one out.
"""

from collections import deque
from collections.abc import Mapping

from gyrodrift.outputs.json_line import json_line
from gyrodrift.outputs.net.limits import Backlog
from gyrodrift.service.stdout import LONGEST_QUEUE_BYTES, JsonLines, LineSink, pieces_of
from gyrodrift.values.sample import Corrected


class SharedLines:
    """Descriptor that several sources share.

    Parameters
    ----------
    fd
        Descriptor to write to; it is not closed here.
    """

    def __init__(self, fd: int) -> None:
        self._output = JsonLines(fd)
        self._waiting = deque["SourceLines"]()
        self._sources = 0

    def add(self) -> None:
        """Count one more source."""
        self._sources += 1

    @property
    def longest_queue_bytes(self) -> int:
        """Share of a source of the memory for queued lines."""
        return LONGEST_QUEUE_BYTES // max(self._sources, 1)

    def wakes(self) -> Mapping[int, int]:
        """The descriptor while lines are queued."""
        return self._output.wakes()

    def write(self, source: "SourceLines | None" = None) -> None:
        """Write as much as the reader takes now; `source` has new lines."""
        if source is not None and source not in self._waiting:
            self._waiting.append(source)
        self._output.write([])
        while self._waiting and not self._output.wakes():
            self._output.write([self._next_piece()])

    def close(self) -> None:
        """Write the queued lines for a short time, and drop the rest."""
        while self._waiting:
            self._output.append(self._next_piece())
        self._output.close()

    def _next_piece(self) -> str:
        source = self._waiting.popleft()
        piece = source.next_piece()
        if source.has_pieces:
            self._waiting.append(source)
        return piece


class SourceLines(LineSink):
    """JSON lines of one of several sources."""

    def __init__(self, shared: SharedLines, source: str, rate_hz: float | None = None) -> None:
        super().__init__(rate_hz)
        self._shared = shared
        self._opening = f'{{"source":"{source}",'
        self._pieces = Backlog[str](shared.longest_queue_bytes)
        shared.add()

    @property
    def has_pieces(self) -> bool:
        """Whether lines are queued here."""
        return bool(self._pieces)

    def next_piece(self) -> str:
        """Remove and return the oldest lines."""
        return self._pieces.pop()[0]

    def wakes(self) -> Mapping[int, int]:
        """The descriptor while lines are queued."""
        return self._shared.wakes()

    def take(self, samples: list[Corrected]) -> None:
        """Queue a line for each sample that is due, and write as much as the reader takes now."""
        due = self.thinning.due(samples)
        self.lines += len(due)
        self._pieces.longest_bytes = self._shared.longest_queue_bytes
        for piece in pieces_of([json_line(corrected, self._opening) for corrected in due]):
            self._pieces.append(piece, piece.count("\n"))
        self.dropped = self._pieces.dropped
        self._shared.write(self if self._pieces else None)
