"""The server for the Foxglove app, with a client of Foxglove's own package and with hostile ones."""

import json
import os
import socket
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Any, cast

import pytest
from clients_support import fed, node_client
from outputs_support import address_of, corrected, csv_at_100_hz, events, hub, serving, tilted
from support import PATIENCE_S, awaited, never
from websockets.exceptions import ConnectionClosed, InvalidMessage
from websockets.sync.client import ClientConnection, connect
from websockets.typing import Subprotocol

from gyrodrift.outputs.foxglove import POSE_SCHEMA
from gyrodrift.outputs.foxglove_session import FoxgloveSession
from gyrodrift.outputs.net.websocket import WebSocketClient
from gyrodrift.outputs.status import ConfigStatus, ServiceStatus
from gyrodrift.service.control_client import ControlClient

PROTOCOL = Subprotocol("foxglove.sdk.v1")
HDR = "hdr: {i_c_dps: 1e-3, tau_s: .5, theta_w_dps: 1, c1: 0, c2: 1}\n"


def test_ws_protocol_is_a_client(port: Path) -> None:
    """Channels with schemas, their messages, and parameters that stay what they are."""
    with serving(port, "--output", "foxglove:port=0") as (serve, device):
        host, number = address_of(serve, "foxglove")
        statement = fed(node_client("@foxglove/ws-protocol", "foxglove.mjs", f"ws://{host}:{number}"), serve, device)
    assert statement["channels"].keys() == {"/gyro/sample", "/gyro/state", "/gyro/link_stats"}
    for topic, messages in statement["messages"].items():
        channel = statement["channels"][topic]
        assert (channel["encoding"], channel["schemaEncoding"]) == ("json", "jsonschema")
        assert messages[0].keys() - {"timestamp"} <= channel["schema"]["properties"].keys()
    sample = statement["messages"]["/gyro/sample"][-1]
    assert sample["rate_dps"] == 10.0
    assert int(sample["timestamp"]) / 1e9 == pytest.approx(sample["t_host_s"], abs=1e-3)
    assert statement["messages"]["/gyro/link_stats"][0]["protocol"] in {"csv", "unknown"}
    assert "parameters" in statement["capabilities"]
    before, after = statement["parameters"]
    assert after == before
    assert {"filter", "config"} < {item["name"] for item in before}


def listening() -> int:
    """Sockets of this process that somebody can connect to."""
    count = 0
    for link in list(Path("/proc/self/fd").iterdir()):
        with suppress(FileNotFoundError):  # that of the listing itself
            if str(link.readlink()).startswith("socket:"):
                with socket.socket(fileno=os.dup(int(link.name))) as item:
                    count += item.getsockopt(socket.SOL_SOCKET, socket.SO_ACCEPTCONN)
    return count


@pytest.mark.promise("Clients of outputs")
def test_there_is_one_port_and_it_takes_so_many_clients() -> None:
    """Foxglove has one port and at most 64 clients."""
    before = listening()
    with hub("foxglove:port=0") as outputs, ExitStack() as many:
        address = outputs.address
        assert listening() == before + 1
        clients = [many.enter_context(connect(f"ws://{address}", subprotocols=[PROTOCOL])) for _ in range(64)]
        for _ in range(100):
            with pytest.raises((ConnectionClosed, OSError, InvalidMessage)), connect(f"ws://{address}"):
                pass
        subscribed(clients[0], number=7)
        wait_for_answer(clients[0])
        outputs.samples([corrected(1)])
        message = clients[0].recv(PATIENCE_S)
        assert isinstance(message, bytes)
        assert message[:5] == b"\x01\x07\x00\x00\x00"
        assert int.from_bytes(message[5:13], "little") == pytest.approx(corrected(1).sample.t_host_s * 1e9)
        assert json.loads(message[13:])["seq"] == 1


def subscribed(client: ClientConnection, number: int) -> None:
    """To samples, once the greeting was read."""
    assert json.loads(client.recv(PATIENCE_S))["op"] == "serverInfo"
    assert json.loads(client.recv(PATIENCE_S))["op"] == "advertise"
    client.send(json.dumps({"op": "subscribe", "subscriptions": [{"id": number, "channelId": 1}]}))


