"""Peers that answer wrongly or never stop: the cost stays bounded, and the log names the reason once."""

import resource
import socket
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress

import pytest
from sources_support import PATIENCE_S, Events, Host, address, lines, read_until, serving

from gyrodrift.link.link import Link
from gyrodrift.link.options import LinkOptions
from gyrodrift.link.sources import rfc2217, stream_channel
from gyrodrift.link.sources.rfc2217 import Rfc2217Port, open_rfc2217
from gyrodrift.link.sources.source import SourceAddress
from gyrodrift.link.sources.stream_channel import StreamChannel
from gyrodrift.values.errors import LinkError, UsageError

FLOOD = b"x" * (1 << 16)


@contextmanager
def peer(answer: Callable[[socket.socket], None]) -> Iterator[socket.socket]:
    """A server on this machine that treats each connection in this way, until it is closed."""

    def serve(server: socket.socket) -> None:
        with suppress(OSError):
            while True:
                connection, _ = server.accept()
                with connection, suppress(OSError):
                    answer(connection)

    with serving() as server:
        thread = threading.Thread(target=serve, args=(server,))
        thread.start()
        try:
            yield server
        finally:
            server.shutdown(socket.SHUT_RDWR)
            thread.join()


def hear_and_close(connection: socket.socket) -> None:
    """Wait for a request, and do not answer it."""
    connection.recv(4096)
    time.sleep(0.1)


def flood(connection: socket.socket) -> None:
    """Send for ever."""
    while True:
        connection.sendall(FLOOD)


def test_a_peer_that_closes_at_once_is_called_less_and_less() -> None:
    with peer(lambda _: None) as server, Host(address(server), timeout_s=0.0) as host:
        until_s = host.now_s + 30.0
        while host.now_s < until_s:
            assert host.read(0.01 if host.link.connection._reopening is None else 0.0) == []
            time.sleep(1e-4)
    assert 5 < host.link.counters.reconnects < 25
    assert host.link.counters.gone_s <= 30.0
    assert host.names().count("link_lost") < 25


def test_a_connection_that_brought_samples_is_opened_again_soon() -> None:
    """The wait starts again at its shortest."""
    events = Events()
    with serving() as server:
        link = Link(LinkOptions(address(server), timeout_s=0.0), events)
        for first in (0, 100, 200):
            connection, _ = server.accept()
            with connection:
                connection.sendall(lines(first, 50))
                read_until(link, lambda samples: len(samples) >= 49)
            read_until(link, lambda _: link.port is None)
            assert link.wake_s() <= 0.05
            read_until(link, lambda _: link.port is not None)
        link.close()
    assert link.counters.gone_s < 20.0


def test_a_reason_of_refusal_is_told_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """A server that does not speak RFC 2217 refuses each attempt, for days."""
    monkeypatch.setattr(rfc2217, "ANSWER_S", 0.05)
    events = Events()
    calls: list[int] = []

    def refuse(connection: socket.socket) -> None:
        calls.append(connection.fileno())
        hear_and_close(connection)

    with peer(refuse) as server:
        name = address(server).replace("tcp", "rfc2217")
        link = Link(LinkOptions(name, timeout_s=0.0), events)
        until_s = time.monotonic() + PATIENCE_S
        while len(calls) < 4:
            assert time.monotonic() < until_s
            assert link.read() == []
            time.sleep(0.01)
        link.close()
    assert events.names() == ["link_refused"]


@pytest.mark.parametrize("scheme", ["tcp", "rfc2217", "udp", "ws", "mavlink:tcp"])
def test_a_password_in_an_address_is_refused_and_not_repeated(scheme: str) -> None:
    with pytest.raises(UsageError, match="knows no users") as refused:
        SourceAddress(f"{scheme}://ann:tulip@host:7000", scheme, "ann:tulip@host:7000").host_port()
    assert "tulip" not in str(refused.value)


@pytest.mark.parametrize("port", ["0", "65536", "000080999", "00000000080", "+80", "٣٣"])
def test_only_port_numbers_of_tcp_are_taken(port: str) -> None:
    with pytest.raises(UsageError, match="a port from 1 to 65535"):
        SourceAddress(f"tcp://host:{port}", "tcp", f"host:{port}").host_port()


def test_an_answer_that_comes_drop_by_drop_has_a_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stream_channel, "ANSWER_S", 0.3)
    near, far = socket.socketpair()
    over = threading.Event()

    def drip() -> None:
        while not over.wait(0.02):
            far.send(b"A")

    thread = threading.Thread(target=drip)
    thread.start()
    try:
        channel = StreamChannel("ws://peer", near)
        with pytest.raises(LinkError, match=r"does not answer within 0\.3 s"):
            b"".join(iter(channel.wait, b""))
    finally:
        over.set()
        thread.join()
        near.close()
        far.close()


def test_a_flood_before_the_answer_costs_no_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    """Bytes of a server that never accepts RFC 2217 are not kept."""
    monkeypatch.setattr(rfc2217, "ANSWER_S", 0.5)
    before_kib = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with peer(flood) as server:
        name = address(server).replace("tcp", "rfc2217")
        with pytest.raises(LinkError, match="does not answer in RFC 2217"):
            open_rfc2217(SourceAddress(name, "rfc2217", name.partition("://")[2]))
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before_kib < 8 << 10


def test_an_option_is_declined_once() -> None:
    """A peer that repeats its wish would get as many answers, each a call of the system."""
    near, far = socket.socketpair()
    with far:
        port = Rfc2217Port("rfc2217://peer", near)
        far.recv(4096)
        far.sendall(b"\xff\xfd\x63" * 500 + b"x")
        assert port.read() == b"x"
        port.close()
        assert far.recv(4096) == b"\xff\xfc\x63"
