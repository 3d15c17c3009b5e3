"""Sources tcp and udp: real sockets on this machine."""

import socket
import time
from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from sources_support import PATIENCE_S, Events, Host, address, lines, read_until, serving

from gyrodrift.link.link import Link
from gyrodrift.link.options import LinkOptions
from gyrodrift.link.sources import udp as udp_module
from gyrodrift.link.sources.registry import address_of
from gyrodrift.link.sources.udp import UdpPort, open_udp
from gyrodrift.values.errors import DeviceSilentError, PortBusyError, PortMissingError


def test_a_tcp_server_is_read_like_a_cable() -> None:
    """Detected, with all samples, and without a baud rate."""
    events = Events()
    with serving() as server:
        link = Link(LinkOptions(address(server)), events)
        connection, _ = server.accept()
        with connection:
            connection.sendall(lines(0, 300))
            samples = read_until(link, lambda samples: len(samples) == 300)
        link.close()
    assert [sample.seq for sample in samples] == list(range(300))
    assert ("protocol_found", {"protocol": "csv"}) in events.told
    assert link.baud == 0


def test_a_server_that_comes_back_is_read_again(monkeypatch: pytest.MonkeyPatch) -> None:
    events, away_s = Events(), [0.0]
    with serving() as server:
        link = Link(LinkOptions(address(server)), events, lambda: time.monotonic() + away_s[0])
        port = server.getsockname()[1]
        connection, _ = server.accept()
        with connection:
            connection.sendall(lines(0, 100))
            read_until(link, lambda samples: len(samples) == 100)
    read_until(link, lambda _: link.port is None)
    with monkeypatch.context() as patched:
        patched.setattr(time, "sleep", lambda _: pytest.fail("a read waits"))
        for _ in range(50):
            assert link.read() == []
            away_s[0] += 0.01
    with serving(port) as server:
        read_until(link, lambda _: link.port is not None)
        connection, _ = server.accept()
        with connection:
            connection.sendall(lines(150, 100))
            samples = read_until(link, lambda samples: len(samples) >= 99)
        link.close()
    assert samples[-1].t_device_s == pytest.approx(2.49)
    assert link.counters.reconnects == 1
    assert events.names().count("link_restored") == 1


def test_a_server_that_is_not_there_is_an_error() -> None:
    with serving() as server:
        name = address(server)
    with pytest.raises(PortMissingError, match=rf"{name}: nothing listens on port \d+ of 127.0.0.1; start the server"):
        Link(LinkOptions(name), Events())


def test_an_unknown_name_is_an_error() -> None:
    with pytest.raises(PortMissingError, match=r"the name 'gyro.invalid' is not known; check its spelling"):
        Link(LinkOptions("tcp://gyro.invalid:1"), Events())


def test_without_a_timeout_the_link_waits_for_a_server() -> None:
    events = Events()
    with serving() as server:
        name, port = address(server), server.getsockname()[1]
    link = Link(LinkOptions(name, timeout_s=0.0), events)
    assert link.port is None
    with serving(port) as server:
        read_until(link, lambda _: link.port is not None)
        link.close()
    assert events.names() == ["link_refused", "link_open"]
    assert link.counters.reconnects == 0


def test_a_silent_server_is_an_error_with_advice() -> None:
    silence = pytest.raises(DeviceSilentError, match="sent nothing within 3 s; the server accepted the connection")
    with serving() as server, Host(address(server), timeout_s=3.0) as host, silence:
        host.read(3.0)


def test_noise_from_a_server_is_not_blamed_on_a_baud_rate_of_this_machine() -> None:
    with serving() as server, Host(address(server), timeout_s=3.0) as host:
        connection, _ = server.accept()
        with connection:
            connection.sendall(bytes(range(128, 256)) * 4)
            read_until(host.link, lambda _: host.link.counters.bytes == 512)
            with pytest.raises(DeviceSilentError, match=r"512 bytes arrived .* baud rate of a serial line behind it"):
                host.read(3.0)


def test_what_is_sent_at_the_opening_reaches_the_server() -> None:
    with serving() as server:
        link = Link(LinkOptions(address(server), send=b"start\r\n"), Events())
        connection, _ = server.accept()
        with connection:
            assert connection.recv(100) == b"start\r\n"
        link.close()


