"""`gyrodrift install-service`, and the service under what stands for systemd: a notify socket of the test."""

import os
import shutil
import socket
import subprocess
from pathlib import Path

import pytest
from outputs_support import csv_at_100_hz
from support import PATIENCE_S, Command, never, speaking_on

from gyrodrift.service.install import UsbIdentity, files, usb_identity
from gyrodrift.service.notify import SystemdNotify

MOST_EXPOSED = 2.0


def dry_run(*options: str | Path) -> tuple[int, str, str]:
    with Command("install-service", "--dry-run", *options) as command:
        return command.end(), command.out, command.log


@pytest.fixture
def unit(tmp_path: Path) -> Path:
    """The unit that would be installed."""
    status, out, log = dry_run("--port", "/dev/ttyAMA0", "--output", "tcp:port=7000")
    assert (status, log) == (0, "")
    path = tmp_path / "gyrodrift.service"
    path.write_text(out)
    return path


def test_the_unit_says_what_is_run(unit: Path) -> None:
    text = unit.read_text()
    assert text.startswith("# /etc/systemd/system/gyrodrift.service\n")
    assert (
        " -m gyrodrift serve --port /dev/ttyAMA0 --timeout 0 --log-format text --output tcp:port=7000 --control "
        in text
    )
    assert "Type=notify" in text
    assert text.rstrip().endswith("# run: systemctl enable --now gyrodrift.service")
    assert "udev/rules.d" not in text


@pytest.mark.skipif(shutil.which("systemd-analyze") is None, reason="systemd-analyze is not installed")
def test_systemd_takes_the_unit_and_finds_it_little_exposed(unit: Path) -> None:
    verified = subprocess.run(["systemd-analyze", "verify", unit], capture_output=True, text=True, check=False)
    assert (verified.returncode, verified.stderr) == (0, "")
    command = ["systemd-analyze", "security", "--offline=yes", "--no-pager", str(unit)]
    security = subprocess.run(command, capture_output=True, text=True, check=False)
    if "Overall exposure level" not in security.stdout:
        pytest.skip("this systemd-analyze does not judge units that are not loaded")
    assert float(security.stdout.rsplit(": ", 1)[1].split()[0]) < MOST_EXPOSED


@pytest.mark.skipif(shutil.which("systemd-analyze") is None, reason="systemd-analyze is not installed")
@pytest.mark.parametrize(
    ("port", "line"),
    [
        ("iio:mpu6050?rate=200", "DeviceAllow=char-iio rw"),
        ("can:can0?gyro=xsens", "RestrictAddressFamilies=AF_CAN"),
        ("mqtt://broker/gyro", "RestrictAddressFamilies=AF_UNIX AF_INET AF_INET6"),
    ],
)
def test_a_source_gets_what_it_needs(port: str, line: str, tmp_path: Path) -> None:
    status, out, log = dry_run("--port", port)
    assert (status, log) == (0, "")
    assert line in out.splitlines()
    assert port.partition("?")[0] in out
    path = tmp_path / "gyrodrift.service"
    path.write_text(out)
    verified = subprocess.run(["systemd-analyze", "verify", path], capture_output=True, text=True, check=False)
    assert (verified.returncode, verified.stderr) == (0, "")


def test_a_source_on_an_adapter_keeps_its_address(tmp_path: Path) -> None:
    """The name /dev/gyro would lose the protocol."""
    device = tmp_path / "ttyACM0" / "device"
    device.mkdir(parents=True)
    (device / "idVendor").write_text("2dae")
    assert usb_identity("mavlink:/dev/ttyACM0", tmp_path) is None


def test_an_adapter_gets_a_name_and_starts_the_service(tmp_path: Path) -> None:
    adapter = tmp_path / "usb1" / "1-2"
    tty = adapter / "1-2:1.0" / "ttyUSB7"
    tty.mkdir(parents=True)
    for name, value in {"idVendor": "1a86", "idProduct": "7523", "serial": "A5"}.items():
        (adapter / name).write_text(f"{value}\n")
    (tmp_path / "class" / "ttyUSB7").mkdir(parents=True)
    (tmp_path / "class" / "ttyUSB7" / "device").symlink_to(tty)
    usb = usb_identity("/dev/ttyUSB7", tmp_path / "class")
    assert usb == UsbIdentity("1a86", "7523", "A5")
    unit, rule = files("/dev/ttyUSB7", None, [], usb).values()
    assert "--port /dev/gyro " in unit
    assert 'ATTRS{idVendor}=="1a86", ATTRS{idProduct}=="7523", ATTRS{serial}=="A5", SYMLINK+="gyro"' in rule
    assert usb_identity("/dev/ttyAMA0", tmp_path / "class") is None


def test_mistakes_are_found_before_anything_is_written(tmp_path: Path) -> None:
    status, _, log = dry_run("--port", "/dev/ttyUSB0", "--output", "tpc")
    assert (status, log) == (2, "gyrodrift: --output tpc: 'tpc' (text) is not an output; did you mean tcp?\n")
    status, _, log = dry_run("--port", "/dev/ttyUSB0", "--config", tmp_path / "none.yaml")
    assert status == 2
    assert "none.yaml:1:1 cannot be read" in log


def test_systemd_is_told_that_it_is_ready_and_alive_and_ends(port: Path, tmp_path: Path) -> None:
    path = tmp_path / "notify"
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as manager, speaking_on(port) as device:
        manager.bind(str(path))
        manager.settimeout(PATIENCE_S)
        os.environ |= {"NOTIFY_SOCKET": str(path), "WATCHDOG_USEC": "1000000"}
        try:
            serve = Command("serve", "--port", port, "--output", "tcp:port=0")
        finally:
            del os.environ["NOTIFY_SOCKET"], os.environ["WATCHDOG_USEC"]
        with serve:
            device.wait_for_reader(never)
            assert manager.recv(1000) == b"READY=1\nSTATUS=reading " + bytes(port)
            device.send_all(csv_at_100_hz(10), never)
            assert {manager.recv(1000) for _ in range(3)} == {b"WATCHDOG=1"}
            assert serve.stop() == 0
        manager.setblocking(False)
        statement = [b""]
        while statement[-1] != b"STOPPING=1":
            statement.append(manager.recv(1000))


def test_without_systemd_nothing_is_said() -> None:
    """Nor with the variables of another process."""
    report = SystemdNotify({})
    report.ready("")
    report.alive(0.0)
    report.stopping()
    environ = {"WATCHDOG_PID": "1", "WATCHDOG_USEC": "1000"}
    assert SystemdNotify(environ)._every_s == float("inf")
    assert environ == {}


def test_a_password_does_not_go_into_the_unit() -> None:
    """Every user of the machine may read it; the message does not show it either."""
    status, out, log = dry_run("--port", "/dev/ttyUSB0", "--output", "mqtt:user=ann,password=marker")
    assert (status, out) == (2, "")
    assert log.endswith("every user may read the unit: give password in a file, as password_file\n")
    assert "marker" not in log
