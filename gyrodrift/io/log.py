"""The log: one line per event on stderr, readable on a terminal, key=value or JSON elsewhere."""

import os
import sys
from io import TextIOBase
from typing import Any, TextIO, cast

from gyrodrift.io.log_stream import UnwaitingStream
from gyrodrift.io.logger import FilteringBoundLogger, structlog
from gyrodrift.values.errors import UsageError, printable
from gyrodrift.values.secret import without_secrets

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
        renderer = structlog.dev.ConsoleRenderer(colors=_has_colors())
    log_to = cast("TextIO", stream or unwaiting_stderr(style))  # structlog needs only write and flush
    structlog.configure(
        processors=[
            _public,
            structlog.processors.add_log_level,
            structlog.processors.TimeStamper(*(("%H:%M:%S", False) if is_for_person else ("iso", True))),
            *([] if style == "json" else [_printable]),
            *([_sentence] if is_for_person else []),
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


def _sentence(_logger: Any, _method: str, entry: structlog.typing.EventDict) -> structlog.typing.EventDict:
    """Replace an event that has a summary by that sentence."""
    if "summary" not in entry:
        return entry
    return {"event": entry["summary"], "level": entry["level"], "timestamp": entry["timestamp"]}


def _has_colors() -> bool:
    """Whether the environment allows color, by https://no-color.org and https://force-color.org."""
    return bool(os.environ.get("FORCE_COLOR")) or not os.environ.get("NO_COLOR")
