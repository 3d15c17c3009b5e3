"""Ten minutes of an Uno with the sketch and an MPU-6050 at 200 Hz and 115200 baud, into real `serve` and `record`."""

import json
import signal
import subprocess
import time
from pathlib import Path

import numpy as np
import pytest
from firmware_support import Board, built_board, built_sketch
from support import PATIENCE_S, ours

from bench.harness import show
from gyrodrift.session.mcap.read import read_mcap

SECONDS = 600
LONGEST_S = 500.0


@pytest.mark.parametrize(("command", "to"), [("serve", "--record"), ("record", "--out")])
def test_no_sample_is_lost_in_ten_minutes(tmp_path: Path, command: str, to: str) -> None:
    """Neither on the way to the lines nor on the way to the session, and each with its own time."""
    lines, log, sessions = tmp_path / "lines", tmp_path / "log", tmp_path / "sessions"
    board = Board(built_board(tmp_path), built_sketch(tmp_path), tmp_path / "uno", seconds=SECONDS)
    with board, lines.open("wb") as out, log.open("wb") as err:
        reader = subprocess.Popen(ours(command, "--port", board.link, to, sessions), stdout=out, stderr=err)
        try:
            result, truth = board.result(LONGEST_S)
            until_s = time.monotonic() + PATIENCE_S
            while "event=link_lost" not in log.read_text() and time.monotonic() < until_s:
                time.sleep(0.1)
        finally:
            reader.send_signal(signal.SIGTERM)
            reader.wait(PATIENCE_S)
    served = [json.loads(line) for line in lines.read_text().splitlines() if command == "serve"]
    (session,) = map(read_mcap, sessions.glob("*.mcap"))
    late_us = session.t_device_s * 1e6 - truth.t_us[: len(session.t_device_s)]
    rows = [
        ("measured by the gyro", f"{result['measured']}"),
        *([("lines", f"{len(served)}")] if served else []),
        ("samples in the session", f"{len(session.rate_dps)}"),
        ("time of a sample, spread", f"{np.ptp(late_us):.1f} µs"),
        ("took", f"{result['took_s']:.0f} s"),
    ]
    show(f"{command}, {SECONDS} s of device time", rows)
    assert "gaps=0 missing=0" in log.read_text()
    assert not served or [round(line["rate_dps"] * 131) for line in served] == truth.rate_raw.tolist()
    assert session.gyro_dps is not None
    assert session.accel_mps2 is not None
    assert np.array_equal(np.rint(session.gyro_dps * 131), truth.gyro_raw())
    assert np.array_equal(np.rint(session.accel_mps2 / 9.80665 * 4096), truth.accel_raw())
