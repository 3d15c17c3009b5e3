"""Odd requests to every port that speaks HTTP: none is an error of the server, and the port goes on."""

import socket
from collections.abc import Iterator

import pytest
import structlog
from outputs_support import HubThread, hub
from support import PATIENCE_S

SERVERS = ("web", "prometheus", "rosbridge", "foxglove", "networktables")
PACKAGES = ("websockets", "prometheus_client", "ntcore", "msgpack")

UPGRADE = (
    b"Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
    b"Sec-WebSocket-Version: 13\r\n"
)

REQUESTS = [
    b"POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 3\r\n\r\nabc",
    b"POST /metrics HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\nffffffff\r\n",
    b"HEAD /metrics HTTP/1.1\r\nHost: localhost\r\n\r\n",
    b"OPTIONS * HTTP/1.1\r\nHost: localhost\r\n\r\n",
    b"GET / HTTP/0.9\r\n\r\n",
    b"GET /\r\n\r\n",
    b"GET //[ HTTP/1.1\r\nHost: [::\r\n\r\n",
    b"GET /%ff%00?%ff HTTP/1.1\r\nHost: localhost\r\n\r\n",
    b"GET /nt/%ff HTTP/1.1\r\nHost: localhost\r\n\r\n",
    b"GET /\xff\xfe HTTP/1.1\r\nHost: \xff\r\n\r\n",
    b'GET /metrics HTTP/1.1\r\nHost: localhost\r\nHost: localhost\r\nAccept: \xb2;version="\\"\r\nAccept: ,\r\n\r\n',
    b"GET /metrics HTTP/1.1\r\nHost: localhost\r\nAccept: application/openmetrics-text;version=\xb2\r\n\r\n",
    b"GET /metrics HTTP/1.1\r\nHost: localhost\r\nAccept-Encoding: gzip;q=x, \x01\r\n\r\n",
    b"GET / HTTP/1.1\r\nHost: localhost\r\n" + b"X: y\r\n" * 500 + b"\r\n",
    b"GET / HTTP/1.1\r\nHost: localhost\r\nX: " + b"y" * 20_000 + b"\r\n\r\n",
    b"GET /" + b"a" * 20_000 + b" HTTP/1.1\r\nHost: localhost\r\n\r\n",
    b"GET / HTTP/1.1\r\nHost localhost\r\n: \r\n\r\n",
    b"GET /stream HTTP/1.1\r\nHost: localhost\r\nOrigin: null\r\n" + UPGRADE + b"\r\n",
    b"GET /nt/x HTTP/1.1\r\nHost: localhost\r\nSec-WebSocket-Protocol: \xff,,\r\n" + UPGRADE + b"\r\n",
    b'GET /nt/x HTTP/1.1\r\nHost: localhost\r\nSec-WebSocket-Extensions: ;="\r\n' + UPGRADE + b"\r\n",
    b"GET /nt/x HTTP/1.1\r\nHost: localhost\r\nAuthorization: Basic \xff\r\nOrigin: \xff\r\n" + UPGRADE + b"\r\n",
    b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03",
    b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n",
    b"\r\n\r\n",
]


@pytest.fixture(scope="module")
def ports() -> Iterator[tuple[HubThread, list[int], list[structlog.typing.EventDict]]]:
    """All of the servers on one loop, and the log."""
    for package in PACKAGES:
        pytest.importorskip(package)
    with structlog.testing.capture_logs() as logged, hub() as outputs:
        outputs.want(*(f"{name}:port=0" for name in SERVERS))
        addresses = [item.address for item in outputs.opened(len(SERVERS))]
        yield outputs, [int(address.rpartition(":")[2].rstrip("/")) for address in addresses], logged


Ports = tuple[HubThread, list[int], list[structlog.typing.EventDict]]


@pytest.mark.promise("Clients of outputs")
@pytest.mark.parametrize("request_bytes", REQUESTS, ids=range(len(REQUESTS)))
def test_no_request_is_an_error_of_the_server(ports: Ports, request_bytes: bytes) -> None:
    """No HTTP request causes a server error."""
    outputs, numbers, logged = ports
    for number in numbers:
        with socket.create_connection(("127.0.0.1", number), PATIENCE_S) as client:
            client.sendall(request_bytes)
            client.shutdown(socket.SHUT_WR)
            answer = _answered(client)
        assert not answer or answer.startswith((b"HTTP/1.1 1", b"HTTP/1.1 2", b"HTTP/1.1 4")), answer[:200]
    assert not [item for item in logged if item["log_level"] == "error" or "please report" in str(item.get("reason"))]
    assert all(statuse.address for statuse in outputs.statuses())


def _answered(client: socket.socket) -> bytes:
    answer = b""
    try:
        while piece := client.recv(1 << 16):
            answer += piece
    except ConnectionError:
        pass  # what was not read makes a reset of the end
    return answer
