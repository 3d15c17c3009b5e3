"""The sketch on an Uno in simavr, with a gyro on its I2C and real `serve` at its serial line."""

import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from firmware_support import (
    HEADERS,
    HERE,
    LEONARDO,
    MEGA,
    SKETCH,
    STRICT,
    Board,
    Truth,
    built_sketch,
    changed_sketch,
    run,
    sketch_object,
)
from support import Command, quick

from gyrodrift.session.mcap.read import read_mcap
from gyrodrift.session.session import Session

pytestmark = pytest.mark.xdist_group("firmware")  # it is compiled once

LSM6DSO = ("lsm6dso", "LSM6DSO 250/67", 1000 / 8.75, 1000 / 0.244, 104.0)

MICROSECONDS_APART = 60.0
"""Between the pin and the reading of the clock: other interrupts of the board; reading I2C alone takes 300."""


def heard(board: Board, *extra: str | Path) -> tuple[list[dict[str, Any]], str, dict[str, Any], Truth]:
    """Lines and log of `serve` at a board until its end, and what the board and its gyro say."""
    with board, Command("serve", "--port", board.link, *extra) as serve:
        serve.until(lambda _: board.is_over(), "end of the board")
        result, truth = board.result()
        serve.until(lambda command: "event=link_lost" in command.log, "end of the stream")
        assert serve.stop() == 0
        return serve.all_lines(), serve.log, result, truth


def is_in_time(t_s: Any, truth: Truth) -> bool:
    """Whether the clock of each sample was read at its measurement, but for when the board's clock began."""
    late_us = np.asarray(t_s) * 1e6 - truth.t_us
    return bool(late_us.max() - late_us.min() < MICROSECONDS_APART)


def has_all_axes(session: Session, truth: Truth, counts_per_dps: float, counts_per_g: float) -> bool:
    """Whether rates and accelerations of a recording are the counts of the gyro."""
    if session.gyro_dps is None or session.accel_mps2 is None:
        return False
    count = len(session.gyro_dps)
    rates, accels = session.gyro_dps * counts_per_dps, session.accel_mps2 / 9.80665 * counts_per_g
    has_rates = np.array_equal(np.rint(rates), truth.gyro_raw()[:count])
    return has_rates and np.array_equal(np.rint(accels), truth.accel_raw()[:count])


@pytest.fixture
def link(tmp_path: Path) -> Path:
    return tmp_path / "uno"


def test_no_sample_is_lost_on_the_way_to_serve_and_record(
    board_program: Path, sketch: Path, link: Path, tmp_path: Path
) -> None:
    sessions = tmp_path / "sessions"
    board = Board(board_program, sketch, link, seconds=2)
    lines, log, result, truth = heard(board, "--record", str(sessions))
    assert result["measured"] == len(truth.rate_raw) == len(lines) > 350
    assert [line["seq"] for line in lines] == list(range(1, len(lines) + 1))
    assert [round(line["rate_dps"] * 131) for line in lines] == truth.rate_raw.tolist()
    assert np.abs([line["temp_c"] for line in lines] - truth.temp_c).max() <= 0.01
    assert is_in_time([line["t_s"] for line in lines], truth)
    assert "gaps=0 missing=0" in log.splitlines()[-1]
    (session,) = map(read_mcap, sessions.glob("*.mcap"))
    assert np.rint(session.rate_dps * 131).tolist() == truth.rate_raw.tolist()
    assert has_all_axes(session, truth, 131.0, 4096.0)
    assert is_in_time(session.t_device_s, truth)


