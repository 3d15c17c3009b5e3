"""The output networktables with pyntcore at the other end: as a client of ours, and as the robot's server."""

import json
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from outputs_support import address_of, csv_at_100_hz, hub, path_of, serving
from support import PATIENCE_S, near, never

from gyrodrift.outputs.networktables import MeasuredTime

pytest.importorskip("ntcore", reason="the extra networktables is not installed")

CLIENT = """
import json, sys, time, ntcore
role, port = sys.argv[1], int(sys.argv[2])
tables = ntcore.NetworkTableInstance.create()
if role == "client":
    tables.setServer("127.0.0.1", port)
    tables.startClient4("robot")
else:
    tables.startServer("", "127.0.0.1", 0, port)
table = tables.getTable("gyrodrift")
fast = ntcore.PubSubOptions(periodic=0.01)
names = ("yaw_deg", "corrected_dps", "time_s")
doubles = {name: table.getDoubleTopic(name).subscribe(float("nan"), fast) for name in names}
connected = table.getBooleanTopic("connected").subscribe(False, fast)
while True:
    seen = {name: each.getAtomic() for name, each in doubles.items()}
    said = {name: each.value for name, each in seen.items()}
    said |= {"stamp_s": seen["time_s"].serverTime / 1e6, "connected": connected.get(), "joined": tables.isConnected()}
    print(json.dumps(said), flush=True)
    time.sleep(0.05)
"""
"""A process of its own: ntcore keeps threads and pipes as long as it lives."""


@contextmanager
def other_end(role: str, number: int, folder: Path) -> Iterator[Iterator[dict[str, Any]]]:
    """What the other end sees, again and again."""
    command = [sys.executable, "-c", CLIENT, role, str(number)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, cwd=folder) as process:
        assert process.stdout is not None
        try:
            yield (json.loads(line) for line in process.stdout)
        finally:
            process.kill()


def until(seen: Iterator[dict[str, Any]], **values: Any) -> dict[str, Any]:
    """The first that is seen with these values."""
    until_s = time.monotonic() + PATIENCE_S
    for each in seen:
        if each.items() >= values.items():
            return each
        assert time.monotonic() < until_s, each
    raise AssertionError("the other end ended")


def test_a_client_sees_yaw_and_when_it_was_measured(port: Path, tmp_path: Path) -> None:
    """The stamp of a value and `time_s` are the same, on the clock of the server, and not in the future."""
    with serving(port, "--output", "networktables:port=0") as (serve, device):
        _, number = address_of(serve, "networktables")
        with other_end("client", number, tmp_path) as seen:
            assert not until(seen, joined=True)["connected"]
            device.send_all(csv_at_100_hz(100), never)
            last = serve.take_lines(100)[-1]
            found = until(seen, yaw_deg=last["yaw_deg"])
    assert found["corrected_dps"] == last["corrected_dps"]
    assert found["time_s"] == near(found["stamp_s"], 1e-5)
    assert 0.0 < time.time() - found["time_s"] < 3600.0


def test_a_gyro_that_speaks_is_connected_and_one_that_is_silent_is_not(port: Path, tmp_path: Path) -> None:
    """With its first samples, not with the next status."""
    with serving(port, "--output", "networktables:port=0") as (serve, device):
        _, number = address_of(serve, "networktables")
        with other_end("client", number, tmp_path) as seen:
            assert not until(seen, joined=True)["connected"]
            lines = iter(csv_at_100_hz(10_000).splitlines(keepends=True))
            speaking = (each for each in seen if device.send_all(next(lines), never))
            until(speaking, connected=True)
            until(seen, connected=False)


def test_the_robot_is_published_to_as_soon_as_it_is_there(port: Path, tmp_path: Path) -> None:
    """Our side waits for the server, and goes on when it has been started anew."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        number = free.getsockname()[1]
    with serving(port, "--output", f"networktables:robot=127.0.0.1,port={number}") as (serve, device):
        assert path_of(serve, "networktables") == f"127.0.0.1:{number}"
        device.send_all(csv_at_100_hz(100), never)
        last = serve.take_lines(100)[-1]
        for _ in range(2):
            with other_end("robot", number, tmp_path) as seen:
                until(seen, yaw_deg=last["yaw_deg"], joined=True)


def test_a_port_that_is_taken_is_told() -> None:
    """With who has it."""
    with socket.create_server(("127.0.0.1", 0)) as taken, hub() as outputs:
        outputs.want(f"networktables:port={taken.getsockname()[1]}")
        while not any("is taken by" in each.problem for each in outputs.statuses()):
            pass


def test_delays_that_vary_are_not_in_the_time_of_measurement() -> None:
    """The sample that waited least says how the clocks are to each other."""
    clock = MeasuredTime()
    for number, delay_s in enumerate((0.030, 0.002, 0.015, 0.050, 0.020)):
        clock.note(0.01 * number, 1000.0 + 0.01 * number + delay_s)
    assert clock.of(0.04) == near(1000.042, 1e-4)
