"""The output networktables with pyntcore at the other end: as a client of ours, and as the robot's server."""

import json
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import pytest
from outputs_support import (
    HubThread,
    address_of,
    await_problem,
    corrected,
    csv_at_100_hz,
    events,
    hub,
    hub_process,
    path_of,
    serving,
    tilted,
)
from support import PATIENCE_S, awaited, free_port, near, never
from websockets.exceptions import ConnectionClosed, InvalidMessage
from websockets.sync.client import ClientConnection, connect
from websockets.typing import Subprotocol

from gyrodrift.outputs.networktables import MeasuredTime
from gyrodrift.service.control_client import ControlClient

pytest.importorskip("ntcore", reason="the extra networktables is not installed")

CLIENT = """
import json, math, sys, time, ntcore
role, port = sys.argv[1], int(sys.argv[2])
tables = ntcore.NetworkTableInstance.create()
if role in {"client", "forger"}:
    tables.setServer("127.0.0.1", port)
    tables.startClient4(role)
else:
    tables.startServer("", "127.0.0.1", 0, port)
table = tables.getTable("gyrodrift")
fast = ntcore.PubSubOptions(periodic=0.01)
names = ("yaw_deg", "corrected_dps", "time_s")
doubles = {name: table.getDoubleTopic(name).subscribe(float("nan"), fast) for name in names}
every = table.getDoubleTopic("yaw_deg").subscribe(0.0, ntcore.PubSubOptions(periodic=0.01, sendAll=True))
highest, forged = 0.0, table.getDoubleTopic("yaw_deg").publish(fast) if role.startswith("forg") else None
connected = table.getBooleanTopic("connected").subscribe(False, fast)
while True:
    if forged:
        forged.set(time.monotonic() + 1e6)
    else:
        highest = max([highest, *(each.value for each in every.readQueue())])
    seen = {name: each.getAtomic() for name, each in doubles.items()}
    said = {name: each.value for name, each in seen.items()}
    said |= {"highest": highest}
    said |= {"stamp_s": seen["time_s"].serverTime / 1e6, "connected": connected.get(), "joined": tables.isConnected()}
    print(json.dumps(said), flush=True)
    time.sleep(0.05)
"""
"""A process of its own: ntcore keeps threads and pipes as long as it lives."""


@contextmanager
def other_end(role: str, number: int, folder: Path, code: str = CLIENT) -> Iterator[Iterator[dict[str, Any]]]:
    command = [sys.executable, "-c", code, role, str(number)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, cwd=folder) as process:
        assert process.stdout is not None
        try:
            yield (json.loads(line) for line in process.stdout)
        finally:
            process.kill()


def until(observation: Iterator[dict[str, Any]], **values: Any) -> dict[str, Any]:
    """The first that is seen with these values."""
    until_s = time.monotonic() + PATIENCE_S
    for item in observation:
        if item.items() >= values.items():
            return item
        assert time.monotonic() < until_s, item
    raise AssertionError("the other end ended")


def test_a_client_sees_yaw_and_when_it_was_measured(port: Path, tmp_path: Path) -> None:
    """The stamp of a value and `time_s` are the same, on the clock of the server, and not in the future."""
    with serving(port, "--output", "networktables:port=0") as (serve, device):
        _, number = address_of(serve, "networktables")
        with other_end("client", number, tmp_path) as observed:
            assert not until(observed, joined=True)["connected"]
            device.send_all(csv_at_100_hz(100), never)
            last = serve.take_lines(100)[-1]
            until(observed, yaw_deg=last["yaw_deg"])
            result = next(observed)  # the client takes the values of a sample one by one
    assert result["corrected_dps"] == last["corrected_dps"]
    assert result["time_s"] == near(result["stamp_s"], 1e-5)
    assert 0.0 < time.time() - result["time_s"] < 3600.0


def test_a_gyro_that_speaks_is_connected_and_one_that_is_silent_is_not(port: Path, tmp_path: Path) -> None:
    with serving(port, "--output", "networktables:port=0") as (serve, device):
        _, number = address_of(serve, "networktables")
        with other_end("client", number, tmp_path) as observed:
            assert not until(observed, joined=True)["connected"]
            lines = iter(csv_at_100_hz(10_000).splitlines(keepends=True))
            speaking = (item for item in observed if device.send_all(next(lines), never))
            until(speaking, connected=True)
            until(observed, connected=False)


