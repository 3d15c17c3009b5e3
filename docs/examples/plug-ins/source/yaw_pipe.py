"""Source `pipe:PATH`: a named pipe that another program writes into."""

import os
from contextlib import suppress

from gyrodrift.errors import PortMissingError
from gyrodrift.link.sources.source import ByteSource, SourceAddress, SourcePort

GYRODRIFT_API = 1
READ_BYTES = 65_536


class PipePort(SourcePort):
    """Open named pipe."""

    def read(self) -> bytes:
        """Available bytes, without waiting."""
        with suppress(BlockingIOError):
            return os.read(self.fd or 0, READ_BYTES)
        return b""

    def close(self) -> None:
        """Close the pipe."""
        with suppress(OSError):
            os.close(self.fd or 0)


def open_pipe(address: SourceAddress) -> PipePort:
    """Open the pipe for reading and writing, so that it has no end."""
    try:
        return PipePort(address.text, os.open(address.rest, os.O_RDWR | os.O_NONBLOCK))
    except OSError as error:
        raise PortMissingError(f"{address.text}: {error.strerror}; make it with mkfifo {address.rest}") from error


PIPE = ByteSource("pipe", "pipe:PATH", "a named pipe", open_pipe, silence="start the program that writes into the pipe")
