"""`gyrodrift simulate --axes 3`: sessions with all axes, the same as the device plays, and the truth beside them."""

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from support import Command, are_recorded

from firmware_sim.motion.profile import config_folder
from gyrodrift.cli import main
from gyrodrift.session.files import load_session
from gyrodrift.session.mcap.read import read_mcap

RIG = ("--rig", str(config_folder() / "rig-three-axes.yaml"))
HAND = (*RIG, "--profile", "hand", "--seed", "5")
SAMPLES = 1200


def simulated(folder: Path, *options: str) -> Path:
    assert main(["simulate", "--out", str(folder), "--minutes", "0.2", *options]) == 0
    return folder / "session-01.mcap"


def test_a_session_is_what_the_played_device_sends_through_a_recording(tmp_path: Path) -> None:
    """Rates and accelerations bit for bit, over the native protocol and a serial port."""
    effects = ("--effect", "accel_dropout:from_s=3,to_s=5", "--effect", "motor_vibration")
    session = load_session(simulated(tmp_path / "s", *HAND, *effects))
    port, out = tmp_path / "gyro", tmp_path / "recorded"
    played = (*HAND, *effects, "--wait", "--speed", "max", "--duration", "11.999")
    with Command("--link", port, *played, module="firmware_sim") as device:
        device.until_log("native on")
        with Command("record", "--port", port, "--out", out) as record:
            record.until(lambda _: are_recorded(SAMPLES - 10, out), "samples on disk")
            record.stop()
    (recorded,) = (read_mcap(path) for path in out.glob("*.mcap"))
    count = len(recorded.rate_dps)
    assert count > SAMPLES - 20
    for name in ("seq", "rate_dps", "gyro_dps", "accel_mps2", "encoder_deg"):
        assert np.array_equal(getattr(recorded, name), getattr(session, name)[:count], equal_nan=True), name
    assert session.accel_mps2 is not None
    assert np.flatnonzero(np.isnan(session.accel_mps2[:, 0])).tolist() == list(range(300, 500))


def test_both_formats_have_all_axes(tmp_path: Path) -> None:
    """The rate is that about z."""
    binary = load_session(simulated(tmp_path / "a", *HAND))
    text = load_session(simulated(tmp_path / "b", *HAND, "--format", "csv").with_suffix(".csv"))
    for name in ("rate_dps", "gyro_dps", "accel_mps2"):
        assert np.array_equal(getattr(text, name), getattr(binary, name)), name
    assert binary.gyro_dps is not None
    assert np.array_equal(binary.gyro_dps[:, 2], binary.rate_dps)


def test_the_truth_is_written_with_the_session(tmp_path: Path) -> None:
    path = simulated(tmp_path, "--axes", "3", "--profile", "arm")
    session, truth = load_session(path), np.load(path.with_suffix(".truth.npz"))
    assert session.encoder_deg is not None
    assert session.accel_mps2 is not None
    assert truth["seq"].tolist() == list(range(SAMPLES))
    assert truth["t_s"] == pytest.approx(session.t_device_s)
    w, x, y, z = truth["quaternion"].T
    twist_deg = np.degrees(np.unwrap(2.0 * np.arctan2(z, w), period=2.0 * np.pi))
    assert np.abs(twist_deg - session.encoder_deg).max() < 0.02
    up = Rotation.from_quat(np.stack([x, y, z, w], axis=1)).inv().apply([0.0, 0.0, 9.80665])
    still = np.flatnonzero(np.abs(session.rate_dps - np.median(session.rate_dps[:400])) < 0.2)
    assert np.abs((session.accel_mps2 - up)[still[still < 450]].mean(axis=0)).max() < 0.01


def test_one_axis_on_a_tilted_motion_has_neither_axes_nor_truth(tmp_path: Path) -> None:
    path = simulated(tmp_path, "--profile", "tilted-turntable", "--minutes", "0.35")
    session = load_session(path)
    assert session.gyro_dps is None
    assert session.encoder_deg is not None
    assert [file.name for file in sorted(tmp_path.iterdir())] == ["rig.yaml", "session-01.mcap"]
    table_deg = session.encoder_deg[-1] - session.encoder_deg[0]
    read_deg = np.sum(session.rate_dps - np.mean(session.rate_dps[:900])) / 100.0
    assert read_deg / table_deg == pytest.approx(np.cos(np.radians(20.0)), abs=0.003)


def test_the_written_rig_gives_the_sessions_again(tmp_path: Path) -> None:
    first = simulated(tmp_path / "a", "--axes", "3", "--profile", "drone", "--effect", "gyro_misalignment")
    second = simulated(tmp_path / "b", "--rig", str(first.parent / "rig.yaml"), "--profile", "drone")
    for ending in (".mcap", ".truth.npz"):
        assert first.with_suffix(ending).read_bytes() == second.with_suffix(ending).read_bytes()


@pytest.mark.parametrize(
    ("options", "problem"),
    [
        (("--effect", "accel_bias"), "--effect accel_bias: needs a rig with three axes; add --axes 3"),
        (("--axes", "2"), "--axes 2: there are 1, 3"),
        (("--axes", "3", "--twin", "t.csv"), "--twin imitates sessions of one axis: leave out --axes 3"),
        (("--axes", "3", "--effect", "accel_bias:x=1"), "x is not known here"),
    ],
)
def test_wrong_requests_are_told(
    options: tuple[str, ...], problem: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["simulate", "--out", str(tmp_path / "s"), *options]) == 2
    assert problem in capsys.readouterr().err
