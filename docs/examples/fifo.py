"""Source `fifo:PATH`: a named pipe that another program writes into."""

import os
from contextlib import suppress

from gyrodrift.errors import PortMissingError
from gyrodrift.link.port import PortGoneError
from gyrodrift.link.sources.source import ByteSource, SourceAddress, SourcePort

READ_BYTES = 65_536
"""Capacity of a pipe of Linux."""


class FifoPort(SourcePort):
    """Open named pipe."""

    def read(self) -> bytes:
        """Available bytes, without waiting."""
        try:
            chunk = os.read(self.fd or 0, READ_BYTES)
        except BlockingIOError:
            return b""
        if not chunk:
            raise PortGoneError(self.path)
        return chunk

    def close(self) -> None:
        """Close the pipe."""
        with suppress(OSError):
            os.close(self.fd or 0)


def open_fifo(address: SourceAddress) -> FifoPort:
    """Open the pipe."""
    try:
        return FifoPort(address.text, os.open(address.rest, os.O_RDWR | os.O_NONBLOCK))
    except OSError as error:
        raise PortMissingError(f"{address.text}: {error.strerror}; make it with mkfifo {address.rest}") from error


FIFO = ByteSource("fifo", "fifo:PATH", "a named pipe", open_fifo, silence="start the program that writes into the pipe")
