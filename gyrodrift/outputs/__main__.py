"""The process that outputs run in: started by the service with one end of a socket pair, and it ends with it."""

import asyncio
import logging
import resource
import signal
import socket
import sys
from contextlib import suppress

from gyrodrift.io.log import open_log
from gyrodrift.io.logger import FilteringBoundLogger
from gyrodrift.outputs.hub import Hub

DESCRIPTORS = 4096
"""Limit of descriptors, so high that servers refuse clients by their own limits."""


class LibraryLog(logging.Handler):
    """Log messages of the libraries, as lines of the log of the service."""

    def __init__(self, log: FilteringBoundLogger) -> None:
        super().__init__(logging.WARNING)
        self._log = log

    def emit(self, record: logging.LogRecord) -> None:
        """Write one line, without a traceback."""
        self._log.log(record.levelno, "library", of=record.name, message=record.getMessage())


def main(fd: int, level: str, style: str, source: str = "") -> None:
    """Run until the service closes its end; signals that stop the service are ignored here."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
    _, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    with suppress(OSError, ValueError):  # a service manager may forbid it, and set it itself
        resource.setrlimit(resource.RLIMIT_NOFILE, (min(DESCRIPTORS, hard), hard))
    log = open_log(level, style)
    log = log.bind(source=source) if source else log
    logging.getLogger("asyncio").setLevel(logging.CRITICAL)
    logging.basicConfig(handlers=[LibraryLog(log)])
    with socket.socket(fileno=fd) as service:
        asyncio.run(Hub(service, log, source).run())


if __name__ == "__main__":
    main(int(sys.argv[1]), *sys.argv[2:])
