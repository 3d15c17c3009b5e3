"""Open a serial port or a source, at the start or in the background, and the rules for the link options of a source."""

import threading
from collections.abc import Callable
from dataclasses import replace

from gyrodrift.link.options import LinkOptions
from gyrodrift.link.port import HAS_TERMIOS, Port
from gyrodrift.link.protocols.protocol import WireProtocol
from gyrodrift.link.protocols.registry import AUTO
from gyrodrift.link.sources.registry import address_of, check_packages, source_named
from gyrodrift.link.sources.source import ByteSource, SourcePort
from gyrodrift.values.errors import GyrodriftError, LinkError, UsageError


def open_port(text: str, baud: int) -> SourcePort:
    """Open the source of an address, or a serial port.

    Raises
    ------
    UsageError
        The address has a mistake, or a package is missing.
    LinkError
        The source or the port cannot be opened.
    """
    address = address_of(text)
    if address is None:
        return open_line(text, baud)
    source = source_named(address.scheme)
    check_packages(source)
    port = source.open(address)
    if source.has_baud:
        port.set_baud(baud)
    return port


def open_line(path: str, baud: int) -> SourcePort:
    """Open a serial port in the way that this system has.

    Raises
    ------
    LinkError
        If the port cannot be opened.
    """
    if HAS_TERMIOS:
        return Port(path, baud)
    from gyrodrift.link.thread_port import ThreadPort

    return ThreadPort(path, baud)


def checked_source(options: LinkOptions) -> ByteSource | None:
    """Source of link options; None for a serial port.

    Raises
    ------
    UsageError
        The address has a mistake, or an option has no effect on this source.
    """
    address = address_of(options.port)
    if address is None:
        return None
    source = source_named(address.scheme)
    if options.baud is not None and not source.has_baud:
        raise UsageError(f"--port {options.port}: this source has no baud rate; leave out --baud")
    if source.protocol_of is not None:
        check_packages(source)
        source = replace(source, protocol=source.protocol_of(address))
    if source.protocol is not None:
        _check_protocol(options, source.protocol)
    return source


def _check_protocol(options: LinkOptions, own: WireProtocol) -> None:
    if options.columns is not None:
        raise UsageError(f"--port {options.port}: this source has its own values; leave out --columns")
    if options.protocol not in (AUTO, own.name):
        raise UsageError(f"--port {options.port}: this source is read as {own.name}; leave out --protocol")


class BackgroundOpening:
    """Opening in its own thread: a name server or a host may take seconds, and the loop must go on."""

    def __init__(self, open_port: Callable[[], SourcePort]) -> None:
        self._open_port = open_port
        self._lock = threading.Lock()
        self._port: SourcePort | None = None
        self._error: GyrodriftError | None = None
        self._is_abandoned = False
        self._thread = threading.Thread(target=self._run, name="open source", daemon=True)
        self._thread.start()

    def wait(self, most_s: float | None) -> None:
        """Wait for the end of the opening, at most for a time."""
        self._thread.join(most_s)

    def result(self) -> SourcePort | None:
        """The open port; None while the opening goes on.

        Raises
        ------
        GyrodriftError
            The port cannot be opened.
        """
        if self._thread.is_alive():
            return None
        if self._error is not None:
            raise self._error
        return self._port

    def abandon(self) -> None:
        """Close the port as soon as it is open."""
        with self._lock:
            self._is_abandoned = True
            if self._port is not None:
                self._port.close()

    def _run(self) -> None:
        try:
            port = self._open_port()
        except GyrodriftError as error:
            self._error = error
            return
        except Exception as error:  # noqa: BLE001 - of a library; the next attempt may succeed
            self._error = LinkError(f"it cannot be opened: {type(error).__name__}: {error}")
            return
        with self._lock:
            self._port = port
            if self._is_abandoned:
                port.close()
