"""`serve` on a device of three axes, through a pty and the native protocol."""

import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
import structlog
from hand_motion import BIAS_DPS, HandMotion, hand_motion
from support import Command

from gyrodrift.link.protocols.decoder import DeviceDescription
from gyrodrift.service.pipeline import Pipeline
from gyrodrift.session.files import load_session
from gyrodrift.values.sample import Inertial, Sample


@pytest.fixture(scope="module")
def motion() -> HandMotion:
    return hand_motion(40.0, tilt_deg=20.0, yaw_deg=20.0, bias_dps=BIAS_DPS)


@pytest.fixture(scope="module")
def short() -> HandMotion:
    """For what does not depend on how good the heading is."""
    return hand_motion(12.0, tilt_deg=20.0, yaw_deg=20.0, bias_dps=BIAS_DPS)


report = tuple[list[dict[str, Any]], list[dict[str, Any]]]
"""JSON lines and log events."""


def served(folder: Path, motion: HandMotion, *words: str | Path) -> report:
    link, session = folder / "gyro", motion.write(folder / "motion.csv")
    link.unlink(missing_ok=True)  # of an earlier run
    with Command("replay", session, "--protocol", "native", "--link", link, "--speed", "max") as replay:
        replay.until(lambda _: link.is_symlink(), "port")
        with Command("serve", "--port", link, "--log-format", "json", *words) as serve:
            lines = serve.take_lines(len(motion.t_s))
            serve.stop()
            return lines, [json.loads(line) for line in serve.log.splitlines()]


@pytest.fixture(scope="module")
def plain(tmp_path_factory: pytest.TempPathFactory, motion: HandMotion) -> report:
    return served(tmp_path_factory.mktemp("plain"), motion)


def test_json_lines_have_the_attitude_and_a_heading_that_follows_the_tilted_turn(
    plain: report, motion: HandMotion
) -> None:
    lines, events = plain
    yaw_deg = np.array([line["yaw_deg"] for line in lines])
    expected_deg = np.interp([line["t_s"] for line in lines], motion.t_s, motion.heading_deg)
    assert np.abs(yaw_deg - expected_deg).max() < 3.0
    last = lines[-1]
    w, _, _, z = last["q"]
    assert np.rad2deg(2.0 * np.arctan2(z, w)) == pytest.approx(last["yaw_deg"], abs=0.01)
    assert last["bias_xyz_dps"] == pytest.approx(BIAS_DPS, abs=0.1)
    assert {"tilt_deg", "roll_deg", "pitch_deg", "tilt_sigma_deg"} <= last.keys()
    assert [event["filter"] for event in events if event["event"] == "three_axes"] == ["restlevel"]


def test_axes_1_keeps_the_rate_about_z(tmp_path: Path, short: HandMotion) -> None:
    lines, events = served(tmp_path, short, "--axes", "1")
    assert "q" not in lines[-1]
    assert lines[-1]["corrected_dps"] == pytest.approx(lines[-1]["rate_dps"] - lines[-1]["bias_dps"], abs=2e-5)
    assert "three_axes" not in {event["event"] for event in events}


def test_a_mount_turns_the_attitude_into_roll_and_pitch_of_the_device(
    tmp_path: Path, motion: HandMotion, plain: report
) -> None:
    config = tmp_path / "mount.yaml"
    config.write_text("filter: restlevel\nmount: {up: +z, forward: +y}\n")
    mounted, _ = served(tmp_path, motion, "--config", config)
    by_time = {line["t_s"]: line for line in plain[0] if "q" in line}
    line = mounted[-1]
    small = by_time[line["t_s"]]
    assert line["q"] == pytest.approx(small["q"], abs=1e-3)
    assert line["tilt_deg"] == pytest.approx(small["tilt_deg"], abs=0.05)
    assert line["roll_deg"] != pytest.approx(small["roll_deg"], abs=0.5)
    up = _rotated_z(line["q"])
    assert np.sin(np.deg2rad(line["pitch_deg"])) == pytest.approx(-up[1], abs=0.01)


def test_a_board_on_its_side_is_told_with_the_axis_that_points_up(
    tmp_path: Path, short: HandMotion, plain: report
) -> None:
    """Turned by 90° about x, it feels gravity along y."""
    columns = short.gyro_dps[:, [0, 2, 1]] * (1.0, 1.0, -1.0), short.accel_mps2[:, [0, 2, 1]] * (1.0, 1.0, -1.0)
    config = tmp_path / "mount.yaml"
    config.write_text("filter: restlevel\nmount: {up: +y, forward: +x}\n")
    sideways = HandMotion(short.t_s, *columns, short.heading_deg)
    _, events = served(tmp_path, sideways)
    (warning,) = (event for event in events if event["event"] == "mount_differs")
    assert "up: +y" in warning["hint"]
    _, events = served(tmp_path, sideways, "--config", config)
    assert "mount_differs" not in {event["event"] for event in (*events, *plain[1])}