def test_the_robot_is_published_to_as_soon_as_it_is_there(port: Path, tmp_path: Path) -> None:
    """Our side waits for the server, and goes on when it has been started again."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        number = free.getsockname()[1]
    with serving(port, "--output", f"networktables:robot=127.0.0.1,port={number}") as (serve, device):
        assert path_of(serve, "networktables") == f"127.0.0.1:{number}"
        device.send_all(csv_at_100_hz(100), never)
        last = serve.take_lines(100)[-1]
        for _ in range(2):
            with other_end("robot", number, tmp_path) as observed:
                until(observed, yaw_deg=last["yaw_deg"], joined=True)


@pytest.mark.promise("Clients of outputs")
def test_no_client_can_forge_a_value(port: Path, tmp_path: Path) -> None:
    """On its own server, only the service publishes to its topics."""
    with serving(port, "--output", "networktables:port=0") as (serve, device):
        _, number = address_of(serve, "networktables")
        with other_end("client", number, tmp_path) as observed, other_end("forger", number, tmp_path) as forging:
            until(observed, joined=True)
            until(forging, joined=True)
            serve.until(lambda it: bool(events(it, "forgery_refused")), "refusal")
            assert events(serve, "forgery_refused")[0]["topic"] == "/gyrodrift/yaw_deg"
            assert "forger 127.0.0.1:" in events(serve, "forgery_refused")[0]["client"]
            for _ in range(10):
                next(forging)
            device.send_all(csv_at_100_hz(100), never)
            last = serve.take_lines(100)[-1]
            assert until(observed, yaw_deg=last["yaw_deg"])["highest"] <= last["yaw_deg"] < 1e6


@pytest.mark.promise("Clients of outputs")
def test_who_forges_values_on_the_robots_server_is_told(port: Path, tmp_path: Path) -> None:
    """On a robot's server, another publisher is reported."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        number = free.getsockname()[1]
    options = ["--output", f"networktables:robot=127.0.0.1,port={number}", "--control", str(tmp_path / "control")]
    with serving(port, *options) as (serve, _):
        serve.until(lambda it: bool(events(it, "topics_are_open")), "warning")
        with (
            ControlClient(tmp_path / "control", PATIENCE_S) as service,
            other_end("robot", number, tmp_path) as robot,
            other_end("forger", number, tmp_path) as forging,
        ):
            until(robot, joined=True)
            until(forging, joined=True)
            serve.until(lambda it: bool(events(it, "topic_forged")), "who it is")
            assert events(serve, "topic_forged")[0]["clients"][0].partition("@")[0] == "forger"
            report = awaited(lambda: service.ask("status")["outputs"][0]["warning"])
            assert report.startswith("values are forged on the robot's server, by forger")
        serve.until(lambda it: bool(events(it, "topic_ours_again")), "that it is over")


ROBOT_CODE = """
import dataclasses, json, ntcore, sys, time
from wpiutil import wpistruct

@wpistruct.make_wpistruct(name="Quaternion")
@dataclasses.dataclass
class Quaternion:
    w: wpistruct.double = 0.0
    x: wpistruct.double = 0.0
    y: wpistruct.double = 0.0
    z: wpistruct.double = 0.0

role, port = sys.argv[1], int(sys.argv[2])
tables = ntcore.NetworkTableInstance.create()
if role == "client":
    tables.setServer("127.0.0.1", port)
    tables.startClient4(role)
else:
    tables.startServer("", "127.0.0.1", 0, port)
table = tables.getTable("gyrodrift")
fast = ntcore.PubSubOptions(periodic=0.01)
rotation = table.getRawTopic("rotation").subscribe("struct:Rotation3d", bytes(32), fast)
names = ("roll_deg", "pitch_deg", "tilt_deg")
angles = {name: table.getDoubleTopic(name).subscribe(float("nan"), fast) for name in names}
layout = tables.getRawTopic("/.schema/struct:Rotation3d").subscribe("structschema", b"", fast)
every = ntcore.MultiSubscriber(tables, ["/gyrodrift/"], ntcore.PubSubOptions(topicsOnly=True))
while True:
    q, layout_text = wpistruct.unpack(Quaternion, rotation.get()), bytes(layout.get()).decode()
    seen = {name: each.get() for name, each in angles.items()} | {"q": [q.w, q.x, q.y, q.z], "layout": layout_text}
    seen["joined"] = tables.isConnected()
    seen["topics"] = sorted(topic.getName() for topic in tables.getTopics("/gyrodrift/"))
    print(json.dumps(seen), flush=True)
    time.sleep(0.05)
"""
"""Code of a robot that reads a Rotation3d, which holds a quaternion alone."""


@pytest.mark.promise("Clients of outputs")
@pytest.mark.parametrize("role", ["client", "robot"])
def test_robot_code_reads_a_rotation(role: str, tmp_path: Path) -> None:
    """Robot code reads a Rotation3d of WPILib."""
    pytest.importorskip("wpiutil.wpistruct", reason="robotpy-wpiutil is not installed")
    number = free_port()
    with hub_process() as outputs:
        outputs.want(f"networktables:port={number}" + (",robot=127.0.0.1" if role == "robot" else ""))
        outputs.opened()
        with other_end(role, number, tmp_path, ROBOT_CODE) as observed:
            until(observed, joined=True)
            outputs.samples([tilted(0)])
            result = until(observed, roll_deg=10.0, pitch_deg=-20.0, layout="Quaternion q")
            while result["q"][0] == 0.0:
                result = next(observed)
    attitude = tilted(0).attitude
    assert attitude is not None
    assert result["q"] == pytest.approx(attitude[:4])
    assert result["tilt_deg"] == 22.2687


