"""The log: one line per event on stderr, sentences on a terminal, key=value or JSON elsewhere."""

import os
import sys
from collections.abc import Callable
from io import TextIOBase, UnsupportedOperation
from typing import Any, TextIO, cast

from gyrodrift.io.logger import FilteringBoundLogger, structlog
from gyrodrift.io.terminal import AboveLine, is_screen
from gyrodrift.io.waiting import send_unwaiting
from gyrodrift.values.errors import UsageError, printable
from gyrodrift.values.secret import without_secrets

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


LEVELS = {"debug": 10, "info": 20, "warning": 30, "error": 40}
FORMATS = ("auto", "text", "json")


def unwaiting_stderr(style: str) -> UnwaitingStream:
    """Standard error without waiting for its reader; dropped lines are counted in a line of the log's `style`."""

    def notice(lines: int) -> str:
        if style == "json":
            return f'{{"event": "log_lines_dropped", "lines": {lines}, "level": "warning"}}\n'
        return f"level=warning event=log_lines_dropped lines={lines}\n"

    return UnwaitingStream(sys.stderr, notice)


def open_log(level: str = "info", style: str = "auto", stream: TextIOBase | None = None) -> FilteringBoundLogger:
    """Set up the log of this process, with a minimum level, on stderr by default; returns the logger.

    On a terminal each line first clears a line that is rewritten in place, and the default style is sentences.

    Raises
    ------
    UsageError
        If there is no such level or format.
    """
    if level not in LEVELS or style not in FORMATS:
        raise UsageError(f"no log of level {level!r} and format {style!r}")
    renderer: Any
    is_for_person = style == "auto" and sys.stderr.isatty()
    if style == "json":
        renderer = structlog.processors.JSONRenderer()
    elif not is_for_person:
        renderer = structlog.processors.LogfmtRenderer(key_order=["timestamp", "level", "event"], bool_as_flag=False)
    else:
        from gyrodrift.io.log_words import PersonRenderer  # noqa: PLC0415 - a log for machines does not need it

        renderer = PersonRenderer(sys.stderr.fileno(), has_colors=_has_colors())
    log_to = cast("TextIO", stream or _stderr(style))  # structlog needs only write and flush
    structlog.configure(
        processors=[
            _public,
            structlog.processors.add_log_level,
            structlog.processors.TimeStamper(*(("%H:%M:%S", False) if is_for_person else ("iso", True))),
            *([] if style == "json" else [_printable]),
            renderer,
        ],
        wrapper_class=structlog.make_filtering_bound_logger(LEVELS[level]),
        logger_factory=structlog.WriteLoggerFactory(log_to),  # a line and its end are one write
        cache_logger_on_first_use=True,
    )
    logger: FilteringBoundLogger = structlog.get_logger()
    return logger


def _public(_logger: Any, _method: str, entry: structlog.typing.EventDict) -> structlog.typing.EventDict:
    """Remove passwords from messages and addresses."""
    for key, value in entry.items():
        if isinstance(value, str):
            entry[key] = without_secrets(value)
    return entry


def _printable(_logger: Any, _method: str, entry: structlog.typing.EventDict) -> structlog.typing.EventDict:
    """Escape control characters: names of devices and clients must not command a terminal."""
    for key, value in entry.items():
        if isinstance(value, str):
            entry[key] = printable(value)
    return entry


def _stderr(style: str) -> TextIOBase:
    """Standard error without waiting; its lines replace a line in place if it is a terminal that can."""
    stderr = unwaiting_stderr(style)
    return AboveLine(cast("TextIO", stderr)) if is_screen(sys.stderr) else stderr


def _has_colors() -> bool:
    """Whether the environment allows color, by https://no-color.org and https://force-color.org."""
    return bool(os.environ.get("FORCE_COLOR")) or not os.environ.get("NO_COLOR")
