"""docs/library.md: each example runs as it is printed there, on a real port and on real files."""

from pathlib import Path
from typing import Any

import pytest
from support import Command, python_in
from turntable_sessions import write_turntables

pytestmark = pytest.mark.xdist_group("restlevel_kernel")  # its compilation takes seconds

NAMES, SAMPLES, THREE_AXES, RECORDING, DEVICE, ANALYSES, SIMULATED = python_in("library.md")


def run(code: str) -> dict[str, Any]:
    """The names that are there afterwards."""
    names: dict[str, Any] = {}
    exec(compile(code, "library.md", "exec"), names)
    return names


def test_the_names_are_there() -> None:
    assert run(NAMES).keys() >= {"Hdr", "Restlevel", "load_session", "open_link", "tune", "diagnose", "compare"}


def test_samples(capsys: pytest.CaptureFixture[str]) -> None:
    run(SAMPLES)
    assert capsys.readouterr().out.endswith("bias 0.50 deg/s\n")


def test_three_axes(capsys: pytest.CaptureFixture[str]) -> None:
    run(THREE_AXES)
    assert capsys.readouterr().out.startswith(("heading 0.0 deg, pitch -20.0 deg", "heading -0.0 deg, pitch -20.0 deg"))


def test_recording(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    write_turntables(tmp_path / "made", 1, minutes=0.5)
    next((tmp_path / "made").iterdir()).rename(tmp_path / "session.csv")
    monkeypatch.chdir(tmp_path)
    run(RECORDING)
    assert "deg after 30.0 s" in capsys.readouterr().out


def test_device(port: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with Command("--link", port, module="firmware_sim") as device:
        device.until(lambda _: port.exists(), "port")
        run(DEVICE.replace("/dev/ttyUSB0", str(port)))
    assert len(capsys.readouterr().out.splitlines()) > 50


def test_analyses(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("numba", reason="tuning needs the workstation extra")
    write_turntables(tmp_path / "sessions", 3, minutes=0.5)
    max((tmp_path / "sessions").iterdir()).rename(tmp_path / "sessions" / "last.csv")
    monkeypatch.chdir(tmp_path)
    run(ANALYSES)
    report = capsys.readouterr().out
    assert report.startswith(("hdr HdrParams(i_c_dps=", "restlevel RestlevelParams(window_s="))
    assert "restlevel: " in report
    assert sorted(path.name for path in tmp_path.iterdir()) == ["sessions"]


def test_simulated(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("matplotlib", reason="plots need the workstation extra")
    monkeypatch.chdir(tmp_path)
    run(SIMULATED)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["session.mcap", "yaw.png"]
