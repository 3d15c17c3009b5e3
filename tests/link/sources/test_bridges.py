"""Gyros behind real bridges: ser2net, socat, and pyserial's RFC 2217 server."""

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from itertools import pairwise
from pathlib import Path

import pytest
from bridge_support import program, pyserial_server, running, ser2net
from sources_support import Events, lines, read_until, serving
from support import Command, free_port, speaking_on

from firmware_sim.pty import PtyDevice
from gyrodrift.link.link import Link
from gyrodrift.link.options import LinkOptions
from gyrodrift.link.sources import rfc2217
from gyrodrift.values.errors import LinkError
from gyrodrift.values.sample import Sample

LINES_WITH_255 = b"#\xff\xff,\xff\n"
"""Comment of csv with bytes that Telnet doubles."""


@contextmanager
def device(port: Path, *words: str) -> Iterator[None]:
    """A simulated gyro on a pty."""
    with Command("--link", port, "--quiet", *words, module="firmware_sim") as gyro:
        gyro.until(lambda _: port.exists(), "port")
        yield


def are_whole(samples: list[Sample]) -> bool:
    """Whether no sample is missing."""
    return all(after.seq - before.seq == 1 for before, after in pairwise(samples))


def test_the_baud_rate_behind_ser2net_is_found(port: Path, tmp_path: Path) -> None:
    number, events = free_port(), Events()
    bridge = ser2net(port, "telnet(rfc2217),tcp", tmp_path, number)
    with device(port, "--fault", "wrong_baud:baud=57600,from_s=0"), bridge:
        link = Link(LinkOptions(f"rfc2217://127.0.0.1:{number}", timeout_s=0.0), events)
        samples = read_until(link, lambda samples: len(samples) > 100)
        link.close()
    assert ("protocol_found", {"protocol": "native", "baud": 57600}) in events.told
    assert are_whole(samples)


@pytest.mark.parametrize("protocol", ["native", "csv", "witmotion", "vectornav"])
def test_ser2net_is_read_as_plain_tcp(port: Path, tmp_path: Path, protocol: str) -> None:
    number, events = free_port(), Events()
    with device(port, "--protocol", protocol), ser2net(port, "tcp", tmp_path, number):
        link = Link(LinkOptions(f"tcp://127.0.0.1:{number}"), events)
        samples = read_until(link, lambda samples: len(samples) > 100)
        link.close()
    assert ("protocol_found", {"protocol": protocol}) in events.told
    assert are_whole(samples)


def test_a_ser2net_that_restarts_is_read_again(port: Path, tmp_path: Path) -> None:
    number, events = free_port(), Events()
    with device(port):
        with ser2net(port, "telnet(rfc2217),tcp", tmp_path, number):
            link = Link(LinkOptions(f"rfc2217://127.0.0.1:{number}"), events)
            read_until(link, lambda samples: len(samples) > 20)
        read_until(link, lambda _: link.port is None)
        with ser2net(port, "telnet(rfc2217),tcp", tmp_path, number):
            read_until(link, lambda samples: len(samples) > 20)
            link.close()
    assert events.names().count("link_restored") == 1
    assert link.counters.device_resets == 0


def take(gyro: PtyDevice, taken: bytearray) -> bytearray:
    """Bytes that the port has sent; a packet of a pty begins with 0 if it has data (`TIOCPKT`)."""
    with suppress(BlockingIOError):
        packet = os.read(gyro.fd, 64)
        taken += packet[1:] if packet[0] == 0 else b""
    return taken


def test_pyserials_server_changes_its_baud_rate(port: Path) -> None:
    with speaking_on(port) as gyro, pyserial_server(port) as server:
        link = Link(LinkOptions(f"rfc2217://127.0.0.1:{server.number}", baud=9600, send=b"a\xffb"), Events())
        heard: list[bytes] = []
        link.tap = lambda content, _: heard.append(content)
        sent = bytearray()
        read_until(link, lambda _: b"a\xffb" in take(gyro, sent))  # it follows the purge that ends the change
        assert server.serial.baudrate == 9600
        content = LINES_WITH_255 + lines(0, 50)
        gyro.send(content)
        samples = read_until(link, lambda samples: len(samples) == 50)
        assert b"".join(heard) == content
        assert len(samples) == 50
        link.close()


def test_a_server_without_rfc2217_is_an_error_that_names_tcp(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rfc2217, "ANSWER_S", 0.2)
    with serving() as server:
        number = server.getsockname()[1]
        with pytest.raises(LinkError, match=rf"does not answer in RFC 2217; use tcp://127.0.0.1:{number}"):
            Link(LinkOptions(f"rfc2217://127.0.0.1:{number}"), Events())


@pytest.mark.parametrize(
    ("position", "address"),
    [
        ("TCP-LISTEN:{number},bind=127.0.0.1,reuseaddr", "socket://127.0.0.1:{number}"),
        ("UDP4-SENDTO:127.0.0.1:{number}", "udp://:{number}"),
        ("UNIX-LISTEN:{folder}/socket", "unix:{folder}/socket"),
    ],
    ids=["tcp", "udp", "unix"],
)
def test_socat_brings_a_device(port: Path, tmp_path: Path, position: str, address: str) -> None:
    names = {"number": free_port(), "folder": tmp_path}
    bridge = [
        program("socat"),
        *((f"OPEN:{port},rawer", position.format(**names))[:: -1 if "LISTEN" in position else 1]),
    ]
    link = Link(LinkOptions(address.format(**names), timeout_s=0.0), Events())
    with device(port), running(bridge):
        samples = read_until(link, lambda samples: len(samples) > 100)
    link.close()
    assert are_whole(samples)


def test_a_missing_unix_socket_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(LinkError, match="there is no such socket; start the server first"):
        Link(LinkOptions(f"unix:{tmp_path}/none"), Events())
