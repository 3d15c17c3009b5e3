"""The process of a command: its descriptors 0, 1 and 2, and passwords of the command line in the list of processes.

A program may be started with some descriptors closed, as in `serve 2>&-` or by a daemon. The next file that is opened
gets the lowest free descriptor. A port or a recording with the number of stderr would be written to by whatever writes
there. So all three are opened before any other file.
"""

import os
import re
import sys
from io import TextIOWrapper
from pathlib import Path

from gyrodrift.values.secret import WITHIN_WORD

STREAMS = (("stdin", "r"), ("stdout", "w"), ("stderr", "w"))

ARGUMENTS = Path("/proc/self/cmdline")
MEMORY = Path("/proc/self/mem")
STATUS = Path("/proc/self/stat")
ARG_START = 48
"""Field of /proc/PID/stat with the address of the command line (proc(5))."""

PATTERNS = (
    re.compile(WITHIN_WORD.pattern.encode().replace(b".++", rb"([^\0]++)"), re.IGNORECASE),
    re.compile(rb"(://[^\s:@/\0]{0,256}+:)([^\s\0]{1,256})@"),
)
"""`WITHIN_WORD` and `ADDRESS` of `secret` for words that end with a zero byte; the second group is the secret."""


def open_standard_streams() -> None:
    """Put the null device behind each of the three that is closed; `sys.stdout` and the others are files then."""
    for fd, (name, mode) in enumerate(STREAMS):
        if not _is_open(fd):
            _open_null(fd)
        if getattr(sys, name) is None:
            stream = open(fd, mode, encoding="utf-8", errors="backslashreplace", closefd=False)  # noqa: SIM115 - open to the end
            setattr(sys, name, stream)
            setattr(sys, f"__{name}__", stream)


def accept_all_characters() -> None:
    """Let stdout and stderr take every text. An encoding such as ASCII shows `?` for characters that it lacks.

    A pipe on Windows gets UTF-8, the encoding of session tables and reports, not the old code page.
    """
    for stream in (sys.stdout, sys.stderr):
        if not isinstance(stream, TextIOWrapper) or stream.encoding.lower().replace("-", "") == "utf8":
            continue
        if sys.platform == "win32" and not stream.isatty():
            stream.reconfigure(encoding="utf-8")
        else:
            stream.reconfigure(errors="replace")


def _is_open(fd: int) -> bool:
    try:
        os.fstat(fd)
    except OSError:
        return False
    return True


def _open_null(fd: int) -> None:
    null = os.open(os.devnull, os.O_RDWR)
    if null != fd:
        os.dup2(null, fd)
        os.close(null)
    os.set_inheritable(fd, True)


def hide_secrets() -> None:
    """Overwrite passwords on the command line with stars. Before that other users can see them for a moment."""
    try:
        words = ARGUMENTS.read_bytes()
        start = int(STATUS.read_text().rpartition(")")[2].split()[ARG_START - 3])
        with MEMORY.open("r+b", buffering=0) as memory:
            for match in (match for pattern in PATTERNS for match in pattern.finditer(words)):
                memory.seek(start + match.start(2))
                memory.write(b"*" * len(match[2]))
    except OSError:  # no /proc, or no write access to it
        return