def wait_for_answer(client: ClientConnection) -> None:
    """Until what was sent before has been taken."""
    client.send('{"op":"getParameters","parameterNames":[],"id":"wait"}')
    assert json.loads(client.recv(PATIENCE_S))["id"] == "wait"


def test_a_tilted_device_has_a_pose() -> None:
    with hub("foxglove:port=0") as outputs:
        address = f"ws://{outputs.address}"
        with connect(address, subprotocols=[PROTOCOL]) as early:
            subscribed(early, number=7)
            wait_for_answer(early)
            outputs.samples([corrected(0), tilted(1)])
            (channel,) = json.loads(early.recv(PATIENCE_S))["channels"]
            early.send(json.dumps({"op": "subscribe", "subscriptions": [{"id": 9, "channelId": channel["id"]}]}))
            assert [json.loads(cast("bytes", early.recv(PATIENCE_S))[13:])["seq"] for _ in range(2)] == [0, 1]
            wait_for_answer(early)
            outputs.samples([tilted(100)])
            early.recv(PATIENCE_S)
            message = early.recv(PATIENCE_S)
        with connect(address, subprotocols=[PROTOCOL]) as late:
            late.recv(PATIENCE_S)
            topics = {item["topic"] for item in json.loads(late.recv(PATIENCE_S))["channels"]}
    assert isinstance(message, bytes)
    pose = json.loads(message[13:])
    assert (channel["schemaName"], channel["topic"]) == ("foxglove.PoseInFrame", "/gyro/pose")
    assert pose["timestamp"] == {"sec": 1_700_000_001, "nsec": 0}
    attitude = tilted(100).attitude
    assert attitude is not None
    assert [pose["pose"]["orientation"][name] for name in "wxyz"] == pytest.approx(attitude[:4])
    assert topics == {"/gyro/sample", "/gyro/state", "/gyro/link_stats", "/gyro/pose"}


def test_the_schema_of_a_pose_is_foxgloves_own() -> None:
    """Names of its fields, from the descriptor in the package of Foxglove."""
    schemas = pytest.importorskip("foxglove.schemas", reason="foxglove-sdk is not installed: pip install foxglove-sdk")
    descriptor = schemas.PoseInFrame.get_schema().data
    properties = POSE_SCHEMA["properties"]
    assert isinstance(properties, dict)
    names = {*properties, *properties["pose"]["properties"]}
    assert all(name.encode() in descriptor for name in names)


@pytest.mark.parametrize(
    "sent",
    [
        "[" * 10_000,
        "}",
        "[]",
        b"\x01abc",
        b"",
        '{"op":"what"}',
        '{"op":"advertise","channels":[]}',
        '{"op":"subscribe"}',
        '{"op":"subscribe","subscriptions":[1]}',
        '{"op":"subscribe","subscriptions":[{"id":1,"channelId":99}]}',
        '{"op":"subscribe","subscriptions":[{"id":1,"channelId":[]}]}',
        '{"op":"subscribe","subscriptions":[{"id":-1,"channelId":1}]}',
        '{"op":"subscribe","subscriptions":[{"id":4294967296,"channelId":1}]}',
        '{"op":"subscribe","subscriptions":[{"id":1,"channelId":1},{"id":2,"channelId":1}]}',
        '{"op":"getParameters","parameterNames":[[]]}',
        '{"op":"unsubscribe","subscriptionIds":"all"}',
    ],
)
def test_a_mistake_is_told_and_the_connection_stays(sent: str | bytes) -> None:
    with hub("foxglove:port=0") as outputs, connect(f"ws://{outputs.address}", subprotocols=[PROTOCOL]) as client:
        client.recv(PATIENCE_S)
        client.recv(PATIENCE_S)
        client.send(sent)
        report = json.loads(client.recv(PATIENCE_S))
        assert report["op"] == "status"
        assert report["level"] in {1, 2}
        wait_for_answer(client)


