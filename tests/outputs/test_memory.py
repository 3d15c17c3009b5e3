"""Memory of the outputs' process: clients that have gone leave nothing behind."""

from pathlib import Path
from typing import Any

import pytest
from outputs_support import address_of, csv_at_100_hz, serving
from support import PATIENCE_S, never
from websockets.sync.client import connect

from gyrodrift.service.output_feed import memory_bytes

WARM, CLIENTS = 60, 150
MOST_GROWN_BYTES = 10 << 20
"""22 KiB for each of 450 clients: far above what an allocator keeps, far below the buffers of one client."""

OUTPUTS: dict[str, Any] = {"web": None, "rosbridge": None, "foxglove": ["foxglove.sdk.v1"]}


PATHS = {"web": "/stream"}


@pytest.mark.promise("Memory and the end")
def test_memory_is_flat_over_hundreds_of_websocket_clients(port: Path) -> None:
    """Hundreds of WebSocket clients leave no memory in use."""
    options = [word for name in OUTPUTS for word in ("--output", f"{name}:port=0")]
    with serving(port, *options) as (serve, device):
        addresses = {name: address_of(serve, name) for name in OUTPUTS}
        device.send_all(csv_at_100_hz(101), never)
        serve.take_lines(100)
        (child,) = Path(f"/proc/{serve.process.pid}/task/{serve.process.pid}/children").read_text().split()
        for _ in range(WARM):
            come_and_go(addresses)
        before = memory_bytes(int(child))
        for _ in range(CLIENTS):
            come_and_go(addresses)
        assert memory_bytes(int(child)) - before < MOST_GROWN_BYTES


def come_and_go(addresses: dict[str, tuple[str, int]]) -> None:
    """One client of each output."""
    for name, (_, number) in addresses.items():
        with connect(
            f"ws://127.0.0.1:{number}{PATHS.get(name, '')}", subprotocols=OUTPUTS[name], open_timeout=PATIENCE_S
        ) as client:
            if name == "rosbridge":
                client.send('{"op": "call_service", "service": "/rosapi/topics", "id": "1"}')
            client.recv(PATIENCE_S)
