"""The port that a thread reads, for systems without termios: it gives the same bytes, and ends with its port."""

import errno
import threading
from pathlib import Path

import pytest
from support import speaking_on

from gyrodrift.io.waiting import POLLIN, SelectPoller
from gyrodrift.link import port as port_module
from gyrodrift.link.port import PortGoneError
from gyrodrift.link.thread_port import ThreadPort
from gyrodrift.values.errors import LinkError, PortBusyError, PortMissingError

LONGEST_WAIT_MS = 20_000
"""For a loaded machine; the wait ends with the first byte."""


def read_within(port: ThreadPort, count: int) -> bytes:
    """The next `count` bytes, waiting on `fd` as the loop of the service does."""
    poller, content = SelectPoller(), b""
    poller.register(port.fd or 0, POLLIN)
    while len(content) < count:
        assert poller.poll(LONGEST_WAIT_MS), f"{len(content)} of {count} bytes"
        content += port.read()
    return content


def test_bytes_come_as_they_were_sent(tmp_path: Path) -> None:
    with speaking_on(tmp_path / "gyro") as device:
        port = ThreadPort(str(tmp_path / "gyro"), 115200)
        assert port.read() == b""
        device.send(bytes(range(256)))
        assert read_within(port, 256) == bytes(range(256))
        assert port.write(b"go") == 2
        port.close()


def test_a_port_that_hung_up_gives_its_last_bytes_and_says_that_it_is_gone(tmp_path: Path) -> None:
    """The thread ends, and wakes the loop for the last time."""
    with speaking_on(tmp_path / "gyro") as device:
        port = ThreadPort(str(tmp_path / "gyro"), 115200)
        device.send(b"last")
        assert read_within(port, 4) == b"last"
    with pytest.raises(PortGoneError):
        read_within(port, 1)
    port.close()
    assert "read " not in {thread.name[:5] for thread in threading.enumerate()}


def test_another_baud_rate_drops_the_bytes_of_the_old_one(tmp_path: Path) -> None:
    with speaking_on(tmp_path / "gyro") as device:
        port = ThreadPort(str(tmp_path / "gyro"), 115200)
        device.send(b"old")
        poller = SelectPoller()
        poller.register(port.fd or 0, POLLIN)
        assert poller.poll(LONGEST_WAIT_MS)
        port.set_baud(9600)
        device.send(b"new")
        assert read_within(port, 3) == b"new"
        port.close()


@pytest.mark.parametrize(
    ("error", "kind", "words"),
    [
        (OSError("could not open port 'COM9': FileNotFoundError(2)"), PortMissingError, "there is no such port"),
        (OSError(errno.ENOENT, "no such file"), PortMissingError, "there is no such port"),
        (OSError("could not open port 'COM3': PermissionError(13)"), PortBusyError, "stop the program"),
        (OSError("a device attached to the system is not functioning"), LinkError, "cannot be opened"),
    ],
)
def test_errors_of_windows_are_explained(
    error: OSError, kind: type[LinkError], words: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Pyserial quotes them in the text of its own."""
    monkeypatch.setattr(port_module, "HAS_TERMIOS", False)

    def fail(*_: object, **__: object) -> None:
        raise error

    monkeypatch.setattr("serial.Serial", fail)
    with pytest.raises(kind, match=words):
        port_module.open_serial("COM3", 115200)
