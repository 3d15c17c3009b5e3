"""The search for the one gyro: its port is opened once, and the link goes on with it."""

from pathlib import Path
from typing import Any

import pytest
from support import Command

from gyrodrift.link.link import Link
from gyrodrift.link.options import LinkOptions
from gyrodrift.link.port import Port
from gyrodrift.link.search import find_gyro
from gyrodrift.link.serial_port import SerialPort
from gyrodrift.link.sources import opening as opening_module
from gyrodrift.values.errors import UsageError


def test_the_link_goes_on_with_the_port_that_was_found(port: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Opened again, many a board would be reset again."""
    opened: list[str] = []

    class Counted(Port):
        def __init__(self, path: str, baud: int) -> None:
            opened.append(path)
            super().__init__(path, baud)

    monkeypatch.setattr(opening_module, "Port", Counted)
    events: list[tuple[str, dict[str, Any]]] = []
    name = str(port)
    with Command("--link", port, "--quiet", module="firmware_sim") as device:
        device.until(lambda _: port.exists(), "port")
        result, open_port = find_gyro(
            [SerialPort(name, name)], LinkOptions("auto"), lambda event, **fields: events.append((event, fields))
        )
        link = Link(result, lambda *_, **__: None, port=open_port)
        while not link.read():
            assert link.silent_s() < 20.0
        link.close()
    assert opened == [name]
    assert (result.port, result.protocol) == (name, "native")
    assert [event for event, _ in events] == ["port_search", "port_found"]
    assert events[1][1]["port"] == name


@pytest.mark.promise("Samples")
def test_nothing_is_sent_to_ports_that_nobody_named() -> None:
    """`--port auto` does not send to ports that you did not name."""
    ports = [SerialPort(name, name) for name in ("/dev/ttyUSB7", "/dev/ttyUSB8")]
    with pytest.raises(UsageError, match="--send would reach /dev/ttyUSB7, /dev/ttyUSB8; name one of them"):
        find_gyro(ports, LinkOptions("auto", send=b"x"), lambda *_, **__: None)
