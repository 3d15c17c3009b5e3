"""Second sources in `serve`: as columns of the lines, and by `ctl`; then the recording with them."""

import select
import socket
from itertools import count
from pathlib import Path
from typing import Any

import pytest
from outputs_support import Reader, events, serving
from support import PATIENCE_S, Command, never

from gyrodrift import load_session
from gyrodrift.service.control_client import ControlClient

COLUMNS = "t_us, rate:dps, heading:compass:sigma/1, speed:kn, rest"
BIAS_DPS, TURN_DPS, SECONDS = 0.7, 3.0, 40


def lines(first: int, number_of: int) -> bytes:
    """A device that never rests, at 100 Hz: a compass heading a second, else empty cells."""
    texts = []
    for number in range(first, first + number_of):
        t_s = 0.01 * number
        compass = f"{(90.0 - TURN_DPS * t_s) % 360.0:.2f}" if number % 100 == 0 else ""
        texts.append(f"{10_000 * number},{TURN_DPS + BIAS_DPS + 0.05 * (-1) ** number:.3f},{compass},2.5,\n")
    return "".join(texts).encode()


def heading_of_person(control: Path, device: Any, first: int) -> dict[str, Any]:
    """Answer to the heading that a person sees, while samples come."""
    with socket.socket(socket.AF_UNIX) as connection:
        connection.connect(str(control))
        connection.sendall(f"heading {(90 - TURN_DPS * SECONDS) % 360} --sigma 2\n".encode())
        for number in count(first):
            device.send_all(lines(number, 1), never)
            if select.select([connection], [], [], 0.02)[0]:
                return Reader(connection).json()
    raise AssertionError


def test_a_compass_in_the_lines_corrects_a_device_that_never_rests(port: Path, tmp_path: Path) -> None:
    """Samples name the ages, a person adds a heading, the recording has all of it, and `filter` gives the same yaw."""
    control, folder = tmp_path / "control", tmp_path / "sessions"
    with serving(port, "--columns", COLUMNS, "--control", control, "--record", folder) as (serve, device):
        device.send_all(lines(0, 100 * SECONDS), never)
        last = serve.take_lines(100 * SECONDS)[-1]
        assert last["yaw_deg"] == pytest.approx(TURN_DPS * SECONDS, abs=3.0)
        assert last["bias_dps"] == pytest.approx(BIAS_DPS, abs=0.1)
        assert last["aids"] == {"heading": pytest.approx(0.99), "speed": 0.0}
        answer = heading_of_person(control, device, 100 * SECONDS)
        assert answer["aid"] == {"age_s": pytest.approx(0.0, abs=0.02), "weight": 1.0, "differs": None}
        with ControlClient(control, PATIENCE_S) as client:
            status = client.ask("status")
            client.ask("stop")
        assert set(status["filter"]["aids"]) == {"heading", "speed", "ctl"}
        assert not events(serve, "aid_differs")
        assert serve.end() == 0
    (path,) = folder.glob("*.mcap")
    session = load_session(path)
    assert session.aids is not None
    assert {aid.name for _, aid in session.aids} == {"heading", "speed", "ctl"}
    with Command("filter", path) as filtered:
        assert filtered.end() == 0
    header, *rows = filtered.out.splitlines()
    yaw_deg = float(rows[100 * SECONDS - 1].split(",")[header.split(",").index("yaw_deg")])
    assert yaw_deg == pytest.approx(last["yaw_deg"], abs=1e-4)
