"""The protocols that the host reads, by name: every module of this package that has a `PROTOCOL`."""

from importlib import import_module
from pkgutil import iter_modules

import gyrodrift.link.protocols
from gyrodrift.errors import UsageError
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


def candidates(name: str) -> list[WireProtocol]:
    """The protocols that come into question where a person says `name`: all for `auto`, else that one.

    Raises
    ------
    UsageError
        Where there is none of that name.
    """
    return list(PROTOCOLS.values()) if name == AUTO else [protocol_named(name)]


def listed() -> str:
    """The names as a sentence has them: `native, csv or witmotion`."""
    *most, last = PROTOCOLS
    return f"{', '.join(most)} or {last}" if most else last


def _register_shipped() -> None:
    for module in iter_modules(gyrodrift.link.protocols.__path__):
        protocol = getattr(import_module(f"{gyrodrift.link.protocols.__name__}.{module.name}"), "PROTOCOL", None)
        if protocol is not None:
            register(protocol)


_register_shipped()
