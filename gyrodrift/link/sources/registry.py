"""Registry of the sources by scheme. A new source needs its own file and a line here, or an entry point."""

import re
from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

from gyrodrift.io.plug_ins import EntryPoint, PlugIns, named_record
from gyrodrift.values.errors import UsageError

if TYPE_CHECKING:
    from gyrodrift.link.serial_port import SerialPort
    from gyrodrift.link.sources.source import ByteSource, SourceAddress

SHIPPED = {
    "tcp": "gyrodrift.link.sources.sockets:TCP",
    "socket": "gyrodrift.link.sources.sockets:SOCKET",
    "udp": "gyrodrift.link.sources.udp:UDP",
    "mavlink": "gyrodrift.link.sources.mavlink:MAVLINK",
    "rfc2217": "gyrodrift.link.sources.rfc2217:RFC2217",
    "unix": "gyrodrift.link.sources.sockets:UNIX",
    "-": "gyrodrift.link.sources.stdin:STANDARD_INPUT",
    "mcap": "gyrodrift.link.sources.mcap:MCAP",
    "iio": "gyrodrift.link.sources.iio:IIO",
    "can": "gyrodrift.link.sources.can:CAN",
    "mqtt": "gyrodrift.link.sources.mqtt:MQTT",
    "mqtts": "gyrodrift.link.sources.mqtt:MQTTS",
    "ws": "gyrodrift.link.sources.rosbridge:WS",
    "wss": "gyrodrift.link.sources.rosbridge:WSS",
    "ble": "gyrodrift.link.sources.ble:BLE",
}
"""Schemes with `module:NAME` of their `ByteSource`, imported when an address has that scheme."""

STDIN = "-"
FOLLOWED = ".mcap"
"""Addresses without a scheme: standard input, and the ending of a recording that is followed."""

SCHEME = re.compile(r"([A-Za-z][A-Za-z0-9+.-]+):(//)?(.*)", re.DOTALL)
"""RFC 3986, section 3.1, with at least two characters: one is a drive of Windows."""


def _accept(entry: EntryPoint, value: Any) -> "ByteSource":
    from gyrodrift.link.sources.source import ByteSource  # noqa: PLC0415 - registration needs less

    return named_record(ByteSource, "scheme")(entry, value)


ADDED: "PlugIns[ByteSource]" = PlugIns("source", _accept, SHIPPED)
"""Sources of `register` and of plug-ins, by scheme."""


def register(source: "ByteSource") -> None:
    """Add a source.

    Raises
    ------
    ValueError
        If the scheme is taken.
    """
    if source.scheme in SHIPPED or source.scheme in ADDED.own:
        raise ValueError(f"there is a source {source.scheme!r} already")
    ADDED.own[source.scheme] = source


def unregister(scheme: str) -> None:
    """Remove a registered source."""
    del ADDED.own[scheme]


def schemes() -> list[str]:
    """Schemes of all sources."""
    return [*SHIPPED, *ADDED]


def source_named(scheme: str) -> "ByteSource":
    """Source of a scheme that exists.

    Raises
    ------
    PlugInError
        The package that offers it is broken.
    """
    if scheme not in SHIPPED:
        return ADDED[scheme]
    module, _, name = SHIPPED[scheme].partition(":")
    source: ByteSource = getattr(import_module(module), name)
    return source


def address_of(text: str) -> "SourceAddress | None":
    """Address of a source; None for a serial port, which is any other path.

    Raises
    ------
    UsageError
        The text has the form of an address with an unknown scheme; the message lists the known ones.
    """
    from gyrodrift.link.sources.source import SourceAddress  # noqa: PLC0415 - registration needs less

    match = SCHEME.fullmatch(text)
    if text == STDIN:
        return SourceAddress(text, STDIN, "")
    if match is None:
        return SourceAddress(text, "mcap", text) if text.lower().endswith(FOLLOWED) else None
    scheme = match[1].lower()
    if scheme in SHIPPED or scheme in ADDED:
        return SourceAddress(text, scheme, match[3])
    if match[2]:
        names = ", ".join(sorted(scheme for scheme in schemes() if scheme != STDIN))
        raise UsageError(f"--port {text}: unknown source {match[1]!r}; there are {names}, or the path of a serial port")
    return None


def source_of(text: str) -> "ByteSource | None":
    """Source of an address; None for a serial port.

    Raises
    ------
    UsageError
        As from `address_of`.
    """
    address = address_of(text)
    return None if address is None else source_named(address.scheme)


def check_packages(source: "ByteSource") -> None:
    """Check that the packages of a source are installed.

    Raises
    ------
    UsageError
        With the command that installs them.
    """
    for package in source.packages:
        if not _is_installed(package):
            from gyrodrift.io.installation import extra_command  # noqa: PLC0415 - only for the message

            command = extra_command(source.extra)
            raise UsageError(f"source {source.scheme} needs the package {package}: {command}")


def source_devices() -> "list[SerialPort]":
    """Devices of all sources that can list them and whose packages are installed; no device is opened."""
    sources = [source_named(scheme) for scheme in schemes()]
    return [device for source in sources if all(map(_is_installed, source.packages)) for device in source.devices()]


def _is_installed(package: str) -> bool:
    try:
        return find_spec(package) is not None
    except ModuleNotFoundError:  # the parent package is missing
        return False
