"""`calibrate --positions` on a live port: a simulated board laid on six sides, and `serve` with the result."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from hand_motion import hand_motion
from laid_board import BIAS_DPS, GYRO_GAIN, OFFSET_MPS2, SCALE, SIX_SIDES, WITH_TURNS, BoardRecord, laid_board
from scipy.spatial.transform import Rotation
from support import Command, Terminal, ended_here, near, ours

from gyrodrift.config.model import load_config
from gyrodrift.session.calibrated import calibrated
from gyrodrift.session.files import load_session
from gyrodrift.values.calibration import Calibration

NATIVE, CSV = ("--protocol", "native"), ("--protocol", "csv")
ONE_AXIS = """\
# My boat.
filter: restlevel
calibration:
  date: 2026-01-01
  device_id: firmware_sim
  scale_ccw: 0.98
  bias_dps_per_c: 0.01
"""


@contextmanager
def replayed(record: BoardRecord, folder: Path, *words: str) -> Iterator[Path]:
    """Port that plays a reading of the faulty sensor, as fast as it is read."""
    session, link = record.through_sensor().write(folder / "board.csv"), folder / "gyro"
    with Command("replay", session, "--link", link, "--speed", "max", *words) as replay:
        replay.until(lambda _: link.is_symlink(), "port")
        yield link


def check(result: Calibration) -> None:
    """Check the result against the errors of the sensor."""
    assert result.accel_offset_mps2 == near(OFFSET_MPS2.tolist(), 0.02)
    assert result.accel_scale == near(SCALE.tolist(), 0.002)
    assert [*(result.gyro_bias_xy_dps or ()), result.bias_dps] == near(BIAS_DPS.tolist(), 0.02)


@pytest.mark.parametrize(
    ("words", "device_id"),
    [pytest.param(NATIVE, "firmware_sim", id="native"), pytest.param(CSV, "", id="csv", marks=pytest.mark.evaluation)],
)
def test_turns_and_sides_without_a_terminal_give_json_and_a_config(
    words: tuple[str, ...], device_id: str, tmp_path: Path
) -> None:
    config = tmp_path / "new.yaml"
    with (
        replayed(laid_board(WITH_TURNS, mark_deg=0.2), tmp_path, *words) as port,
        Command("calibrate", "--port", port, "--config", config, "--positions", "--axis-turns", "--json") as calibrate,
    ):
        assert calibrate.end() == 0, calibrate.log
        content = json.loads(calibrate.out)
    assert {position["up"] for position in content["positions"]} == {"+x", "-x", "+y", "-y", "+z", "-z"}
    assert [turn["axis"] for turn in content["turns"]] == ["z", "z", "x", "x", "y", "y"]
    np.testing.assert_allclose(content["calibration"]["gyro_matrix"], np.linalg.inv(GYRO_GAIN), atol=0.005)
    result = load_config(config).calibration
    assert result is not None
    check(result)
    assert result.gyro_matrix is not None
    assert result.device_id == device_id


def test_on_a_terminal_each_side_is_told_and_values_of_one_axis_stay(tmp_path: Path) -> None:
    config = tmp_path / "my.yaml"
    config.write_text(ONE_AXIS)
    with replayed(laid_board(SIX_SIDES), tmp_path, *NATIVE) as port:
        command = ours("calibrate", "--port", port, "--config", config, "--positions", "--force")
        with Terminal(*command, streams=("stderr",), rows=60, columns=160) as terminal:
            assert terminal.end() == 0
            shown = terminal.text
    assert "Lay the board down on each of its six sides, in any order, and let go for 3 s." in shown
    assert "  +z up: " in shown
    assert "left: -x, +y, -y and -z up" in shown
    assert "  accelerometer offset x +0.3" in shown
    assert config.read_text().startswith("# My boat.\nfilter: restlevel\ncalibration:\n")
    result = load_config(config).calibration
    assert result is not None
    check(result)
    assert (result.scale_ccw, result.bias_dps_per_c, result.gyro_matrix) == (0.98, 0.01, None)


def test_serve_gives_true_rates_and_accelerations(tmp_path: Path) -> None:
    config, sessions = tmp_path / "my.yaml", tmp_path / "sessions"
    with replayed(laid_board(WITH_TURNS), tmp_path, *NATIVE) as port:
        words = ("calibrate", "--port", port, "--config", config, "--positions", "--axis-turns", "--quiet")
        with Command(*words) as calibrate:
            assert calibrate.end() == 0, calibrate.log
    motion = hand_motion(20.0, tilt_deg=25.0)
    record = BoardRecord(motion.t_s, motion.gyro_dps, motion.accel_mps2, motion.heading_deg)
    with (
        replayed(record, tmp_path, *NATIVE) as port,
        Command("serve", "--port", port, "--config", config, "--record", sessions) as serve,
    ):
        lines = serve.take_lines(len(motion.t_s))
        assert serve.stop() == 0
        assert "event=calibration_applied" in serve.log
    rates_dps = np.array([line["rate_dps"] for line in lines])
    errors_dps = rates_dps - motion.gyro_dps[: len(lines), 2]
    assert np.abs(errors_dps).max() < 0.5
    assert lines[-1]["yaw_deg"] == near(motion.heading_deg[-1], 1.0)
    (path,) = sessions.glob("*.mcap")
    with Command("filter", path, "--quiet") as filtered:
        assert filtered.end() == 0
    header, *rows = (row.split(",") for row in filtered.out.splitlines())
    assert float(rows[-1][header.index("yaw_deg")]) == near(lines[-1]["yaw_deg"], 0.01)
    accel_mps2 = calibrated(load_session(path)).accel_mps2
    assert accel_mps2 is not None
    assert np.abs(accel_mps2.mean(axis=0) - motion.accel_mps2.mean(axis=0)).max() < 0.02


SIMULATED = (
    "accel_bias:x_mps2=0.3,y_mps2=-0.2,z_mps2=0.4",
    "accel_scale:x_percent=2,y_percent=-1,z_percent=1",
    "gyro_scale:x_percent=1,y_percent=-2,z_percent=2",
    "gyro_misalignment:x_deg=1,y_deg=-0.7,z_deg=0.5",
    "gyro_g_sensitivity",
)


def test_the_simulated_device_on_six_sides_is_calibrated(tmp_path: Path) -> None:
    link, config = tmp_path / "gyro", tmp_path / "my.yaml"
    faulty = [word for effect in SIMULATED for word in ("--effect", effect)]
    words = ("--link", link, "--axes", "3", "--profile", "six-sides", "--speed", "max", "--wait")
    with Command(*words, *faulty, module="firmware_sim") as device:
        device.until(lambda _: link.is_symlink(), "pty")
        with Command("calibrate", "--port", link, "--config", config, "--positions", "--axis-turns") as calibrate:
            assert calibrate.end() == 0, calibrate.log
    result = load_config(config).calibration
    assert result is not None
    assert result.accel_offset_mps2 == pytest.approx((0.3, -0.2, 0.4), abs=0.005)
    assert result.accel_scale == pytest.approx((1.0 / 1.02, 1.0 / 0.99, 1.0 / 1.01), abs=0.001)
    alignment = Rotation.from_rotvec([1.0, -0.7, 0.5], degrees=True).as_matrix().T
    gain = np.diag([1.01, 0.98, 1.02]) @ alignment
    assert result.gyro_matrix is not None
    np.testing.assert_allclose(result.gyro_matrix, np.linalg.inv(gain), atol=0.001)


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (("--axis-turns",), "--axis-turns: needs --positions"),
        (("--positions", "--repeats", "4"), "--positions and --repeats: use one of them"),
        (("--positions", "--turns", "3"), "--positions and --turns: use one of them"),
        (("--positions", "--temperature", "5"), "--positions and --temperature: use one of them"),
    ],
)
def test_options_that_do_not_belong_together_are_told(words: tuple[str, ...], reason: str, tmp_path: Path) -> None:
    """Status 2, and no port is opened."""
    calibrate = ended_here("calibrate", "--port", tmp_path / "gyro", *words)
    assert calibrate.status == 2
    assert reason in calibrate.log


def test_a_device_with_one_axis_is_told_what_it_lacks(tmp_path: Path) -> None:
    """Status 4, and the names of the columns."""
    session, link = tmp_path / "one.csv", tmp_path / "gyro"
    session.write_text("t_device_s,rate_dps\n" + "".join(f"{i / 100},{i % 3 / 10}\n" for i in range(500)))
    with Command("replay", session, "--link", link, "--speed", "max") as replay:
        replay.until(lambda _: link.is_symlink(), "port")
        with Command("calibrate", "--port", link, "--positions") as calibrate:
            assert calibrate.end() == 4
            assert "does not send three rates and three accelerations" in calibrate.log
            assert "--columns: gx, gy, gz, ax, ay, az" in calibrate.log
