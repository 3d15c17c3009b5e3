"""Protocols by name: every module of this package with a `PROTOCOL`, and those of plug-ins."""

from dataclasses import replace
from importlib import import_module
from pkgutil import iter_modules
from typing import Any

import gyrodrift.link.protocols
from gyrodrift.io.plug_ins import EntryPoint, PlugIns, named_record
from gyrodrift.link.protocols import text
from gyrodrift.link.protocols.protocol import WireProtocol
from gyrodrift.values.errors import UsageError
from gyrodrift.values.words import listed

AUTO = "auto"

DECODER = ("name", "counters", "device", "unread", "push")
"""Members of a decoder (`gyrodrift.link.protocols.decoder.Decoder`)."""


def _accept(entry: EntryPoint, value: Any) -> WireProtocol:
    protocol = named_record(WireProtocol)(entry, value)
    decoder = protocol.decoder()
    missing = [name for name in DECODER if not hasattr(decoder, name)]
    if missing or decoder.name != protocol.name:
        raise TypeError(f"its decoder has no {missing[0]}" if missing else f"its decoder is named {decoder.name!r}")
    return protocol


PROTOCOLS: PlugIns[WireProtocol] = PlugIns("protocol", _accept, (AUTO,))
"""Protocols in the order of detection, and then those of plug-ins."""


def register(protocol: WireProtocol) -> None:
    """Add a protocol.

    Raises
    ------
    ValueError
        The name is taken.
    """
    if protocol.name in (AUTO, *PROTOCOLS.own):
        raise ValueError(f"there is a protocol {protocol.name!r} already")
    ranked = sorted([*PROTOCOLS.own.values(), protocol], key=lambda entry: entry.rank)
    PROTOCOLS.own.clear()
    PROTOCOLS.own.update((entry.name, entry) for entry in ranked)


def unregister(name: str) -> None:
    """Remove a protocol."""
    del PROTOCOLS.own[name]


def protocol_named(name: str) -> WireProtocol:
    """Protocol of a name.

    Raises
    ------
    UsageError
        The name is unknown, and the message lists the known ones; or its plug-in is broken.
    """
    if name not in PROTOCOLS:
        raise UsageError(f"unknown protocol {name!r}; there are {', '.join((AUTO, *PROTOCOLS))}")
    return PROTOCOLS[name]


def candidates(name: str, columns: str | None = None) -> list[WireProtocol]:
    """Protocols for the option `name`: all detected ones of gyrodrift for `auto`, else that protocol.

    Columns imply the text protocol. `added_candidates` are those of plug-ins.

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
        return [entry for entry in PROTOCOLS.own.values() if entry.is_detected]
    protocol = protocol_named(name)
    return [replace(protocol, decoder=protocol.asked_decoder or protocol.decoder, is_asked=True)]


def added_candidates() -> list[WireProtocol]:
    """Protocols of plug-ins that detection tries, by their rank; the packages are imported."""
    added = [entry for entry in PROTOCOLS.added().values() if isinstance(entry, WireProtocol) and entry.is_detected]
    return sorted(added, key=lambda entry: entry.rank)


def detected_names() -> str:
    """Names of the detected protocols: `native, csv or witmotion`."""
    return listed((entry.name for entry in PROTOCOLS.values() if entry.is_detected), "or")


def _register_shipped() -> None:
    for module in iter_modules(gyrodrift.link.protocols.__path__):
        protocol = getattr(import_module(f"{gyrodrift.link.protocols.__name__}.{module.name}"), "PROTOCOL", None)
        if protocol is not None:
            register(protocol)


_register_shipped()