def test_the_axis_that_points_up_is_that_of_the_first_sample() -> None:
    """A busy service takes seconds of samples at once, in which the device may have turned on."""
    link = SimpleNamespace(device=DeviceDescription(), name="")
    for forces_mps2, up in ((((0.0, 9.8, 0.0), (0.0, 0.0, 9.8)), "+y"), (((0.0, 0.0, 9.8), (0.0, 9.8, 0.0)), "")):
        pipeline = Pipeline(cast("Any", link), [], structlog.get_logger())
        samples = [
            Sample(n, n / 100.0, n / 100.0, 0.0, inertial=Inertial(0.0, 0.0, 0.0, *forces_mps2[n >= 20]))
            for n in range(300)
        ]
        with structlog.testing.capture_logs() as events:
            pipeline.take(samples)
        hints = [event["hint"] for event in events if event["event"] == "mount_differs"]
        assert len(hints) == (1 if up else 0)
        assert all(f"up: {up}" in hint for hint in hints)


def test_axes_3_on_a_device_of_one_axis_is_told_once(tmp_path: Path) -> None:
    link = tmp_path / "gyro"
    with Command("simulated-device", "--link", link, "--speed", "max") as device:
        device.until(lambda _: link.is_symlink(), "port")
        with Command("serve", "--port", link, "--log-format", "json", "--axes", "3") as serve:
            lines = serve.take_lines(500)
            serve.stop()
    assert "q" not in lines[-1]
    assert [json.loads(line)["event"] for line in serve.log.splitlines()].count("axes_missing") == 1


def test_the_second_run_begins_with_the_biases_of_the_first_and_so_does_its_recording(tmp_path: Path) -> None:
    memory, folder = tmp_path / "memory.json", tmp_path / "recordings"
    motion = hand_motion(16.0, tilt_deg=20.0, yaw_deg=20.0, bias_dps=BIAS_DPS)
    _, events = served(tmp_path, hand_motion(13.0, tilt_deg=0.0, yaw_deg=0.0, bias_dps=BIAS_DPS), "--memory", memory)
    assert [event["event"] for event in events if "memory" in event["event"]] == ["memory_new"]
    knowledge = json.loads(memory.read_text())["knowledge"]
    remembered_dps = (knowledge["x"]["bias_dps"], knowledge["y"]["bias_dps"], knowledge["bias_dps"])
    assert remembered_dps == pytest.approx(BIAS_DPS, abs=0.02)
    moving = HandMotion(
        *(column[600:] for column in (motion.t_s, motion.gyro_dps, motion.accel_mps2, motion.heading_deg))
    )
    lines, events = served(tmp_path, moving, "--memory", memory, "--record", folder)
    assert [event["event"] for event in events if "memory" in event["event"]] == ["memory_used"]
    assert lines[0]["bias_xyz_dps"] == pytest.approx(BIAS_DPS, abs=0.05)
    (recording,) = folder.glob("*.mcap")
    with Command("filter", recording) as filtered:
        assert filtered.end() == 0
    header, *rows = (row.split(",") for row in filtered.out.splitlines())
    assert [float(rows[n][header.index("bias_z_dps")]) for n in (0, -1)] == pytest.approx(
        [lines[n]["bias_xyz_dps"][2] for n in (0, -1)], abs=1e-4
    )


def test_a_memory_of_one_axis_starts_empty_on_three(tmp_path: Path, short: HandMotion) -> None:
    memory = tmp_path / "memory.json"
    still = hand_motion(13.0, tilt_deg=0.0, yaw_deg=0.0, bias_dps=BIAS_DPS)
    served(tmp_path, still, "--memory", memory, "--axes", "1")
    assert "x" not in {key for key, value in json.loads(memory.read_text())["knowledge"].items() if value}
    _, events = served(tmp_path, short, "--memory", memory)
    (event,) = (event for event in events if "memory" in event["event"])
    assert (event["event"], event["reason"]) == ("memory_new", "it is of one axis, and the device sends three")


def test_a_recording_has_all_axes(tmp_path: Path, motion: HandMotion) -> None:
    folder = tmp_path / "recordings"
    served(tmp_path, motion, "--record", folder)
    (recording,) = folder.glob("*.mcap")
    session = load_session(recording)
    assert session.accel_mps2 is not None
    assert session.accel_mps2.shape == (len(motion.t_s), 3)
    with Command("filter", recording) as filtered:
        assert filtered.end() == 0
    header, *rows = (row.split(",") for row in filtered.out.splitlines())
    assert float(rows[-1][header.index("yaw_deg")]) == pytest.approx(motion.heading_deg[-1], abs=3.0)
    assert {"q_w", "tilt_deg", "bias_z_dps"} <= set(header)


def _rotated_z(q: list[float]) -> tuple[float, float, float]:
    """Heights of the axes of the sensor in the earth frame."""
    w, x, y, z = q
    return 2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)
