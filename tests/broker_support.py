"""A real MQTT broker, mosquitto, for as long as a test needs one."""

import shutil
import socket
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from support import PATIENCE_S

MOSQUITTO = shutil.which("mosquitto", path="/usr/sbin:/usr/bin:/usr/local/sbin:/usr/local/bin:/sbin")


def need_mosquitto() -> None:
    """Skip where the broker or its client is not installed."""
    if MOSQUITTO is None or shutil.which("mosquitto_sub") is None:
        pytest.skip("mosquitto and mosquitto-clients are not installed", allow_module_level=True)


needs_openssl = pytest.mark.skipif(
    shutil.which("openssl") is None, reason="openssl, which makes the certificate, is not installed"
)


def certificate(folder: Path) -> Path:
    """Certificate of 127.0.0.1 that trusts itself; its key is beside it, with the ending `.key`."""
    path = folder / "broker.pem"
    command = [
        *("openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-keyout", str(path.with_suffix(".key"))),
        *("-out", str(path), "-days", "2", "-subj", "/CN=127.0.0.1", "-addext", "subjectAltName=IP:127.0.0.1"),
    ]
    subprocess.run(command, check=True, capture_output=True)
    return path


@contextmanager
def broker(number: int, folder: Path, *lines: str) -> Iterator["subprocess.Popen[bytes]"]:
    """Mosquitto on a port, with lines of its configuration, until the end of the block."""
    config = folder / "mosquitto.conf"
    config.write_text(
        "\n".join([f"listener {number} 127.0.0.1", "user root", *(lines or ["allow_anonymous true"]), ""])
    )
    with subprocess.Popen(
        [str(MOSQUITTO), "-c", config], stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL
    ) as process:
        try:
            _wait_for(number, process)
            yield process
        finally:
            process.kill()


def _wait_for(number: int, process: "subprocess.Popen[bytes]") -> None:
    until_s = time.monotonic() + PATIENCE_S
    while True:
        try:
            socket.create_connection(("127.0.0.1", number), PATIENCE_S).close()
        except ConnectionRefusedError:
            assert process.poll() is None, "mosquitto ended"
            assert time.monotonic() < until_s, "mosquitto does not listen"
            time.sleep(0.02)
        else:
            return
