"""The protocols that the host reads, by name: every module of this package that has a `PROTOCOL`."""

from dataclasses import replace
from importlib import import_module
from pkgutil import iter_modules

import gyrodrift.link.protocols
from gyrodrift.errors import UsageError
from gyrodrift.link.protocols import text
from gyrodrift.link.protocols.protocol import WireProtocol

AUTO = "auto"

PROTOCOLS: dict[str, WireProtocol] = {}
"""In the order in which detection asks them."""


def register(protocol: WireProtocol) -> None:
    """Let the host read one protocol more.

    Raises
    ------
    ValueError
        Where the name is taken.
    """
    if protocol.name in (AUTO, *PROTOCOLS):
        raise ValueError(f"there is a protocol {protocol.name!r} already")
    ranked = sorted([*PROTOCOLS.values(), protocol], key=lambda each: each.rank)
    PROTOCOLS.clear()
    PROTOCOLS.update((each.name, each) for each in ranked)


def unregister(name: str) -> None:
    """Take a protocol away again."""
    del PROTOCOLS[name]


def protocol_named(name: str) -> WireProtocol:
    """The protocol of that name.

    Raises
    ------
    UsageError
        Where there is none, with the names there are.
    """
    if name not in PROTOCOLS:
        raise UsageError(f"unknown protocol {name!r}; known are {', '.join((AUTO, *PROTOCOLS))}")
    return PROTOCOLS[name]


def candidates(name: str, columns: str | None = None) -> list[WireProtocol]:
    """The protocols that come into question where a person says `name`: all detected ones for `auto`, else that one.

    Columns are those of the text protocol, and mean it.

    Raises
    ------
    UsageError
        Where there is none of that name, or its columns are missing or not understood.
    """
    if columns is not None:
        if name not in (AUTO, text.NAME):
            raise UsageError(f"--columns is for --protocol {text.NAME}, not for {name}")
        return [text.text_protocol(columns)]
    if name == text.NAME:
        raise UsageError(
            f"--protocol {text.NAME} needs --columns to say what stands in a line, such as --columns 't_ms, _, rate'; "
            f"without --protocol and --columns, what the device prints is looked at and columns are proposed"
        )
    if name == AUTO:
        return [each for each in PROTOCOLS.values() if each.is_detected]
    protocol = protocol_named(name)
    return [replace(protocol, decoder=protocol.asked_decoder or protocol.decoder)]


def listed() -> str:
    """The names that are detected, as a sentence has them: `native, csv or witmotion`."""
    *most, last = (each.name for each in PROTOCOLS.values() if each.is_detected)
    return f"{', '.join(most)} or {last}" if most else last


def _register_shipped() -> None:
    for module in iter_modules(gyrodrift.link.protocols.__path__):
        protocol = getattr(import_module(f"{gyrodrift.link.protocols.__name__}.{module.name}"), "PROTOCOL", None)
        if protocol is not None:
            register(protocol)


_register_shipped()
