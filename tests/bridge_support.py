"""Real programs between a device and the network: ser2net and socat of Debian, and pyserial's RFC 2217 server."""

import shutil
import socket
import subprocess
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

import pytest
import serial
from serial.rfc2217 import PortManager
from support import PATIENCE_S

FOLDERS = "/usr/sbin:/usr/bin:/usr/local/sbin:/usr/local/bin:/sbin:/bin"


def program(name: str) -> str:
    """Path of a program; skips the test without it."""
    path = shutil.which(name, path=FOLDERS)
    if path is None:
        pytest.skip(f"{name} is not installed")
    return path


@contextmanager
def running(words: Sequence[str], number: int | None = None) -> Iterator["subprocess.Popen[bytes]"]:
    """A program, from the time when it listens on a TCP port."""
    with subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
        try:
            if number is not None:
                _wait_for(number, process)
            yield process
        finally:
            process.kill()


@contextmanager
def ser2net(device: Path, accepter: str, folder: Path, number: int) -> Iterator[None]:
    """ser2net with one serial port."""
    name = program("ser2net")
    config = folder / "ser2net.yaml"
    config.write_text(
        "connection: &gyro\n"
        f"  accepter: {accepter},127.0.0.1,{number}\n"
        f"  connector: serialdev,{device},115200n81,local\n"
        "  options:\n    max-connections: 4\n"
    )
    with running([name, "-n", "-d", "-c", str(config)], number):
        yield


class LinesOfPty(serial.Serial):
    """A pty has no modem lines; here they are off."""

    cts = dsr = ri = cd = False

    def _update_rts_state(self) -> None:
        """Nothing to switch."""

    def _update_dtr_state(self) -> None:
        """Nothing to switch."""


class PyserialServer:
    """The server of pyserial's example `rfc2217_server.py`, for one client."""

    def __init__(self, device: Path) -> None:
        self.serial = LinesOfPty(str(device), 115200, timeout=0.05)
        self._server = socket.create_server(("127.0.0.1", 0))
        self._server.settimeout(PATIENCE_S)
        self.number = self._server.getsockname()[1]
        self._is_over = False
        self._thread = threading.Thread(target=self._serve)
        self._thread.start()

    def write(self, content: bytes) -> None:
        """Send to the client; the name is that of pyserial."""
        self._client.sendall(content)

    def close(self) -> None:
        self._is_over = True
        self._thread.join(PATIENCE_S)
        self._server.close()
        self.serial.close()

    def _serve(self) -> None:
        self._client, _ = self._server.accept()
        with self._client:
            self._client.settimeout(0.01)
            manager = PortManager(self.serial, self)  # type: ignore[arg-type]  # as the example of pyserial
            with suppress(OSError):
                while not self._is_over:
                    self._client.sendall(b"".join(manager.escape(self.serial.read(self.serial.in_waiting or 1))))
                    with suppress(TimeoutError):
                        commands = self._client.recv(1024)
                        if not commands:
                            return
                        self.serial.write(b"".join(manager.filter(commands)))


@contextmanager
def pyserial_server(device: Path) -> Iterator[PyserialServer]:
    server = PyserialServer(device)
    try:
        yield server
    finally:
        server.close()


def _listens(number: int) -> bool:
    """Whether a program listens; without connecting, because ser2net then opens the serial port."""
    hexadecimal = f":{number:04X} 00000000:0000 0A"
    return hexadecimal in Path("/proc/net/tcp").read_text()


def _wait_for(number: int, process: "subprocess.Popen[bytes]") -> None:
    until_s = time.monotonic() + PATIENCE_S
    while not _listens(number):
        assert process.poll() is None, "it ended"
        assert time.monotonic() < until_s, "it does not listen"
        time.sleep(0.02)
