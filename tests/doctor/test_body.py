"""Two gyros on one body: which of them drifts, live and in recordings."""

import json
import math
import random
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from support import free_port

from gyrodrift.cli import main
from gyrodrift.doctor.body import compare
from gyrodrift.doctor.evidence import DeviceEvidence
from gyrodrift.doctor.finding import DeviceFinding
from gyrodrift.facts.session_facts import SessionFacts
from gyrodrift.session.files import write_session
from gyrodrift.session.session import Session

SECONDS = 60.0


def gyro(
    name: str, bias_dps: float, walk_dps: float = 0.0, turn_dps: float = 0.0, scale: float = 1.0, late_s: float = 0.0
) -> DeviceEvidence:
    """A gyro at 100 Hz whose bias moves by `walk_dps`, on a body that turns in the middle third."""
    noise = np.random.default_rng(len(name))
    t_s = np.arange(0.0, SECONDS, 0.01)
    turning = np.where((t_s > 20.0) & (t_s < 40.0), turn_dps * np.sin(t_s), 0.0)
    rate_dps = bias_dps + walk_dps * t_s / SECONDS + scale * turning + noise.normal(0.0, 0.05, len(t_s))
    return DeviceEvidence(name, facts=SessionFacts(Session(name, t_s, rate_dps, t_host_s=1e9 + t_s + late_s)))


def findings(first: DeviceEvidence, second: DeviceEvidence) -> dict[str, DeviceFinding]:
    return {finding.id: finding for finding in compare(first, second)}


def test_the_gyro_whose_bias_moves_is_named() -> None:
    drift = findings(gyro("left", 0.5, walk_dps=0.2), gyro("right", -0.3))["body_drift"]
    assert drift.says.startswith("left drifts: at rest left moved by +0.13")
    assert drift.severity == "warning"
    drift = findings(gyro("left", 0.5), gyro("right", -0.3, walk_dps=-0.2))["body_drift"]
    assert drift.says.startswith("right drifts")
    assert drift.value == pytest.approx(-0.13, abs=0.02)


def test_two_good_gyros_agree() -> None:
    by_id = findings(gyro("left", 0.5, turn_dps=40.0), gyro("right", -0.3, turn_dps=40.0, late_s=0.02))
    assert {finding.severity for finding in by_id.values()} == {"ok"}
    assert "They turn together" in by_id["body_turns"].says


def test_a_common_drift_names_neither() -> None:
    drift = findings(gyro("left", 0.5, walk_dps=0.3), gyro("right", -0.3, walk_dps=0.15))["body_drift"]
    assert drift.says.startswith("Both drift, or the body turned slowly")


@pytest.mark.parametrize(("scale", "expected"), [(-1.0, "turns the other way"), (0.5, "reads 0.50")])
def test_a_wrong_sign_or_scale_is_said(scale: float, expected: str) -> None:
    turns = findings(gyro("left", 0.5, turn_dps=40.0), gyro("right", -0.3, turn_dps=40.0, scale=scale))["body_turns"]
    assert expected in turns.says
    assert turns.severity == "warning"


def test_gyros_that_do_not_turn_together_are_not_on_one_body() -> None:
    turns = findings(gyro("left", 0.5, turn_dps=40.0), gyro("right", -0.3))["body_turns"]
    assert "do not turn together" in turns.says


def test_without_rest_nothing_is_claimed() -> None:
    t_s = np.arange(0.0, SECONDS, 0.01)
    evidence = [
        DeviceEvidence(name, facts=SessionFacts(Session(name, t_s, 50.0 * np.sin(phase * t_s), t_host_s=1e9 + t_s)))
        for name, phase in (("left", 1.0), ("right", 1.0))
    ]
    assert "did not rest at the beginning and at the end" in findings(*evidence)["body_drift"].says


def test_recordings_of_other_times_have_nothing_to_compare() -> None:
    drift = findings(gyro("left", 0.5), gyro("right", -0.3, late_s=1000.0))["body_drift"]
    assert "no time in common" in drift.says


def test_the_command_compares_recordings(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for evidence in (gyro("left", 0.5, walk_dps=0.2), gyro("right", -0.3)):
        assert evidence.facts is not None
        write_session(tmp_path / f"{evidence.source}.csv", [evidence.facts.session])
    main(["doctor", str(tmp_path / "left.csv"), str(tmp_path / "right.csv"), "--one-body", "--json"])
    *_, last = map(json.loads, capsys.readouterr().out.splitlines())
    assert [finding["id"] for finding in last["findings"]] == ["body_drift"]
    assert "left.csv drifts" in last["findings"][0]["says"]


def test_one_recording_is_not_enough(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    evidence = gyro("left", 0.5)
    assert evidence.facts is not None
    write_session(tmp_path / "left.csv", [evidence.facts.session])
    assert main(["doctor", str(tmp_path / "left.csv"), "--one-body"]) == 2
    assert "--one-body: needs two gyros" in capsys.readouterr().err


@contextmanager
def sending(number: int, walk_dps_s: float) -> Iterator[None]:
    """A gyro at rest whose bias moves."""
    is_over, noise = threading.Event(), random.Random(number)

    def send() -> None:
        begun_s = time.monotonic()
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as device:
            while not is_over.wait(0.01):
                t_s = time.monotonic() - begun_s
                line = f"{math.floor(t_s * 1e6)},{noise.gauss(0.2 + walk_dps_s * t_s, 0.03):.4f}\n"
                device.sendto(line.encode(), ("127.0.0.1", number))

    thread = threading.Thread(target=send)
    thread.start()
    try:
        yield
    finally:
        is_over.set()
        thread.join()


@pytest.mark.long
def test_two_gyros_are_compared_live(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    first, second = free_port(), free_port()
    config = tmp_path / "gyros.yaml"
    config.write_text(f"sources:\n  left: {{port: 'udp://:{first}'}}\n  right: {{port: 'udp://:{second}'}}\n")
    with sending(first, 0.0), sending(second, 0.03):
        main(["doctor", "--config", str(config), "--seconds", "18", "--one-body", "--json", "--quiet"])
    first_gyro, second_gyro, pair = map(json.loads, capsys.readouterr().out.splitlines())
    assert (first_gyro["source"], second_gyro["source"], pair["source"]) == ("left", "right", "left and right")
    assert pair["findings"][0]["says"].startswith("right drifts")