def test_a_device_with_one_axis_has_no_rotation(tmp_path: Path) -> None:
    with (
        hub("networktables:port=0") as outputs,
        other_end("client", outputs.endpoint()[1], tmp_path, ROBOT_CODE) as observed,
    ):
        until(observed, joined=True)
        outputs.samples([corrected(0)])
        before = next(item for item in observed if len(item["topics"]) >= 8)["topics"]
        outputs.samples([tilted(10)])
        after = next(item for item in observed if len(item["topics"]) > 8)["topics"]
    assert set(after) - set(before) == {
        f"/gyrodrift/{name}" for name in ("roll_deg", "pitch_deg", "tilt_deg", "tilt_sigma_deg", "rotation")
    }


def names_in_use(outputs: HubThread, count: int) -> list[str]:
    clients = awaited(lambda: outputs.statuses()[0].clients, lambda heard: len(heard) == count)
    return [item.peer.rpartition(" ")[0] for item in clients]


@pytest.mark.promise("Clients of outputs")
def test_any_name_of_a_client_is_shown_as_text() -> None:
    """Any name of a client is shown as text."""
    with hub("networktables:port=0") as outputs:
        address = outputs.address
        with (
            connected_as(address, "%ff"),
            connected_as(address, "%0a%1b[2J"),
            connected_as(address, "x" * 200),
            connected_as(address, ""),
        ):
            names = names_in_use(outputs, 4)
    assert sorted(names) == ["", "\\n\\x1b[2J", "\\xff", "x" * 40 + "…"]


def connected_as(address: str, name: str) -> ClientConnection:
    return connect(f"ws://{address}/nt/{name}", subprotocols=[Subprotocol("v4.1.networktables.first.wpi.edu")])


@pytest.mark.parametrize(
    "sent",
    [
        "[" * 1000,
        "{}",
        json.dumps([{"method": "subscribe", "params": {"subuid": i, "topics": []}} for i in range(300)]),
        json.dumps([[]] * 2000),
        b"\xc1",
        b"\x91" * 2000,
        b"\xdd\xff\xff\xff\xff",
        b"\x94\xff\x00\x02\x01" * 300,
    ],
)
def test_what_no_client_sends_closes_its_connection(sent: str | bytes) -> None:
    with hub("networktables:port=0") as outputs, connected_as(outputs.address, "x") as client:
        client.send(sent)
        with pytest.raises(ConnectionClosed):
            client.recv(PATIENCE_S)
        assert client.close_code == 1008
        assert client.close_reason


@pytest.mark.parametrize(
    "sent",
    [
        [],
        [1, None, {}, {"method": 1, "params": {}}, {"method": "subscribe", "params": []}],
        [{"method": "subscribe", "params": {"subuid": "x", "topics": 1}}],
        [{"method": "subscribe", "params": {"subuid": 1, "topics": [1, None], "options": 7}}],
        [{"method": "unsubscribe", "params": {"subuid": 99}}, {"method": "publish", "params": {}}],
        [{"method": "setproperties", "params": {"name": "/gyrodrift/yaw_deg", "update": {"persistent": True}}}],
        [{"method": "publish", "params": {"name": "/gyrodrift/yaw_deg", "pubuid": [], "type": {}}}],
    ],
)
def test_what_is_not_understood_is_ignored(sent: object) -> None:
    with hub("networktables:port=0") as outputs, connected_as(outputs.address, "x") as client:
        client.send(json.dumps(sent))
        client.send(b"\x94\xff\x00\x02\x07")
        answer = client.recv(PATIENCE_S)
        assert isinstance(answer, bytes)
        assert answer[:2] == b"\x94\xff"
        assert answer[-1:] == b"\x07"


@pytest.mark.promise("Clients of outputs")
def test_a_crowd_is_turned_away() -> None:
    """Networktables has at most 64 clients."""
    with hub("networktables:port=0") as outputs, ExitStack() as many:
        address = outputs.address
        for index in range(64):
            many.enter_context(connected_as(address, str(index)))
        with pytest.raises((ConnectionClosed, OSError, InvalidMessage)), connected_as(address, "one more"):
            pass


def test_a_port_that_is_taken_is_told() -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken, hub() as outputs:
        outputs.want(f"networktables:port={taken.getsockname()[1]}")
        assert f":{taken.getsockname()[1]}" in await_problem(outputs, "is used by")


def test_delays_that_vary_are_not_in_the_time_of_measurement() -> None:
    """The sample that waited least says how the clocks are to each other."""
    clock = MeasuredTime()
    for number, delay_s in enumerate((0.030, 0.002, 0.015, 0.050, 0.020)):
        clock.note(0.01 * number, 1000.0 + 0.01 * number + delay_s)
    assert clock.of(0.04) == near(1000.042, 1e-4)
