"""Findings of `gyrodrift doctor` at the port: rights, holder, name, adapter, latency timer, a full line.

Adapters are played: their place in sysfs is a folder of the test, and their names are given to pyserial's list.
"""

import os
import pwd
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import pytest
import serial
from doctor_support import FAST, SECONDS, assert_findings, device, doctor, running_device
from serial.tools import list_ports
from serial.tools.list_ports_common import ListPortInfo
from support import Command, speaking_on

from gyrodrift.link import holder as port_holder
from gyrodrift.link import serial_port
from gyrodrift.session.mcap.write import McapWriter
from gyrodrift.values.sample import Sample

RIG = "base: {sample_rate_hz: %d, dps_per_lsb: 0.00763, noise_dps_rthz: 0.0035, bias_dps: 0.35}\n"

Adapter = Callable[..., None]


@pytest.fixture
def adapter(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Adapter:
    """Makes the pty behind a port look like an adapter."""

    def plug(port: Path, driver: str, latency_ms: int | None = None, usb_id: tuple[int, int] | None = None) -> None:
        terminal = os.path.realpath(port)
        folder = tmp_path / "sys" / Path(terminal).name / "device"
        folder.mkdir(parents=True)
        (folder / "driver").symlink_to(tmp_path / "drivers" / driver)
        if latency_ms is not None:
            (folder / "latency_timer").write_text(f"{latency_ms}\n")
        monkeypatch.setattr(serial_port, "TERMINALS", tmp_path / "sys")
        entry = ListPortInfo(terminal)
        if usb_id is not None:
            entry.vid, entry.pid = usb_id
            entry.manufacturer, entry.product = "FTDI", "FT232R USB UART"
        monkeypatch.setattr(list_ports, "comports", lambda *_: [entry])

    return plug


@pytest.fixture
def plugged_in(monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    """Makes these ports those of the machine."""

    def plug(*ports: Path) -> None:
        monkeypatch.setattr(list_ports, "comports", lambda *_: [ListPortInfo(str(name)) for name in ports])
        monkeypatch.setattr(serial_port, "TERMINALS", Path("/nowhere"))

    return plug


def test_an_adapter_that_holds_bytes_back(port: Path, adapter: Adapter, capsys: pytest.CaptureFixture[str]) -> None:
    with device(port, *FAST, "--profile", "rest"):
        adapter(port, "ftdi_sio", latency_ms=16, usb_id=(0x0403, 0x6001))
        _, result = doctor(capsys, "--port", port, "--seconds", "0.2")
    terminal = result["port"]["says"].rpartition("/")[2].rstrip(".")
    assert_findings(
        result,
        [
            ("adapter", "ok", "FTDI FT232R USB UART (0403:6001), with the driver ftdi_sio"),
            ("latency_timer", "warning", "delays bytes by up to 16 ms"),
            ("latency_timer", "warning", f"/sys/bus/usb-serial/devices/{terminal}/latency_timer"),
            ("name", "note", "no name in /dev/serial/by-id"),
            ("baud", "ok", "It sends at 115200 baud; this stream fits at 38400, 57600, 115200, 230400."),
        ],
    )


def test_an_adapter_as_it_should_be(port: Path, adapter: Adapter, capsys: pytest.CaptureFixture[str]) -> None:
    with device(port, *FAST, "--profile", "rest"):
        adapter(port, "cdc_acm", latency_ms=1)
        _, result = doctor(capsys, "--port", port, "--seconds", "0.2")
    assert_findings(
        result,
        [
            ("latency_timer", "ok", "1 ms"),
            ("name", "ok", "is built in"),
            ("baud", "ok", "any baud rate works"),
            ("line_budget", "ok", "this port has no such limit"),
        ],
    )


@pytest.mark.parametrize(
    ("rate_hz", "severity", "says"),
    [(800, "error", "The line uses 1"), (400, "note", "are 70% of 115200 baud: little is left.")],
)
def test_how_full_the_line_is(
    port: Path,
    tmp_path: Path,
    adapter: Adapter,
    capsys: pytest.CaptureFixture[str],
    rate_hz: int,
    severity: str,
    says: str,
) -> None:
    (tmp_path / "rig.yaml").write_text(RIG % rate_hz)
    with device(port, "--speed", "4", "--profile", "rest", "--rig", tmp_path / "rig.yaml"):
        adapter(port, "ch341-uart")
        status, result = doctor(capsys, "--port", port, "--seconds", "0.5")
    assert_findings(result, [("line_budget", severity, says)])
    assert_findings(result, [("line_budget", severity, "Set "), ("line_budget", severity, "or send at most 48")])
    assert status == (3 if severity == "error" else 0)


def test_a_port_that_another_program_holds(port: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with running_device(port, "--profile", "rest"), Command("serve", "--port", port) as serve:
        serve.take_lines(3)
        status, result = doctor(capsys, "--port", port)
        assert status == 3
        assert_findings(
            result, [("holder", "error", f"(pid {serve.process.pid})"), ("holder", "error", "Stop that program first.")]
        )
        serve.take_lines(3)


def test_a_port_that_this_user_may_not_open(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The system's refusal is played, since tests may run as root; the group is that of the port."""

    def refuse(*_: object, **__: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(serial, "Serial", refuse)
    monkeypatch.setattr(os, "geteuid", lambda: 1000)
    monkeypatch.setattr(os, "getegid", lambda: 1000)
    monkeypatch.setattr(os, "getgroups", list)
    monkeypatch.setattr(pwd, "getpwuid", lambda number: SimpleNamespace(pw_name="ada", pw_gid=number))
    with speaking_on(tmp_path / "gyro") as speaker:
        os.chown(speaker.slave_name, -1, 4321)
        Path(speaker.slave_name).chmod(0o660)
        status, result = doctor(capsys, "--port", tmp_path / "gyro")
    assert status == 3
    assert_findings(
        result, [("permission", "error", "No permission to open it."), ("permission", "error", "--group-add 4321")]
    )
    assert set(result) <= {"port", "permission", "adapter"}


def test_a_port_that_is_not_there(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    status, result = doctor(capsys, "--port", tmp_path / "gyro")
    assert status == 3
    assert_findings(result, [("port", "error", "There is no such port.")])
    assert list(result) == ["port"]


@pytest.mark.parametrize("count", [0, 2])
def test_without_a_port_it_is_looked_for(
    tmp_path: Path, plugged_in: Callable[..., None], capsys: pytest.CaptureFixture[str], count: int
) -> None:
    ports = [tmp_path / f"silent-{number}" for number in range(2)]
    plugged_in(*ports[:count])
    with speaking_on(ports[0]), speaking_on(ports[1]):
        status, result = doctor(capsys, "--timeout", "0.5")
    assert status == 3
    says = "No gyro found." if count else "No serial port is plugged in."
    assert_findings(result, [("port", "error", says)])
    assert all(str(name) in result["port"]["do"] for name in ports[:count])


def test_of_several_ports_that_of_the_gyro_is_taken(
    port: Path, tmp_path: Path, plugged_in: Callable[..., None], capsys: pytest.CaptureFixture[str]
) -> None:
    plugged_in(port, tmp_path / "gone")
    with running_device(port, "--profile", "rest"):
        status, result = doctor(capsys, "--seconds", "0.2")
    assert status == 0
    assert_findings(result, [("protocol", "ok", "It sends native"), ("restarts", "ok", "")])


def test_the_one_port_there_is_is_taken(
    port: Path, plugged_in: Callable[..., None], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    plugged_in(port)
    monkeypatch.setattr(port_holder, "LOCKS", Path("/nowhere"))
    with device(port, *FAST, "--profile", "rest"):
        status, result = doctor(capsys, "--seconds", SECONDS)
    assert status == 0
    assert_findings(
        result, [("protocol", "ok", "It sends native, device firmware_sim."), ("bias", "ok", "The bias is +0.3")]
    )


def test_a_recording_that_is_followed_is_no_port(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A file with the name of a source has no line, and no adapter."""
    path = tmp_path / "live.mcap"
    with path.open("wb") as file:
        writer = McapWriter(file, {"device": {}})
        for number in range(500):
            writer.add(Sample(number, 0.01 * number, 1e9 + 0.01 * number, 0.5 + 0.1 * (number % 2)))
        writer.flush()
        writer.finish()
    status, result = doctor(capsys, "--port", path)
    assert status == 0
    assert_findings(result, [("sample_rate", "ok", "100 samples per second"), ("damage", "ok", "No frame")])
    assert "driver" not in result