@pytest.mark.parametrize(
    ("gyro", "name", "counts_per_dps", "counts_per_g", "accel_low_pass_hz"),
    quick(
        [
            ("mpu6050", "MPU-6050 250/42", 131.0, 4096.0, 44.0),
            LSM6DSO,
            ("icm20948", "ICM-20948 250/51", 131.0, 4096.0, 50.4),
        ],
        LSM6DSO,
    ),
)
def test_hello_states_what_the_gyro_is_set_to(
    board_program: Path,
    sketch: Path,
    link: Path,
    gyro: str,
    name: str,
    counts_per_dps: float,
    counts_per_g: float,
    accel_low_pass_hz: float,
) -> None:
    """Sensor, range, low-pass and rate are those in its registers, and each of its samples comes through."""
    sessions = link.parent / "sessions"
    board = Board(board_program, sketch, link, seconds=2, gyro=gyro)
    lines, log, result, truth = heard(board, "--record", str(sessions))
    assert result["counts_per_g"] == pytest.approx(counts_per_g, rel=1e-5)
    assert result["accel_low_pass_hz"] == accel_low_pass_hz
    (session,) = map(read_mcap, sessions.glob("*.mcap"))
    assert has_all_axes(session, truth, counts_per_dps, counts_per_g)
    assert f'device_id="{name}" sample_rate_hz={result["rate_hz"]:.1f}' in log
    assert name.split()[1] == f"{result['range_dps']:.0f}/{result['low_pass_hz']:.0f}"
    assert [round(line["rate_dps"] * counts_per_dps) for line in lines] == truth.rate_raw.tolist()
    assert np.abs([line["temp_c"] for line in lines] - truth.temp_c).max() <= 0.01
    assert is_in_time([line["t_s"] for line in lines], truth)


def test_another_axis_may_point_up_or_down(board_program: Path, tmp_path: Path) -> None:
    folder = changed_sketch(tmp_path, AXIS="0", IS_UPSIDE_DOWN="true")
    sketch = built_sketch(tmp_path, folder)
    sessions = tmp_path / "sessions"
    board = Board(board_program, sketch, tmp_path / "uno", seconds=1)
    _, _, _, truth = heard(board, "--record", str(sessions))
    (session,) = map(read_mcap, sessions.glob("*.mcap"))
    assert session.gyro_dps is not None
    assert session.accel_mps2 is not None
    x, y, z = truth.gyro_raw().T
    assert np.array_equal(np.rint(session.gyro_dps * 131), np.stack([y, -z, -x], axis=1))
    x, y, z = truth.accel_raw().T
    assert np.array_equal(np.rint(session.accel_mps2 / 9.80665 * 4096), np.stack([y, -z, -x], axis=1))


def test_a_slow_line_takes_the_yaw_rate_alone(board_program: Path, tmp_path: Path) -> None:
    folder = changed_sketch(tmp_path, HAS_ALL_AXES="false", BAUD="57600")
    sketch = built_sketch(tmp_path, folder)
    sessions = tmp_path / "sessions"
    board = Board(board_program, sketch, tmp_path / "uno", seconds=2)
    lines, _, result, truth = heard(board, "--record", str(sessions))
    assert result["measured"] == len(lines) > 350
    assert [round(line["rate_dps"] * 131) for line in lines] == truth.rate_raw.tolist()
    (session,) = map(read_mcap, sessions.glob("*.mcap"))
    assert session.gyro_dps is None


def test_a_clipped_acceleration_is_marked(board_program: Path, sketch: Path, link: Path, tmp_path: Path) -> None:
    sessions = tmp_path / "sessions"
    board = Board(board_program, sketch, link, seconds=2, clip=1)
    _, _, _, truth = heard(board, "--record", str(sessions))
    (session,) = map(read_mcap, sessions.glob("*.mcap"))
    assert session.accel_mps2 is not None
    is_clipped = truth.accel_x_raw == 32767
    assert 0.4 < is_clipped.mean() < 0.6
    assert np.array_equal(np.isnan(session.accel_mps2), np.repeat(is_clipped[:, None], 3, axis=1))
    assert np.rint(session.rate_dps * 131).tolist() == truth.rate_raw.tolist()