def test_parameters_are_told_when_they_change_to_who_follows_them() -> None:
    with hub("foxglove:port=0") as outputs, connect(f"ws://{outputs.address}", subprotocols=[PROTOCOL]) as client:
        client.recv(PATIENCE_S)
        client.recv(PATIENCE_S)
        outputs.status(ServiceStatus(config=ConfigStatus(filter="hdr", params={"tau_s": 0.5})))
        client.send('{"op":"getParameters","parameterNames":["hdr.tau_s"],"id":"a"}')
        while not (values := json.loads(client.recv(PATIENCE_S))["parameters"]):
            client.send('{"op":"getParameters","parameterNames":["hdr.tau_s"],"id":"a"}')
        assert values == [{"name": "hdr.tau_s", "value": 0.5, "type": "float64"}]
        client.send('{"op":"subscribeParameterUpdates","parameterNames":["hdr.tau_s"]}')
        wait_for_answer(client)
        outputs.status(ServiceStatus(config=ConfigStatus(file="c", filter="hdr", params={"tau_s": 0.7})))
        report = json.loads(client.recv(PATIENCE_S))
        assert report["parameters"] == [{"name": "hdr.tau_s", "value": 0.7, "type": "float64"}]


def test_a_port_that_is_taken_is_told(port: Path) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        with serving(port, "--output", f"foxglove:port={taken.getsockname()[1]}") as (serve, _):
            serve.until(lambda it: bool(events(it, "output_failed")), "refusal")
            assert "is used by" in events(serve, "output_failed")[0]["reason"]


def test_all_losses_so_far_are_told() -> None:
    """The app shows the last message alone."""
    session = FoxgloveSession(cast("WebSocketClient", None), [], dict)
    assert [json.loads(session.dropped(count))["message"].split()[0] for count in (3, 4)] == ["3", "7"]


def test_who_does_not_read_is_told_how_many_it_lost(port: Path, tmp_path: Path) -> None:
    config, count = tmp_path / "c.yaml", 8_000
    config.write_text(HDR + "outputs: [{name: foxglove, port: 0}]\n")
    with (
        serving(port, "--config", config, "--control", tmp_path / "control") as (serve, device),
        socket.socket() as connection,
    ):
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        host, number = address_of(serve, "foxglove")
        connection.connect((host, number))
        with connect(f"ws://{host}:{number}", sock=connection, subprotocols=[PROTOCOL], max_queue=1) as client:
            while (report := json.loads(client.recv(PATIENCE_S)))["op"] != "advertise":
                pass
            topics = {item["topic"]: item["id"] for item in report["channels"]}
            ask = {"id": 1, "channelId": topics["/gyro/sample"]}
            client.send(json.dumps({"op": "subscribe", "subscriptions": [ask]}))
            device.send_all(csv_at_100_hz(100), never)
            serve.take_lines(90)
            for first in range(100, count, 500):
                device.send_all(csv_at_100_hz(500, first=first), never)
                serve.take_lines(490)
            dropped = client_of(tmp_path / "control")["dropped"]
            got, missed = read_to(client, count - 200)
            assert missed >= dropped > 0
            assert got == sorted(got)
            assert missed == got[-1] - got[0] + 1 - len(got)
            config.write_text(HDR + "outputs: [{name: tcp, port: 0}]\n")
            address_of(serve, "tcp")
            client.socket.shutdown(socket.SHUT_RDWR)
        assert serve.stop() == 0


def read_to(client: ClientConnection, last: int) -> tuple[list[int], int]:
    """Counters of the samples up to one, and how many messages the server says were dropped."""
    got: list[int] = []
    missed = 0
    while not got or got[-1] < last:
        message = client.recv(PATIENCE_S)
        if isinstance(message, bytes):
            got.append(json.loads(message[13:])["seq"])
        elif (report := json.loads(message))["op"] == "status":
            missed = int(report["message"].split()[0])
    return got, missed


def client_of(control: Path) -> dict[str, Any]:
    """The only client, as `ctl status` has it once something was dropped for it."""
    with ControlClient(control, PATIENCE_S) as service:
        output = awaited(lambda: service.ask("status")["outputs"][0], lambda heard: heard["dropped"])
    (client,) = output["clients"]
    return dict(client)