@pytest.fixture
def udp() -> Iterator[tuple[UdpPort, tuple[str, int]]]:
    """A source udp on a free port, and its address."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        target = free.getsockname()
    parsed = address_of(f"udp://:{target[1]}")
    assert parsed is not None
    port = open_udp(parsed)
    yield port, target
    port.close()


@contextmanager
def sender() -> Iterator[socket.socket]:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as device:
        device.bind(("127.0.0.1", 0))
        yield device


def test_datagrams_are_heard_on_this_machine_alone(udp: tuple[UdpPort, tuple[str, int]]) -> None:
    assert udp[0]._bound.getsockname()[0] == "127.0.0.1"


def test_a_text_without_line_end_is_a_line(udp: tuple[UdpPort, tuple[str, int]]) -> None:
    port, target = udp
    with sender() as device:
        for content in (b"1000,0.5", b"2000,0.5\r\n", "3000,0.5°".encode()):
            device.sendto(content, target)
        assert port.read() == "1000,0.5\n2000,0.5\r\n3000,0.5°\n".encode()


def test_binary_datagrams_are_not_changed(udp: tuple[UdpPort, tuple[str, int]]) -> None:
    """A frame may look like text by chance."""
    port, target = udp
    with sender() as device:
        for content in (b"\x00\x01UR", b"URabcdefghi"):
            device.sendto(content, target)
        assert port.read() == b"\x00\x01URURabcdefghi"


@pytest.mark.promise("Unplugged and silent devices")
def test_the_first_sender_of_samples_is_followed_and_no_other(udp: tuple[UdpPort, tuple[str, int]]) -> None:
    """A second sender is not heard while the first one sends samples, also if it was there before; it is told once."""
    port, target = udp
    now_s, events = 1000.0, Events()
    link = Link(LinkOptions(port.path, columns="t_ms,rate:dps"), events, lambda: now_s, port)
    port._monotonic = lambda: now_s
    rates: list[float] = []
    with sender() as stranger, sender() as gyro, sender() as second:
        for number in range(30):
            stranger.sendto(b"x", target)
            gyro.sendto(b"%d,1.5" % (number * 100), target)
            if number:
                second.sendto(b"%d,7.5" % (number * 100), target)
            for _ in range(4):
                rates += [sample.rate_dps for sample in link.read()]
            now_s += 0.1
        assert rates == [1.5] * 30
        told = [fields for event, fields in events.told if event == "other_sender"]
        assert [fields["followed"] for fields in told] == [f"127.0.0.1:{gyro.getsockname()[1]}"]
        now_s += 1.8  # 1.9 s after its last sample
        second.sendto(b"4800,7.5", target)
        assert link.read() == []
        now_s += 0.11
        second.sendto(b"4900,7.5", target)
        second.sendto(b"5000,7.5", target)
        assert [sample.rate_dps for sample in link.read()] == [7.5, 7.5]


def test_what_is_sent_goes_to_the_device_that_was_heard(udp: tuple[UdpPort, tuple[str, int]]) -> None:
    port, target = udp
    assert port.write(b"start") == 0
    with sender() as device:
        device.settimeout(PATIENCE_S)
        device.sendto(b"1\n", target)
        port.read()
        assert port.write(b"start") == 5
        assert device.recv(100) == b"start"


def test_a_flood_does_not_hold_the_loop(udp: tuple[UdpPort, tuple[str, int]], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(udp_module, "DATAGRAMS_PER_TURN", 64)
    port, target = udp
    with sender() as device:
        for _ in range(150):
            device.sendto(b"1\n", target)
        counts = [len(port.read()) // 2 for _ in range(4)]
        monkeypatch.setattr(udp_module, "BYTES_PER_TURN", 1500)
        for _ in range(4):
            device.sendto(b"1" * 999 + b"\n", target)
        sizes = [len(port.read()) for _ in range(3)]
    assert counts == [64, 64, 22, 0]
    assert sizes == [2000, 2000, 0]


@pytest.mark.promise("Samples")
def test_a_stall_of_the_network_is_no_gap(udp: tuple[UdpPort, tuple[str, int]]) -> None:
    """A burst after a stall of the network makes no gap and no step in time."""
    port, target = udp
    now_s, events = 1000.0, Events()
    link = Link(LinkOptions(port.path, columns="rate:dps"), events, lambda: now_s, port)
    samples = []
    with sender() as device:
        for _ in range(400):
            device.sendto(b"0.5", target)
            now_s += 0.01
            samples += link.read()
        for _ in range(120):
            device.sendto(b"0.5", target)
        now_s += 1.2
        samples += link.read()
    assert "gap" not in events.names()
    assert samples[-1].t_device_s == pytest.approx(5.19, abs=0.02)


def test_a_port_that_is_taken_is_an_error(udp: tuple[UdpPort, tuple[str, int]]) -> None:
    parsed = address_of(udp[0].path)
    assert parsed is not None
    with pytest.raises(PortBusyError, match=r"another program listens on UDP port \d+; stop it, or use another port"):
        open_udp(parsed)


def test_a_foreign_address_cannot_be_listened_on() -> None:
    parsed = address_of("udp://192.0.2.1:5000")
    assert parsed is not None
    with pytest.raises(PortMissingError, match=r"192.0.2.1 is not an address of this machine"):
        open_udp(parsed)
