"""Encoders by name: every module of this package with an `ENCODER`."""

from importlib import import_module
from pkgutil import iter_modules

import firmware_sim.wire
from firmware_sim.wire.encoder import WireEncoder

ENCODERS: dict[str, WireEncoder] = {}
"""Encoders in alphabetical order, for `--protocol` of `simulated-device` and `replay`."""


def register(encoder: WireEncoder) -> None:
    """Add a protocol.

    Raises
    ------
    ValueError
        The name is taken.
    """
    if encoder.name in ENCODERS:
        raise ValueError(f"there is an encoder {encoder.name!r} already")
    ENCODERS[encoder.name] = encoder


def unregister(name: str) -> None:
    """Remove a protocol."""
    del ENCODERS[name]


def _register_shipped() -> None:
    for module in sorted(module.name for module in iter_modules(firmware_sim.wire.__path__)):
        encoder = getattr(import_module(f"{firmware_sim.wire.__name__}.{module}"), "ENCODER", None)
        if encoder is not None:
            register(encoder)


_register_shipped()
