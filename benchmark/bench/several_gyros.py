"""Ten gyros of 1 kHz in one process: four send datagrams, three serve TCP, three serve unix sockets.

They begin when all servers have their client. A frame that a socket does not take is counted.
"""

import gc
import json
import socket
import sys
import time
from contextlib import suppress
from pathlib import Path

from bench import harness

HELLO_EVERY = 1000
SETTLING_S = 3.0


def main(result: Path, count: int, rate_hz: float, addresses: list[str]) -> None:
    """Send `count` frames to each address, and write down what was refused."""
    frames = harness.native_frames(count, round(1e6 / rate_hz))
    greeting = harness.hello(rate_hz)
    listening = [_server(address) for address in addresses if not address.startswith("udp:")]
    result.with_suffix(".ready").touch()
    gyros = [_datagrams(address) for address in addresses if address.startswith("udp:")]
    gyros += [server.accept()[0] for server in listening]
    for gyro in gyros:
        gyro.setblocking(False)
    gc.disable()
    time.sleep(SETTLING_S)  # the reader has connected, but it may not read yet
    refused, late_s, origin_s = 0, 0.0, time.monotonic()
    for number, frame in enumerate(frames):
        due_s = origin_s + number / rate_hz
        now_s = time.monotonic()
        if due_s > now_s:
            time.sleep(due_s - now_s)
        late_s = max(late_s, now_s - due_s)
        content = greeting + frame if number % HELLO_EVERY == 0 else frame
        for gyro in gyros:
            try:
                refused += gyro.send(content) != len(content)
            except OSError:
                refused += 1
    result.write_text(json.dumps({"refused": refused, "late_s": late_s, "seconds": time.monotonic() - origin_s}))
    time.sleep(SETTLING_S)
    for gyro in [*gyros, *listening]:
        gyro.close()


def _server(address: str) -> socket.socket:
    if address.startswith("tcp:"):
        return socket.create_server(("127.0.0.1", int(address.rpartition(":")[2])))
    server = socket.socket(socket.AF_UNIX)
    server.bind(address.removeprefix("unix:"))
    server.listen()
    return server


def _datagrams(address: str) -> socket.socket:
    gyro = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    with suppress(OSError):
        gyro.connect(("127.0.0.1", int(address.rpartition(":")[2])))
    return gyro


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]), float(sys.argv[3]), sys.argv[4:])
