"""The ports of a machine: described by pyserial, those without hardware left out; and who holds one."""

import os
from pathlib import Path

import pytest
from serial.tools import list_ports
from serial.tools.list_ports_common import ListPortInfo

from gyrodrift.link import holder as holder_module
from gyrodrift.link import port as port_module
from gyrodrift.link import serial_port as serial_port_module
from gyrodrift.link.holder import PortHolder, holder_of, is_console
from gyrodrift.link.port import serial_ports
from gyrodrift.link.serial_port import SerialPort


def adapter(device: str) -> ListPortInfo:
    """An FTDI as pyserial describes it."""
    entry = ListPortInfo(device)
    entry.vid, entry.pid = 0x0403, 0x6001
    entry.manufacturer, entry.product, entry.serial_number = "FTDI", "FT232R USB UART", "A50285BI"
    return entry


def test_names_without_a_uart_are_left_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name, kind in (("ttyS0", "4"), ("ttyS1", "0"), ("ttyS2", "0")):
        (tmp_path / name).mkdir()
        (tmp_path / name / "type").write_text(f"{kind}\n")
    (tmp_path / "by-id").mkdir()
    (tmp_path / "by-id" / "usb-FTDI").symlink_to("/dev/ttyUSB7")
    monkeypatch.setattr(serial_port_module, "TERMINALS", tmp_path)
    monkeypatch.setattr(port_module, "BY_ID", tmp_path / "by-id")
    monkeypatch.setattr(list_ports, "comports", lambda: [adapter("/dev/ttyUSB7"), ListPortInfo("/dev/ttyS1")])
    name = str(tmp_path / "by-id" / "usb-FTDI")
    assert serial_ports() == [
        SerialPort("/dev/ttyS0", "/dev/ttyS0"),
        SerialPort(name, "/dev/ttyUSB7", "FTDI", "FT232R USB UART", "0403:6001", "A50285BI"),
    ]


@pytest.mark.parametrize(("content", "pid"), [("1", 1), ("4194305", None), ("", None), ("me", None)])
def test_a_lock_file_tells_who_holds_a_port(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, content: str, pid: int | None
) -> None:
    monkeypatch.setattr(holder_module, "LOCKS", tmp_path)
    (tmp_path / "LCK..ttyUSB7").write_text(f"{content:>10}\n")
    result = holder_of("/dev/ttyUSB7")
    assert (result and result.pid) == pid


def test_the_console_of_the_kernel_counts_as_held(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "active").write_text("tty0 ttyS9\n")
    (tmp_path / "LCK..ttyS8").write_text(f"{os.getpid()}\n")
    monkeypatch.setattr(holder_module, "CONSOLES", tmp_path / "active")
    monkeypatch.setattr(holder_module, "LOCKS", tmp_path)
    assert holder_of("/dev/ttyS9") == PortHolder("the kernel's console", None)
    assert holder_of("/dev/ttyS8") is None
    assert (is_console("/dev/ttyS9"), is_console("/dev/ttyS8")) == (True, False)
