"""The log: one line an event on stderr, for a person on a terminal and as key=value or JSON elsewhere."""

import os
import sys
from io import TextIOBase
from typing import Any, TextIO, cast

from gyrodrift.errors import UsageError
from gyrodrift.log_stream import UnwaitingStream
from gyrodrift.logger import FilteringBoundLogger, structlog
from gyrodrift.secret import without_secrets

LEVELS = {"debug": 10, "info": 20, "warning": 30, "error": 40}
FORMATS = ("auto", "text", "json")


def unwaiting_stderr(style: str) -> UnwaitingStream:
    """Standard error that nothing waits for; `style` is that of the log, in which dropped lines are told."""

    def told(lines: int) -> str:
        if style == "json":
            return f'{{"event": "log_lines_dropped", "lines": {lines}, "level": "warning"}}\n'
        return f"level=warning event=log_lines_dropped lines={lines}\n"

    return UnwaitingStream(sys.stderr, told)


def open_log(level: str = "info", style: str = "auto", stream: TextIOBase | None = None) -> FilteringBoundLogger:
    """Set up the log of this process and give its logger; `level` is the least that is written, to stderr unless told.

    Raises
    ------
    UsageError
        Where there is no such level or format.
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
        renderer = structlog.dev.ConsoleRenderer(colors=_has_colours())
    log_to = cast("TextIO", stream or unwaiting_stderr(style))  # print() asks for no more than write and flush
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
        logger_factory=structlog.PrintLoggerFactory(log_to),
        cache_logger_on_first_use=True,
    )
    logger: FilteringBoundLogger = structlog.get_logger()
    return logger


def _public(_logger: Any, _method: str, entry: structlog.typing.EventDict) -> structlog.typing.EventDict:
    """Nobody finds a password in the log, whichever address or message holds it."""
    for key, value in entry.items():
        if isinstance(value, str):
            entry[key] = without_secrets(value)
    return entry


def _printable(_logger: Any, _method: str, entry: structlog.typing.EventDict) -> structlog.typing.EventDict:
    """A terminal obeys control characters, and what devices and clients call themselves may hold some."""
    for key, value in entry.items():
        if isinstance(value, str) and not value.isprintable():
            entry[key] = "".join(each if each.isprintable() else repr(each)[1:-1] for each in value)
    return entry


def _sentence(_logger: Any, _method: str, entry: structlog.typing.EventDict) -> structlog.typing.EventDict:
    """The sentence of an event that has a summary, in place of its name and fields."""
    if "summary" not in entry:
        return entry
    return {"event": entry["summary"], "level": entry["level"], "timestamp": entry["timestamp"]}


def _has_colours() -> bool:
    """As https://no-color.org and https://force-color.org have it."""
    return bool(os.environ.get("FORCE_COLOR")) or not os.environ.get("NO_COLOR")