def test_a_gyro_that_is_plugged_in_late_is_found(board_program: Path, sketch: Path, link: Path) -> None:
    """HELLO says that there is none; with the gyro comes its scale, before the first sample."""
    lines, log, _, truth = heard(Board(board_program, sketch, link, seconds=5, absent=3))
    assert log.index('device_id="no gyro on I2C"') < log.index('device_id="MPU-6050 250/42"')
    assert [round(line["rate_dps"] * 131) for line in lines] == truth.rate_raw.tolist()


def test_a_gyro_that_lost_its_settings_is_set_again(board_program: Path, sketch: Path, link: Path) -> None:
    lines, _, _, truth = heard(Board(board_program, sketch, link, seconds=3, reset=1))
    assert len(lines) > 200
    assert [round(line["rate_dps"] * 131) for line in lines] == truth.rate_raw.tolist()
    assert float(np.diff(truth.t_us).max()) > 300e3


def test_a_gyro_that_holds_the_bus_is_clocked_free(board_program: Path, sketch: Path, link: Path) -> None:
    lines, _, _, truth = heard(Board(board_program, sketch, link, seconds=2, held=7))
    assert [round(line["rate_dps"] * 131) for line in lines] == truth.rate_raw.tolist()


def test_what_is_too_fast_for_the_line_is_lost_and_counted(board_program: Path, sketch: Path, link: Path) -> None:
    lines, log, result, truth = heard(Board(board_program, sketch, link, seconds=3, ppm=3e6))
    position = np.array([line["seq"] - 1 for line in lines])
    assert 0.1 < len(lines) / result["measured"] < 0.6
    assert [round(line["rate_dps"] * 131) for line in lines] == truth.rate_raw[position].tolist()
    assert is_in_time([line["t_s"] for line in lines], Truth(*(values[position] for values in truth)))
    assert f"missing={position[-1] + 1 - len(lines)} " in log.splitlines()[-1]


def test_a_data_ready_pin_that_is_not_wired_is_told(board_program: Path, sketch: Path, link: Path) -> None:
    with Board(board_program, sketch, link, seconds=3, pin=0), Command("serve", "--port", link) as serve:
        serve.until_log('device_id="INT pin is quiet"')
        assert serve.out == ""


@pytest.mark.parametrize("kind", [MEGA, LEONARDO], ids=["mega", "leonardo"])
def test_it_is_compiled_for_other_boards(tmp_path: Path, kind: tuple[str, ...]) -> None:
    assert "setup" in run("avr-nm", sketch_object(tmp_path, *kind))


@pytest.mark.parametrize("core", ["ESP32", "ESP8266", "ARDUINO_ARCH_RP2040"])
def test_it_is_compiled_where_numbers_have_32_bits(core: str) -> None:
    """Against what such a core declares, without a warning."""
    if shutil.which("c++") is None:
        pytest.skip("there is no C++ compiler: apt-get install g++")
    ino = ("-x", "c++", "-include", "Arduino.h", SKETCH / "gyrodrift_gyro.ino")
    words = (
        "c++",
        "-std=gnu++17",
        *STRICT,
        f"-D{core}",
        f"-I{HEADERS}",
        f"-I{HERE / 'other_core'}",
        "-fsyntax-only",
        *ino,
    )
    assert run(*words) == ""


def test_record_reads_it(board_program: Path, sketch: Path, link: Path, tmp_path: Path) -> None:
    sessions = tmp_path / "sessions"
    with (
        Board(board_program, sketch, link, seconds=3) as board,
        Command("record", "--port", link, "--out", sessions, "--duration", "2") as record,
    ):
        assert record.end() == 0
        _, truth = board.result()
    session = read_mcap(next(sessions.glob("*MPU-6050-250-42*.mcap")))
    assert np.rint(session.rate_dps * 131).tolist() == truth.rate_raw[: len(session.rate_dps)].tolist()
    assert session.t_device_s[-1] - session.t_device_s[0] > 1.9
