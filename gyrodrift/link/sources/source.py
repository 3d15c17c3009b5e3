"""Record of a source, and the port that it opens."""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import inf
from typing import Any
from urllib.parse import unquote

from gyrodrift.link.protocols.batch import ReadingBatch
from gyrodrift.link.protocols.protocol import WireProtocol
from gyrodrift.link.serial_port import SerialPort
from gyrodrift.values.errors import UsageError

PORT_NUMBER = re.compile(r"0{0,4}[1-9][0-9]{0,4}")
LAST_PORT = 0xFFFF

NOTES_MAX = 16
"""Largest number of events that wait for the link; hostile input could make many."""


class SourceEndedError(Exception):
    """Source that has ended for good, such as standard input; all its bytes have been read."""


class SourcePort:
    """Open serial port or source. A source overrides `read` and `close`. `notes` are for the link.

    A source of bytes reads `bytes`; a source of readings, whose messages are values, reads a `ReadingBatch`.

    path
        Address as the user wrote it.
    fd
        Descriptor that becomes readable when bytes arrive; None if there is none.
    is_pty
        Whether it is a terminal of another program, which has no line with a baud rate.
    wake_s
        Longest time between two reads, s, for a source without descriptor.
    has_line_rate
        Whether the bytes come through a line with a baud rate, which may be too slow for the samples.
    stream
        Sender of what was read last, for a source that hears several.
    """

    is_pty = False
    stream: object = None
    wake_s: float = inf
    has_line_rate = False

    def __init__(self, path: str, fd: int | None) -> None:
        self.path = path
        self.fd = fd
        self.notes: list[tuple[str, dict[str, Any]]] = []

    def read(self) -> bytes | ReadingBatch:
        """Available bytes or readings, up to a limit, without waiting.

        Raises
        ------
        PortGoneError
            The source is closed, and all its bytes have been read; the link opens it again.
        SourceEndedError
            The source has ended for good.
        """
        raise NotImplementedError

    def understood(self) -> None:
        """Learn that what was read last had samples."""

    def write(self, content: bytes) -> int:
        """Send without waiting, and return the number of bytes; a source that cannot send takes all of them."""
        return len(content)

    def set_baud(self, baud: int) -> None:
        """Change the baud rate, and drop bytes received at the old one."""

    def close(self) -> None:
        """Close the source in any state."""

    def note(self, event: str, **fields: Any) -> None:
        """Add an event for the log, unless too many wait."""
        if len(self.notes) < NOTES_MAX:
            self.notes.append((event, fields))


@dataclass(frozen=True, slots=True)
class SourceAddress:
    """Address of a source.

    text
        Address as the user wrote it.
    scheme
        Name of the source.
    rest
        Address without `SCHEME:` and without `//`.
    """

    text: str
    scheme: str
    rest: str

    def host_port(self, default_host: str = "") -> tuple[str, int]:
        """Host and port of `HOST:PORT`; an IPv6 address is in brackets.

        Raises
        ------
        UsageError
            The address has another form, or a user name, or no host and there is no default.
        """
        host, mark, port = self.rest.rstrip("/").rpartition(":")
        host = host.removeprefix("[").removesuffix("]") or default_host
        if "@" in host:  # it is not repeated here: it may hold a password
            raise UsageError(f"--port {self.scheme}:…@…: this source knows no users; leave out everything up to the @")
        if not mark or not host or PORT_NUMBER.fullmatch(port) is None or int(port) > LAST_PORT:
            slashes = "" if ":" in self.scheme else "//"
            expected = f"{self.scheme}:{slashes}{'[HOST]' if default_host else 'HOST'}:PORT"
            raise UsageError(f"--port {self.text}: expected {expected} with a port from 1 to 65535")
        return host, int(port)

    def split_query(self, allowed: Sequence[str]) -> tuple[str, dict[str, str]]:
        """Address without its options `?NAME=VALUE&NAME=VALUE`, and the options by name.

        Raises
        ------
        UsageError
            An option is unknown, has no value, or stands there twice.
        """
        rest, _, query = self.rest.partition("?")
        options: dict[str, str] = {}
        for text in query.split("&") if query else ():
            name, _, value = text.partition("=")
            if name not in allowed or not value or name in options:
                expected = " and ".join(f"{name}=…" for name in allowed)
                raise UsageError(f"--port {self.text}: {text!r} is no option of this source; there are {expected}")
            options[name] = unquote(value)
        return rest, options


def no_devices() -> list[SerialPort]:
    """Empty list, of a source that cannot list its devices."""
    return []


@dataclass(frozen=True, slots=True)
class ByteSource:
    """A source.

    scheme
        Name in `--port SCHEME:…`.
    title
        Form of its address, such as `tcp://HOST:PORT`.
    about
        Purpose in a few words.
    open
        Function that opens an address. It may wait for seconds, and raises errors of `gyrodrift.errors`. It imports the
        packages of the source.
    protocol
        Protocol of a source that has its own; None to detect it as on a cable.
    protocol_of
        Function that makes the protocol from the options in the address, in place of `protocol`.
    has_baud
        Whether `--baud auto` tries baud rates.
    holds_back
        Whether bytes that are not read wait, so that the service may wait for its readers; else they would be lost.
    devices
        Function that lists the devices on this machine, without opening them.
    packages, extra
        Packages that it needs, and the extra of gyrodrift that installs them.
    silence
        Advice if no byte arrives.
    unit
        Lines for `[Service]` that its systemd unit needs besides the usual ones.
    """

    scheme: str
    title: str
    about: str
    open: Callable[[SourceAddress], SourcePort]
    protocol: WireProtocol | None = None
    protocol_of: Callable[[SourceAddress], WireProtocol] | None = None
    has_baud: bool = False
    holds_back: bool = False
    devices: Callable[[], list[SerialPort]] = no_devices
    packages: tuple[str, ...] = ()
    extra: str = ""
    silence: str = "check that the device is on and sends to this address"
    unit: tuple[str, ...] = ()
