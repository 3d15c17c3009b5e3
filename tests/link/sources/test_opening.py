"""Opening of sources: in the background, names that are not there yet, missing packages, and devices that are found."""

import socket
import threading
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from sources_support import Events, address, lines, read_until, serving
from support import PATIENCE_S, Command, python_in

from gyrodrift.link import connection as connection_module
from gyrodrift.link.link import Link
from gyrodrift.link.options import LinkOptions
from gyrodrift.link.search import find_gyro
from gyrodrift.link.serial_port import SerialPort
from gyrodrift.link.sources import registry
from gyrodrift.link.sources.opening import BackgroundOpening
from gyrodrift.link.sources.source import ByteSource, SourcePort
from gyrodrift.values.errors import LinkError, PortMissingError, UsageError


def test_an_opening_that_takes_long_keeps_nobody_waiting() -> None:
    """The port is there when it is open."""
    may_open, port = threading.Event(), SourcePort("slow", None)

    def opened() -> SourcePort:
        may_open.wait(PATIENCE_S)
        return port

    opening = BackgroundOpening(opened)
    assert opening.result() is None
    may_open.set()
    while (result := opening.result()) is None:
        pass
    assert result is port


def test_a_port_that_opens_too_late_is_closed() -> None:
    may_open, closed = threading.Event(), threading.Event()

    class LatePort(SourcePort):
        def close(self) -> None:
            closed.set()

    def opened() -> SourcePort:
        may_open.wait(PATIENCE_S)
        return LatePort("late", None)

    BackgroundOpening(opened).abandon()
    may_open.set()
    assert closed.wait(PATIENCE_S)


def test_any_error_of_an_opening_is_one_of_the_link() -> None:
    def fails() -> SourcePort:
        raise KeyError("library")

    opening = BackgroundOpening(fails)
    opening.wait(PATIENCE_S)
    with pytest.raises(LinkError, match="it cannot be opened: KeyError: 'library'"):
        opening.result()


def test_a_host_that_does_not_answer_holds_no_start(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(connection_module, "SOON_S", 0.01)
    may_fail = threading.Event()

    def resolve(*_: Any, **__: Any) -> Any:
        may_fail.wait(PATIENCE_S)
        raise socket.gaierror(socket.EAI_NONAME, "not known")

    monkeypatch.setattr(socket, "getaddrinfo", resolve)
    events = Events()
    link = Link(LinkOptions("tcp://gyro.local:1", timeout_s=0.0), events)
    assert (link.port, events.told, link.read()) == (None, [], [])
    may_fail.set()
    read_until(link, lambda _: "link_refused" in events.names())
    for _ in range(20):
        link.read()
        time.sleep(0.01)
    link.close()
    assert events.names() == ["link_refused"]


def test_a_name_that_comes_later_is_waited_for(monkeypatch: pytest.MonkeyPatch) -> None:
    """A robot boots before its network; without a timeout the link waits."""
    real, is_known = socket.getaddrinfo, threading.Event()

    def resolve(host: str, *words: Any, **named: Any) -> Any:
        if not is_known.is_set():
            raise socket.gaierror(socket.EAI_NONAME, "not known")
        return real("127.0.0.1", *words, **named)

    monkeypatch.setattr(socket, "getaddrinfo", resolve)
    events = Events()
    with serving() as server:
        link = Link(LinkOptions(f"tcp://gyro.local:{server.getsockname()[1]}", timeout_s=0.0), events)
        assert link.read() == []
        is_known.set()
        read_until(link, lambda _: link.port is not None)
        connection, _ = server.accept()
        with connection:
            connection.sendall(lines(0, 50))
            assert len(read_until(link, lambda samples: len(samples) == 50)) == 50
        link.close()
    assert events.names()[:2] == ["link_refused", "link_open"]


@pytest.fixture
def fifo() -> Iterator[ByteSource]:
    """The source of the how-to, which is then taken away."""
    module: dict[str, Any] = {}
    exec(python_in("extending-source.md")[0], module)
    source: ByteSource = module["FIFO"]
    registry.register(source)
    yield source
    registry.unregister(source.scheme)


def test_a_missing_package_is_said_with_the_command_that_installs_it(fifo: ByteSource) -> None:
    registry.unregister("fifo")
    registry.register(replace(fifo, packages=("no_such_package",), extra="lab"))
    with pytest.raises(UsageError, match=r"source fifo needs the package no_such_package: .*install.*\[lab\]"):
        Link(LinkOptions("fifo:x"), Events())


def test_an_address_without_its_own_baud_rate_refuses_one() -> None:
    with serving() as server, pytest.raises(UsageError, match="this source has no baud rate; leave out --baud"):
        Link(LinkOptions(address(server), baud=9600), Events())


def test_devices_of_sources_are_listed_and_found(fifo: ByteSource, tmp_path: Path) -> None:
    pipe = SerialPort(f"fifo:{tmp_path}/none", str(tmp_path), product="pipe")
    registry.unregister("fifo")
    registry.register(replace(fifo, devices=lambda: [pipe]))
    assert pipe in registry.source_devices()
    events = Events()
    with pytest.raises(PortMissingError, match=r"no gyro found.*\nfifo:.*: No such file or directory"):
        find_gyro([], LinkOptions("auto"), events, devices=[pipe])
    assert ("port_search", {"ports": 1}) in events.told


def test_a_gyro_at_a_serial_port_comes_first(fifo: ByteSource, port: Path) -> None:
    """Other devices are then not opened."""
    unopened = SerialPort("fifo:/nowhere", "/nowhere")
    with Command("--link", port, "--quiet", module="firmware_sim") as device:
        device.until(lambda _: port.exists(), "port")
        ports = [SerialPort(str(port), str(port))]
        options, open_port = find_gyro(ports, LinkOptions("auto"), Events(), devices=[unopened])
        open_port.close()
    assert options.port == str(port)
