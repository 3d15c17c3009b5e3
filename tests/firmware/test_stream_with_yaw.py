"""The sketches that run a filter on an Uno in simavr: the yaw that they send or print is that of Python."""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
import serial
from firmware_library import library
from firmware_support import LTO, UNO, Board, library_object, linked
from support import PATIENCE_S, Command

from gyrodrift.filters.registry import FILTERS
from gyrodrift.session.mcap.read import read_mcap

pytestmark = pytest.mark.xdist_group("firmware")  # the board is compiled once

LINE = re.compile(r"yaw (-?[\d.]+) \+- ([\d.]+) deg, bias (-?[\d.]+) deg/s")


@pytest.fixture(scope="module")
def arduino(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return library(tmp_path_factory.mktemp("libraries"), "arduino")


def example(arduino: Path, name: str, into: Path) -> Path:
    """An example of the library, to run on an Uno."""
    return linked(library_object(arduino, name, into, *UNO, *LTO), into)


def python_yaw_deg(name: str, t_s: list[float], rates_dps: list[float]) -> list[float]:
    """Yaw of a filter with its defaults after each sample."""
    kind = FILTERS[name]
    coefficients, state, yaw_deg = kind.coefficients(kind.params()), kind.state(), []
    for t, rate in zip(t_s, rates_dps, strict=True):
        kind.step(coefficients, state, t, rate)
        yaw_deg.append(state.yaw_deg)
    return yaw_deg


def test_serve_reads_the_yaw_of_the_service_and_of_the_board(
    board_program: Path, arduino: Path, tmp_path: Path
) -> None:
    sketch, sessions = example(arduino, "StreamWithYaw", tmp_path), tmp_path / "sessions"
    with (
        Board(board_program, sketch, tmp_path / "uno", seconds=6) as board,
        Command("serve", "--port", board.link, "--record", sessions) as serve,
    ):
        serve.until(lambda _: board.is_over(), "end of the board")
        result, truth = board.result()
        serve.until(lambda command: "event=link_lost" in command.log, "end of the stream")
        assert serve.stop() == 0
        lines, log = serve.all_lines(), serve.log
    assert 'device_id="MPU-6050 250/42"' in log
    assert result["measured"] == len(lines) > 550
    assert [round(line["rate_dps"] * 131) for line in lines] == truth.rate_raw.tolist()
    assert not any("device_yaw_sigma_deg" in line for line in lines)  # HDR has none
    on_board = np.array([line["device_yaw_deg"] for line in lines])
    here = python_yaw_deg("hdr", [line["t_s"] for line in lines], [line["rate_dps"] for line in lines])
    assert np.ptp(here) > 100.0
    np.testing.assert_allclose(on_board, here, rtol=0, atol=2e-3)
    assert np.ptp([line["yaw_deg"] for line in lines]) > 100.0
    (session,) = map(read_mcap, sessions.glob("*.mcap"))
    assert session.device_yaw_deg is not None
    np.testing.assert_allclose(session.device_yaw_deg, on_board, rtol=0, atol=1e-4)  # lines have four digits


@contextmanager
def printed(board: Board) -> Iterator[list[str]]:
    """Lines that a sketch prints until the end of its board."""
    lines = list[str]()
    with board, serial.Serial(str(board.link), 115200, timeout=PATIENCE_S) as port:
        port.reset_input_buffer()
        try:
            while line := port.readline():
                lines.append(line.decode().strip())
        except serial.SerialException:  # the board is over
            pass
        yield lines


@pytest.mark.parametrize("name", ["SerialYaw"])
def test_the_first_sketch_prints_yaw_with_its_standard_deviation(
    name: str, board_program: Path, arduino: Path, tmp_path: Path
) -> None:
    board = Board(board_program, example(arduino, name, tmp_path), tmp_path / "uno", seconds=13)
    with printed(board) as lines:
        values = [tuple(map(float, match.groups())) for line in lines if (match := LINE.fullmatch(line))]
    assert len(values) > 60
    yaw_deg, sigma_deg, bias_dps = np.array(values).T
    assert yaw_deg.max() > 200.0
    assert abs(yaw_deg[-1]) < 3.0 * sigma_deg[-1] < 9.0
    assert bias_dps[-1] == pytest.approx(0.35, abs=0.01)


def test_a_missing_gyro_is_told_and_found_later(board_program: Path, arduino: Path, tmp_path: Path) -> None:
    board = Board(board_program, example(arduino, "SerialYaw", tmp_path), tmp_path / "uno", seconds=4, absent=2)
    with printed(board) as lines:
        report = [line == "no gyro at this address: check VCC, GND, SCL and SDA" for line in lines]
    assert report[0]
    assert not report[-1]
