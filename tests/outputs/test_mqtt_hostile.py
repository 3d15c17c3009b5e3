"""The output mqtt with a broker that sends what no broker sends."""

import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress

import pytest
from outputs_support import HubThread, corrected, hub
from support import PATIENCE_S, awaited

pytest.importorskip("aiomqtt", reason="the extra mqtt is not installed")

CONNACK, PINGREQ = b"\x20\x02\x00\x00", b"\xc0\x00"
CONNECT, PUBLISH, SUBSCRIBE = 0x10, 0x30, 0x80
LONGEST = b"\xff\xff\xff\x7f"
"""268 435 455, the greatest length of a packet."""

MOST_BYTES = 32 << 20
"""More bytes than the kernel holds on both sides."""


def published(topic: bytes, payload: bytes, qos: int = 0, packet: int = 1) -> bytes:
    """A PUBLISH of less than 128 bytes."""
    body = len(topic).to_bytes(2, "big") + topic + (packet.to_bytes(2, "big") if qos else b"") + payload
    return bytes([PUBLISH | qos << 1, len(body)]) + body


class HostileBroker:
    """Takes one client after the other as a broker would, then sends a flood and reads no more.

    sent_bytes, connections
        Of the flood of the last connection, and so far.
    """

    def __init__(self, flood: bytes, *, is_polite: bool = True) -> None:
        self.sent_bytes = self.connections = 0
        self._flood, self._is_polite = flood, is_polite
        self._is_over = threading.Event()
        self._listening = socket.create_server(("127.0.0.1", 0))
        self._listening.settimeout(0.1)
        self.port = self._listening.getsockname()[1]
        self._thread = threading.Thread(target=self._run)
        self._thread.start()

    def close(self) -> None:
        """The end."""
        self._is_over.set()
        self._thread.join()
        self._listening.close()

    def _run(self) -> None:
        while not self._is_over.is_set():
            with suppress(OSError):
                connection, _ = self._listening.accept()
                with connection:
                    connection.settimeout(0.1)
                    self.connections += 1
                    self.sent_bytes = 0
                    self._serve(connection)

    def _serve(self, connection: socket.socket) -> None:
        if self._is_polite:
            self._welcome(connection)
        while not self._is_over.is_set() and self.sent_bytes < 2 * MOST_BYTES:
            with suppress(TimeoutError):
                self.sent_bytes += connection.send(self._flood[self.sent_bytes % len(self._flood) :])

    def _welcome(self, connection: socket.socket) -> None:
        """Answer until the client has subscribed."""
        connection.settimeout(PATIENCE_S)
        with connection.makefile("rb") as reading:
            kind = 0
            while kind != SUBSCRIBE:
                head = reading.read(2)  # what this client sends first is shorter than 128 bytes
                kind, body = head[0] & 0xF0, reading.read(head[1])
                if kind == CONNECT:
                    connection.sendall(CONNACK)
                elif kind == PUBLISH:
                    topic_end = 2 + int.from_bytes(body[:2], "big")
                    connection.sendall(b"\x40\x02" + body[topic_end : topic_end + 2])
                elif kind == SUBSCRIBE:
                    connection.sendall(b"\x90\x03" + body[:2] + b"\x00")
        connection.settimeout(0.1)


@contextmanager
def broker(flood: bytes, *, is_polite: bool = True) -> Iterator[HostileBroker]:
    running = HostileBroker(flood, is_polite=is_polite)
    try:
        yield running
    finally:
        running.close()


FLOODS = [
    (b"\x30" + LONGEST + b"x" * 65536, "a packet of 2"),
    (b"\x90" + LONGEST + b"x" * 65536, "a packet of 2"),
    (PINGREQ * 5000, "packets"),
    (b"".join(published(b"a/b", b"x" * 50, 2, packet) for packet in range(1, 5000)), "packets"),
    (published(b"homeassistant/status", b"online") * 5000, "packets a second"),
    (published(b"homeassistant/status", b"online", 1) * 5000, "packets"),
    (b"\xf0\x00" * 5000, "the connection to the broker is lost"),
    (published(b"\xff\xfe", b"x") * 5000, "the broker"),
]


def problem_of(outputs: HubThread) -> str:
    return next((statuse.problem for statuse in outputs.statuses()), "")


@pytest.mark.promise(
    "Clients of outputs",
    "an MQTT broker that sends packets above 16 KiB, or about 250 packets a second, is disconnected and "
    "tried again later",
)
@pytest.mark.parametrize(("flood", "problem"), FLOODS, ids=range(len(FLOODS)))
def test_a_broker_that_sends_too_much_is_left(flood: bytes, problem: str) -> None:
    with broker(flood) as hostile, hub() as outputs:
        outputs.want(f"mqtt:port={hostile.port},id=bench,rate_hz=100")
        until_s = time.monotonic() + PATIENCE_S
        while problem not in (result := problem_of(outputs)):
            outputs.samples([corrected(1)])
            assert time.monotonic() < until_s, result
        assert hostile.sent_bytes < MOST_BYTES


@pytest.mark.promise("Clients of outputs")
def test_a_broker_that_is_hostile_from_the_first_byte_is_left(monkeypatch: pytest.MonkeyPatch) -> None:
    """A broker that is hostile from the first byte is disconnected and tried again later."""
    monkeypatch.setattr("gyrodrift.outputs.mqtt.ANSWER_S", 1.0)
    with broker(b"\x20" + LONGEST + b"x" * 65536, is_polite=False) as hostile, hub() as outputs:
        outputs.want(f"mqtt:port={hostile.port},id=bench")
        awaited(lambda: problem_of(outputs), lambda problem: "a packet of 2" in problem)
        assert hostile.sent_bytes < MOST_BYTES
