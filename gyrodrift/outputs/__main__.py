"""The process that outputs run in: started by the service with one end of a socket pair, and it ends with it."""

import asyncio
import resource
import signal
import socket
import sys
from contextlib import suppress

from gyrodrift.log import open_log
from gyrodrift.outputs.hub import Hub

DESCRIPTORS = 4096
"""Clients beyond the limit of a server are turned away, not left waiting for a descriptor."""


def main(fd: int, level: str, style: str) -> None:
    """Run until the service closes its end; the signals that stop a service are for the service."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
    _, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    with suppress(OSError, ValueError):  # a service manager may forbid it, and set it itself
        resource.setrlimit(resource.RLIMIT_NOFILE, (min(DESCRIPTORS, hard), hard))
    with socket.socket(fileno=fd) as service:
        asyncio.run(Hub(service, open_log(level, style)).run())


if __name__ == "__main__":
    main(int(sys.argv[1]), sys.argv[2], sys.argv[3])
