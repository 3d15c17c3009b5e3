"""Protocols by name: every module of this package with a `PROTOCOL`."""

from dataclasses import replace
from importlib import import_module
from pkgutil import iter_modules

import gyrodrift.link.protocols
from gyrodrift.link.protocols import text
from gyrodrift.link.protocols.protocol import WireProtocol
from gyrodrift.values.errors import UsageError

AUTO = "auto"

PROTOCOLS: dict[str, WireProtocol] = {}
"""Protocols in the order of detection."""


def register(protocol: WireProtocol) -> None:
    """Add a protocol.

    Raises
    ------
    ValueError
        The name is taken.
    """
    if protocol.name in (AUTO, *PROTOCOLS):
        raise ValueError(f"there is a protocol {protocol.name!r} already")
    ranked = sorted([*PROTOCOLS.values(), protocol], key=lambda entry: entry.rank)
    PROTOCOLS.clear()
    PROTOCOLS.update((entry.name, entry) for entry in ranked)


def unregister(name: str) -> None:
    """Remove a protocol."""
    del PROTOCOLS[name]


def protocol_named(name: str) -> WireProtocol:
    """Protocol of a name.

    Raises
    ------
    UsageError
        The name is unknown; the message lists the known ones.
    """
    if name not in PROTOCOLS:
        raise UsageError(f"unknown protocol {name!r}; there are {', '.join((AUTO, *PROTOCOLS))}")
    return PROTOCOLS[name]


def candidates(name: str, columns: str | None = None) -> list[WireProtocol]:
    """Protocols for the option `name`: all detected ones for `auto`, else that protocol.

    Columns imply the text protocol.

    Raises
    ------
    UsageError
        The name is unknown, or the columns are missing or have a mistake.
    """
    if columns is not None:
        if name not in (AUTO, text.NAME):
            raise UsageError(f"--columns is for --protocol {text.NAME}, not for {name}")
        return [text.text_protocol(columns)]
    if name == text.NAME:
        raise UsageError(
            f"--protocol {text.NAME} needs --columns, such as --columns 't_ms, _, rate'; "
            f"without --protocol and --columns, gyrodrift proposes columns from the lines of the device"
        )
    if name == AUTO:
        return [entry for entry in PROTOCOLS.values() if entry.is_detected]
    protocol = protocol_named(name)
    return [replace(protocol, decoder=protocol.asked_decoder or protocol.decoder, is_asked=True)]


def listed() -> str:
    """Names of the detected protocols: `native, csv or witmotion`."""
    *names, last = (entry.name for entry in PROTOCOLS.values() if entry.is_detected)
    return f"{', '.join(names)} or {last}" if names else last


def _register_shipped() -> None:
    for module in iter_modules(gyrodrift.link.protocols.__path__):
        protocol = getattr(import_module(f"{gyrodrift.link.protocols.__name__}.{module.name}"), "PROTOCOL", None)
        if protocol is not None:
            register(protocol)


_register_shipped()
