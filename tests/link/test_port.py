"""The port: exclusive, honest about why it cannot be opened, and quick to notice that it is gone."""

import errno
import os
import pty
import subprocess
import sys
from pathlib import Path
from typing import Any, cast

import pytest
from serial.tools.list_ports_common import ListPortInfo
from support import Command, speaking_on

from gyrodrift.link import port as port_module
from gyrodrift.link.holder import PortHolder, holder_of
from gyrodrift.link.port import Port, PortGoneError, stable_name
from gyrodrift.values.errors import LinkError, PortBusyError, PortMissingError, UsageError


def test_bytes_come_as_they_were_sent(tmp_path: Path) -> None:
    with speaking_on(tmp_path / "gyro") as device:
        port = Port(str(tmp_path / "gyro"), 115200)
        assert port.read() == b""
        device.send(bytes(range(256)))
        assert port.read() == bytes(range(256))
        assert port.is_pty
        port.close()


def test_a_port_that_hung_up_gives_its_last_bytes_or_says_that_it_is_gone(tmp_path: Path) -> None:
    with speaking_on(tmp_path / "gyro"):
        port = Port(str(tmp_path / "gyro"), 115200)
    for _ in range(2):
        with pytest.raises(PortGoneError):
            port.read()
    with pytest.raises(PortGoneError):
        port.set_baud(9600)
    port.close()


def test_a_missing_port_is_named() -> None:
    with pytest.raises(PortMissingError, match=r"/dev/ttyNONE: there is no such port; (ports on|no serial port)"):
        Port("/dev/ttyNONE", 115200)


def test_a_link_whose_device_is_off_is_told_from_a_wrong_name(tmp_path: Path) -> None:
    """The name is right, the device is not there."""
    (tmp_path / "gyro").symlink_to("/dev/pts/99999")
    with pytest.raises(PortMissingError, match="points to /dev/pts/99999, which is not there; is the device on"):
        Port(str(tmp_path / "gyro"), 115200)


def test_a_file_is_no_port(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("0,1\n")
    with pytest.raises(LinkError, match="this is not a serial port"):
        Port(str(tmp_path / "file"), 115200)


def test_a_baud_rate_that_the_system_cannot_do_is_a_usage_error(tmp_path: Path) -> None:
    with speaking_on(tmp_path / "gyro"), pytest.raises(UsageError, match="cannot use -5 baud"):
        Port(str(tmp_path / "gyro"), -5)


def test_a_busy_port_names_who_holds_it(tmp_path: Path) -> None:
    """A second reader would steal bytes from the first."""
    link = tmp_path / "gyro"
    with speaking_on(link), Command("serve", "--port", link) as first:
        first.until_log("link_open")
        with pytest.raises(PortBusyError, match=rf"in use by \S+ \(pid {first.process.pid}\); stop that program first"):
            Port(str(link), 115200)
        assert first.stop() == 0


NAMELESS = """
import ctypes, sys, time
ctypes.CDLL(None).prctl(15, b"\\xff\\xfe")
file = open(sys.argv[1], "rb")
print(flush=True)
time.sleep(60)
"""
"""A process whose name is no text, with a file open; 15 is PR_SET_NAME."""


def test_who_holds_a_port_may_have_any_name(tmp_path: Path) -> None:
    kept = tmp_path / "gyro"
    kept.write_text("")
    with subprocess.Popen([sys.executable, "-c", NAMELESS, kept], stdout=subprocess.PIPE) as process:
        assert process.stdout is not None
        process.stdout.readline()
        result = holder_of(str(kept))
        process.kill()
    assert result == PortHolder("\ufffd\ufffd", process.pid)


@pytest.mark.promise("Recovery")
def test_an_adapter_that_is_pulled_while_ports_are_listed_ends_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """An adapter that is unplugged while ports are listed ends nothing."""
    looks: list[int] = []

    def comports() -> list[ListPortInfo]:
        looks.append(1)
        if len(looks) < 3:
            return [int(None, 16)]  # type: ignore[call-overload]  # what pyserial does
        return [ListPortInfo("/dev/ttyUSB7")]

    monkeypatch.setattr("gyrodrift.link.port.list_ports.comports", comports)
    with pytest.raises(PortMissingError, match=r"ports on this machine: .*/dev/ttyUSB7"):
        Port("/dev/ttyNONE", 115200)
    looks.clear()
    monkeypatch.setattr(port_module, "LOOKS", 2)
    with pytest.raises(PortMissingError, match="/dev/ttyNONE: there is no such port"):
        Port("/dev/ttyNONE", 115200)


def test_an_adapter_is_remembered_by_its_stable_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(port_module, "BY_ID", tmp_path / "by-id")
    assert stable_name("/dev/null") == "/dev/null"
    (tmp_path / "by-id").mkdir()
    (tmp_path / "by-id" / "usb-gyro").symlink_to("/dev/null")
    assert stable_name("/dev/null") == str(tmp_path / "by-id" / "usb-gyro")
    assert stable_name("/dev/zero") == "/dev/zero"
    (tmp_path / "gyro").symlink_to("/dev/null")
    assert stable_name(str(tmp_path / "gyro")) == str(tmp_path / "gyro")


def test_only_ptys_count_as_ptys() -> None:
    """Line capacity means nothing on them."""
    master, slave = pty.openpty()
    with Path("/dev/null").open() as null:
        assert port_module._is_pty(slave)
        assert not port_module._is_pty(null.fileno())
    os.close(master)
    os.close(slave)


@pytest.mark.promise("Recovery")
def test_a_name_that_flickers_is_explained_all_the_same(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A port name that flickers ends nothing."""
    name = tmp_path / "gyro"
    refusal = PermissionError(errno.EACCES, "refused")
    for looks in range(8):
        name.write_text("")
        remaining = [looks]
        real = os.stat

        def look(path: Any, leftover: list[int] = remaining, real: Any = real, **how: Any) -> os.stat_result:
            if str(path) == str(name):
                leftover[0] -= 1
                if leftover[0] < 0:
                    name.unlink(missing_ok=True)
            return cast("os.stat_result", real(path, **how))

        monkeypatch.setattr(os, "stat", look)
        assert isinstance(port_module._explain(str(name), refusal), LinkError)
        monkeypatch.undo()
    monkeypatch.setattr(port_module, "BY_ID", tmp_path / "by-id")
    monkeypatch.setattr(Path, "is_dir", lambda _: True)
    assert stable_name("/dev/ttyNONE") == "/dev/ttyNONE"


@pytest.mark.promise("Recovery")
def test_a_port_that_fails_in_a_way_of_its_own_is_gone_too(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A port that fails in an unknown way counts as unplugged."""

    def fail(*_: object) -> bytes:
        raise OSError(errno.EPROTO, "protocol error")

    with speaking_on(tmp_path / "gyro"):
        port = Port(str(tmp_path / "gyro"), 115200)
        with monkeypatch.context() as patched:
            patched.setattr(os, "read", fail)
            with pytest.raises(PortGoneError):
                port.read()
        port.close()
