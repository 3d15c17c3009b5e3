"""`doctor --report`: one file with device, versions, ten seconds of data and checks, without secrets."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from gyrodrift import __version__
from gyrodrift.cli import main
from gyrodrift.doctor.evidence import DeviceEvidence
from gyrodrift.doctor.finding import error
from gyrodrift.doctor.port import PortEvidence
from gyrodrift.doctor.report import DATA_S, report
from gyrodrift.link.serial_port import SerialPort


def write_session(path: Path) -> Path:
    rows = "".join(f"{n / 50},{0.5 + 0.01 * (n % 3)}\n" for n in range(50 * 12))
    path.write_text(f"t_device_s,rate_dps\n{rows}")
    return path


def test_a_report_of_a_recording_has_ten_seconds(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    session, file = write_session(tmp_path / "s.csv"), tmp_path / "report.json"
    main(["doctor", str(session), "--report", str(file)])
    content = json.loads(file.read_text())
    (device,) = content["devices"]
    assert content["versions"]["gyrodrift"] == __version__
    assert len(device["data"]["t_device_s"]) == pytest.approx(DATA_S * 50, abs=1)
    assert {finding["id"] for finding in device["checks"]["findings"]} >= {"gaps", "noise"}
    assert f"wrote {file}; read it before you send it" in capsys.readouterr().err


def test_a_report_does_not_replace_its_recording(tmp_path: Path) -> None:
    session = write_session(tmp_path / "s.csv")
    before = session.read_text()
    assert main(["doctor", str(session), "--report", str(session)]) == 2
    assert session.read_text() == before


def test_secrets_and_names_of_the_machine_are_left_out() -> None:
    """Passwords in addresses and texts of the device, the folder of the user, and the serial number."""
    port = SerialPort("/dev/serial/by-id/usb-X_A9074XYZ-port0", "/dev/ttyUSB0", serial_number="A9074XYZ")
    evidence = DeviceEvidence("mqtt://ann:hunter2@broker/gyro", raw=b"wifi password=hunter2 begin")
    evidence = replace(evidence, port=PortEvidence(port))
    findings = [error(f"{Path.home()}/s.csv and {port.name} are wrong.", "Repair them.")]
    text = report([(evidence, findings)], [])
    assert [name for name in ("hunter2", "A9074XYZ", str(Path.home())) if name in text] == []
    assert "begin" in text
