"""Findings of `doctor` about the yaw of the device's own filter."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from doctor_support import SECONDS, assert_findings, device, doctor

from firmware_sim.motion.profile import load_motion
from firmware_sim.rig import Base, Rig, with_own_yaw
from gyrodrift.session.files import write_session
from gyrodrift.session.session import Session
from gyrodrift.simulation.sessions import Simulation


@cache
def simulated(own_yaw: str | None) -> Session:
    """A turntable for two minutes, with a bias of 0.3 deg/s."""
    rig = with_own_yaw(Rig(base=Base(bias_dps=0.3)), own_yaw)
    return Simulation(rig, load_motion("turntable"), 1, minutes=2.0).whole()


def recorded(folder: Path, session: Session, **device: str) -> Path:
    path = folder / "own.mcap"
    write_session(path, [session], {"device": device} if device else None)
    return path


def test_the_same_filter_agrees(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The name of the filter is in the sentence."""
    _, findings = doctor(capsys, recorded(tmp_path, simulated("restlevel"), device_filter="restlevel"))
    assert_findings(findings, [("device_yaw", "ok", "(restlevel) agrees with restlevel here")])


def test_a_filter_that_drifts_is_told_with_time_and_advice(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """HDR has learned little of 0.3 deg/s after two minutes."""
    _, findings = doctor(capsys, recorded(tmp_path, simulated("hdr")))
    assert_findings(
        findings, [("device_yaw", "warning", "deg apart at"), ("device_yaw", "warning", "gyrodrift compare")]
    )
    assert abs(findings["device_yaw"]["value"]) > 1.0


@pytest.mark.parametrize(("factor", "words"), [(-1.0, "counts clockwise"), (np.pi / 180.0, "in radians")])
def test_a_wrong_sign_or_unit_is_an_error(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], factor: float, words: str
) -> None:
    session = simulated("restlevel")
    changed = replace(session, device_yaw_deg=session.filled("device_yaw_deg") * factor)
    status, findings = doctor(capsys, recorded(tmp_path, changed))
    assert status == 3
    assert_findings(findings, [("device_yaw", "error", words)])


def test_a_yaw_that_begins_elsewhere_and_comes_rarely_agrees(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The device was on before; only samples with a result are compared."""
    session = simulated("restlevel")
    is_sent = np.arange(len(session.rate_dps)) % 10 == 3
    sparse = np.where(is_sent, session.filled("device_yaw_deg") + 720.5, np.nan)
    _, findings = doctor(capsys, recorded(tmp_path, replace(session, device_yaw_deg=sparse)))
    assert_findings(findings, [("device_yaw", "ok", "agrees")])


def test_a_device_without_a_filter_has_no_finding(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    _, findings = doctor(capsys, recorded(tmp_path, simulated(None)))
    assert "device_yaw" not in findings


def test_it_is_found_at_a_port(port: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with device(port, "--own-yaw", "restlevel", "--speed", "5", "--profile", "turntable"):
        _, findings = doctor(capsys, "--port", port, "--seconds", SECONDS)
    assert_findings(findings, [("device_yaw", "ok", "(restlevel) agrees")])
