"""The least that can read ten gyros: poll, receive, count the ends of native frames, and nothing else."""

import json
import select
import socket
import sys
import time
from pathlib import Path

READ_BYTES = 65_536


def main(result: Path, seconds: float, addresses: list[str]) -> None:
    """Read for some seconds after the first byte, and write down the frames of each address."""
    sockets = [_opened(address) for address in addresses]
    poller = select.poll()
    for source in sockets:
        poller.register(source, select.POLLIN)
    by_fd = {source.fileno(): (number, source) for number, source in enumerate(sockets)}
    counts, until_s = [0] * len(sockets), 0.0
    while not until_s or time.monotonic() < until_s:
        for fd, _ in poller.poll(100):
            number, source = by_fd[fd]
            content = source.recv(READ_BYTES)
            counts[number] += content.count(b"\0")
            until_s = until_s or time.monotonic() + seconds
            if not content:
                poller.unregister(fd)
    result.write_text(json.dumps(counts))


def _opened(address: str) -> socket.socket:
    if address.startswith("udp:"):
        source = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        source.bind(("127.0.0.1", int(address.rpartition(":")[2])))
        return source
    if address.startswith("tcp:"):
        return socket.create_connection(("127.0.0.1", int(address.rpartition(":")[2])))
    source = socket.socket(socket.AF_UNIX)
    source.connect(address.removeprefix("unix:"))
    return source


if __name__ == "__main__":
    main(Path(sys.argv[1]), float(sys.argv[2]), sys.argv[3:])
