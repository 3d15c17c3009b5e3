"""Source `-`: standard input, such as a pipe or a file."""

import os
import select

from gyrodrift.link.heard import PRINTABLE
from gyrodrift.link.sources.source import ByteSource, SourceAddress, SourceEndedError, SourcePort
from gyrodrift.values.errors import LinkError

STDIN = 0
READ_BYTES = 65_536
"""Capacity of a pipe of Linux."""


class StdinPort(SourcePort):
    """Standard input. It is not closed here, and its flags are shared with other programs, so they do not change."""

    def __init__(self, path: str, fd: int = STDIN) -> None:
        super().__init__(path, fd)
        self._fd = fd
        self._last = b""
        self._is_over = False

    def read(self) -> bytes:
        """Available bytes, up to a limit, without waiting; a last line without an end gets one."""
        if self._is_over:
            raise SourceEndedError(self.path)
        if not select.select([self._fd], [], [], 0.0)[0]:
            return b""
        try:
            chunk = os.read(self._fd, READ_BYTES)
        except OSError:
            chunk = b""
        if chunk:
            self._last = chunk[-1:]
            return chunk
        self._is_over = True
        if self._last and self._last not in b"\r\n" and self._last[0] in PRINTABLE:
            return b"\n"
        raise SourceEndedError(self.path)


def open_stdin(address: SourceAddress) -> StdinPort:
    """Read standard input.

    Raises
    ------
    LinkError
        It is closed.
    """
    try:
        os.fstat(STDIN)
    except OSError as error:
        raise LinkError(f"{address.text}: standard input is closed; pipe bytes of a device into it") from error
    return StdinPort(address.text)


STANDARD_INPUT = ByteSource(
    "-",
    "-",
    "standard input, such as a pipe from another program",
    open_stdin,
    holds_back=True,
    silence="check that the program before the pipe writes its lines at once",
)
