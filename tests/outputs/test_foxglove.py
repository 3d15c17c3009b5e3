"""The server of the Foxglove SDK, with a client of Foxglove's own package."""

import json
import socket
from pathlib import Path

import pytest
from clients_support import fed, node_client
from outputs_support import address_of, csv_at_100_hz, events, serving
from support import never
from websockets.sync.client import connect
from websockets.typing import Subprotocol

pytest.importorskip("foxglove", reason="foxglove-sdk is not installed: pip install 'gyrodrift[foxglove]'")

HDR = "hdr: {i_c_dps: 1e-3, tau_s: .5, theta_w_dps: 1, c1: 0, c2: 1}\n"


def test_ws_protocol_is_a_client(port: Path) -> None:
    """Channels with schemas, their messages, and parameters that stay what they are."""
    with serving(port, "--output", "foxglove:port=0") as (serve, device):
        host, number = address_of(serve, "foxglove")
        said = fed(node_client("@foxglove/ws-protocol", "foxglove.mjs", f"ws://{host}:{number}"), serve, device)
    assert said["channels"].keys() == {"/gyro/sample", "/gyro/state", "/gyro/link_stats"}
    for topic, messages in said["messages"].items():
        channel = said["channels"][topic]
        assert (channel["encoding"], channel["schemaEncoding"]) == ("json", "jsonschema")
        assert messages[0].keys() - {"timestamp"} <= channel["schema"]["properties"].keys()
    sample = said["messages"]["/gyro/sample"][-1]
    assert sample["rate_dps"] == 10.0
    assert int(sample["timestamp"]) / 1e9 == pytest.approx(sample["t_host_s"], abs=1e-3)
    assert said["messages"]["/gyro/link_stats"][0]["protocol"] in {"csv", "unknown"}
    assert "parameters" in said["capabilities"]
    before, after = said["parameters"]
    assert after == before
    assert {"filter", "config"} < {each["name"] for each in before}


def test_a_port_that_is_taken_is_told(port: Path) -> None:
    """In a process of its own, since the SDK's threads stay."""
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        with serving(port, "--output", f"foxglove:port={taken.getsockname()[1]}") as (serve, _):
            serve.until(lambda it: bool(events(it, "output_failed")), "refusal")
            assert "is taken by" in events(serve, "output_failed")[0]["reason"]


def test_who_does_not_read_keeps_the_service_from_nothing(port: Path, tmp_path: Path) -> None:
    """Neither from closing this output, nor from serving others after it."""
    config = tmp_path / "c.yaml"
    config.write_text(HDR + "outputs: [{name: foxglove, port: 0}]\n")
    with serving(port, "--config", config) as (serve, device), socket.socket() as connection:
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        host, number = address_of(serve, "foxglove")
        connection.connect((host, number))
        with connect(
            f"ws://{host}:{number}", sock=connection, subprotocols=[Subprotocol("foxglove.sdk.v1")], max_queue=1
        ) as client:
            while (told := json.loads(client.recv()))["op"] != "advertise":
                pass
            asks = [{"id": i, "channelId": each["id"]} for i, each in enumerate(told["channels"])]
            client.send(json.dumps({"op": "subscribe", "subscriptions": asks}))
            client.recv()
            for first in range(0, 10_000, 500):
                device.send_all(csv_at_100_hz(500, first=first), never)
                serve.take_lines(490)
            config.write_text(HDR + "outputs: [{name: tcp, port: 0}]\n")
            address_of(serve, "tcp")
            client.socket.shutdown(socket.SHUT_RDWR)
        assert serve.stop() == 0
