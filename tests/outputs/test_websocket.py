"""The WebSocket server that outputs build on, with a real client and with hostile ones."""

import gc
import socket
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from typing import ClassVar
from weakref import WeakSet

import pytest
from outputs_support import HubThread, corrected, hub
from support import PATIENCE_S
from websockets.exceptions import ConnectionClosed, WebSocketException
from websockets.sync.client import ClientConnection, connect

from gyrodrift.outputs.net.limits import Allowance, Limits
from gyrodrift.outputs.net.websocket import WebSocketClient, WebSocketServer, WebSocketSession
from gyrodrift.outputs.options import Port
from gyrodrift.outputs.output import Output, OutputHost
from gyrodrift.outputs.registry import OutputKind, register, unregister
from gyrodrift.values.sample import Corrected

LIMITS = Limits(clients=4, message_bytes=1000, messages_per_s=10.0, handshake_s=0.3, queue_bytes=100_000)


@dataclass(frozen=True, slots=True)
class EchoOptions:
    port: Port = 0


class EchoSession(WebSocketSession):
    """`alive` has the clients that something still holds."""

    alive: ClassVar[WeakSet[WebSocketClient]] = WeakSet()

    def __init__(self, client: WebSocketClient) -> None:
        self._client = client
        self.alive.add(client)

    def message(self, content: str | bytes) -> None:
        if content == "bad":
            raise ValueError("bad is refused")
        self._client.send(content)

    def dropped(self, messages: int) -> str:
        return f"missed {messages}"


class EchoOutput(Output[EchoOptions]):
    """Says what it hears, and the counter of each sample."""

    options_type = EchoOptions
    padding: ClassVar[str] = "." * 1000

    def __init__(self, options: EchoOptions, host: OutputHost) -> None:
        super().__init__(options, host)
        self._server = WebSocketServer(EchoSession, host.log, limits=LIMITS)

    async def open(self) -> None:
        self.address = await self._server.listen("127.0.0.1", self.options.port)

    def take(self, samples: Sequence[Corrected]) -> None:
        for client in self._server.clients:
            for sample in samples:
                client.send(f"{sample.sample.seq} {self.padding}")

    def counts(self) -> tuple[int, int]:
        return self._server.counts()

    async def close(self) -> None:
        await self._server.close()


@pytest.fixture
def echo() -> Iterator[tuple[HubThread, tuple[str, int]]]:
    register(OutputKind("echo", "", f"{__name__}:EchoOutput"))
    try:
        with hub("echo") as outputs:
            yield outputs, outputs.endpoint()
    finally:
        unregister("echo")


Echo = tuple[HubThread, tuple[str, int]]


def joined(address: tuple[str, int]) -> ClientConnection:
    return connect(f"ws://{address[0]}:{address[1]}", compression=None)


def say(client: ClientConnection, messages: list[str]) -> None:
    """Send them, and read until the connection ends."""
    for message in messages:
        client.send(message)
    while True:
        client.recv(PATIENCE_S)


def is_closed(connection: socket.socket) -> bool:
    """Whether the other end has let go, kindly or not."""
    try:
        return connection.recv(1) == b""
    except ConnectionError:
        return True


def test_text_and_bytes_go_both_ways(echo: Echo) -> None:
    _, address = echo
    with joined(address) as client:
        client.send("text")
        client.send(b"bytes")
        assert (client.recv(PATIENCE_S), client.recv(PATIENCE_S)) == ("text", b"bytes")


@pytest.mark.parametrize(
    ("messages", "why"),
    [(["bad"], "bad is refused"), (["x"] * 20, "more than 10 messages a second"), (["x" * 2000], "")],
)
def test_what_is_refused_closes_the_connection_with_the_reason(echo: Echo, messages: list[str], why: str) -> None:
    outputs, address = echo
    with joined(address) as second, joined(address) as client:
        with pytest.raises(ConnectionClosed) as closed:
            say(client, messages)
        assert closed.value.rcvd is not None
        assert why in closed.value.rcvd.reason
        outputs.samples([corrected(1)])
        assert str(second.recv(PATIENCE_S)).startswith("1 ")


def test_half_a_handshake_is_cut_off_and_garbage_is_answered(echo: Echo) -> None:
    """The one after its time, the others at once."""
    _, address = echo
    with ExitStack() as stack:
        half, noise, page = (stack.enter_context(socket.create_connection(address, PATIENCE_S)) for _ in range(3))
        half.sendall(b"GET / HTTP/1.1\r\nUpgr")
        noise.sendall(b"\x16\x03\x01\x00\xff garbage\r\n\r\n")
        page.sendall(b"GET / HTTP/1.1\r\nHost: here\r\n\r\n")
        assert page.recv(100).startswith(b"HTTP/1.1 426")
        assert is_closed(noise)
        assert is_closed(half)


def test_too_many_connections_are_cut_off_before_their_handshake(echo: Echo) -> None:
    _, address = echo
    with ExitStack() as many, joined(address) as client:
        crowd = [many.enter_context(socket.create_connection(address, PATIENCE_S)) for _ in range(100)]
        assert is_closed(crowd[-1])
        client.send("still here")
        assert client.recv(PATIENCE_S) == "still here"


def test_as_many_clients_as_the_limit_come_in_and_no_more(echo: Echo) -> None:
    _, address = echo
    with ExitStack() as there:
        for _ in range(LIMITS.clients):
            client = there.enter_context(joined(address))
            client.send("in")
            assert client.recv(PATIENCE_S) == "in"
        with pytest.raises((OSError, EOFError, WebSocketException)):
            joined(address)


def test_clients_that_are_gone_leave_nothing_behind(echo: Echo) -> None:
    outputs, address = echo
    for number in range(3 * LIMITS.clients):
        with joined(address) as client:
            client.send(str(number))
            assert client.recv(PATIENCE_S) == str(number)
    until_s = time.monotonic() + PATIENCE_S
    while EchoSession.alive and time.monotonic() < until_s:
        time.sleep(0.01)
        gc.collect()
    assert len(EchoSession.alive) == 0
    while (sent := outputs.statuses()[0].sent) < 3 * LIMITS.clients:
        assert time.monotonic() < until_s, sent


def test_who_was_silent_for_an_hour_may_not_send_an_hours_messages() -> None:
    now_s = 0.0
    allowance = Allowance(10.0, lambda: now_s)
    now_s = 3600.0
    assert [allowance.take() for _ in range(11)] == [True] * 10 + [False]
    now_s += 0.125
    assert [allowance.take() for _ in range(2)] == [True, False]


def test_a_client_that_does_not_read_loses_the_oldest_and_is_told(echo: Echo) -> None:
    outputs, address = echo
    count = 20_000
    with joined(address) as client:
        client.send("hello")
        assert client.recv(PATIENCE_S) == "hello"
        for first in range(0, count, 500):
            outputs.samples([corrected(seq) for seq in range(first, first + 500)])
        got: list[int] = []
        missed = 0
        while not got or got[-1] < count - 1:
            word, number = str(client.recv(PATIENCE_S)).split()[:2]
            if word == "missed":
                missed += int(number)
            else:
                got.append(int(word))
        assert missed > 0
        assert got == sorted(got)
        assert len(got) + missed == count
