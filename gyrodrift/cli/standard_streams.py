"""Descriptors 0, 1 and 2 of a program that was started with some of them closed, as in `serve 2>&-` or by a daemon.

The next file that is opened gets the lowest free descriptor. A port or a recording with the number of stderr would be
written to by whatever writes there. So all three are opened before any other file.
"""

import os
import sys
from io import TextIOWrapper

STREAMS = (("stdin", "r"), ("stdout", "w"), ("stderr", "w"))


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
