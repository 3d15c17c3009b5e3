"""Addresses of sources, and paths that only look like one."""

import subprocess
import sys

import pytest

from gyrodrift.link.link import Link
from gyrodrift.link.options import LinkOptions
from gyrodrift.link.sources.opening import open_port
from gyrodrift.link.sources.registry import SHIPPED, address_of, source_named
from gyrodrift.values.errors import PortMissingError, UsageError


@pytest.mark.parametrize(
    "path",
    [
        "/dev/ttyUSB0",
        "COM3",
        "/dev/x:1",
        "C:\\gyro",
        "rig:1",
        "./tcp:x",
        "/dev/serial/by-path/pci-0000:00:14.0-usb-0:2",
    ],
)
def test_a_path_stays_a_path(path: str) -> None:
    assert address_of(path) is None
    with pytest.raises(PortMissingError, match="there is no such port"):
        open_port(path, 9600)


@pytest.mark.parametrize("scheme", SHIPPED)
def test_each_source_has_an_address_and_a_description(scheme: str) -> None:
    source = source_named(scheme)
    assert source.scheme == scheme
    assert source.title.startswith(scheme) or scheme == "mcap"
    assert source.about
    assert source.silence


def test_the_case_of_a_scheme_does_not_matter() -> None:
    address = address_of("TCP://esp32.local:3333")
    assert address is not None
    assert (address.scheme, address.host_port()) == ("tcp", ("esp32.local", 3333))


def test_an_ipv6_address_is_in_brackets() -> None:
    address = address_of("tcp://[fe80::1]:3333")
    assert address is not None
    assert address.host_port() == ("fe80::1", 3333)


def test_an_unknown_scheme_is_an_error_with_the_known_ones() -> None:
    with pytest.raises(UsageError, match=r"tpc://gyro:1: unknown source 'tpc'; there are .*tcp.* or the path of"):
        address_of("tpc://gyro:1")


@pytest.mark.parametrize(
    "text", ["tcp://gyro", "tcp://:3333", "tcp://gyro:0", "tcp://gyro:65536", "tcp://gyro:٣", "tcp:", "tcp://gyro:x"]
)
def test_a_wrong_address_is_an_error_with_the_form(text: str) -> None:
    with pytest.raises(UsageError, match=r"expected tcp://HOST:PORT with a port from 1 to 65535"):
        open_port(text, 0)


@pytest.mark.parametrize(
    ("options", "expected"),
    [(LinkOptions("tcp://127.0.0.1:1", baud=9600), "this source has no baud rate; leave out --baud")],
)
def test_an_option_without_effect_is_an_error(options: LinkOptions, expected: str) -> None:
    with pytest.raises(UsageError, match=expected):
        Link(options, lambda *_, **__: None)


def test_a_serial_port_imports_no_source() -> None:
    """`serve` on a cable starts as fast as before."""
    code = "import sys, gyrodrift.link.link; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    allowed = {f"gyrodrift.link.sources.{name}" for name in ("registry", "source", "opening")}
    imported = {name for name in done.stdout.split() if name.startswith("gyrodrift.link.sources.")}
    assert imported <= allowed
