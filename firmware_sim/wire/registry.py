"""The protocols that the device speaks, by name: every module of this package that has an `ENCODER`."""

from importlib import import_module
from pkgutil import iter_modules

import firmware_sim.wire
from firmware_sim.wire.encoder import WireEncoder

ENCODERS: dict[str, WireEncoder] = {}
"""In alphabetical order as shipped; `--protocol` of `python -m firmware_sim` and `gyrodrift replay` follow it."""


def register(encoder: WireEncoder) -> None:
    """Let the device speak one protocol more.

    Raises
    ------
    ValueError
        Where the name is taken.
    """
    if encoder.name in ENCODERS:
        raise ValueError(f"there is an encoder {encoder.name!r} already")
    ENCODERS[encoder.name] = encoder


def unregister(name: str) -> None:
    """Take a protocol away again."""
    del ENCODERS[name]


def _register_shipped() -> None:
    for module in sorted(module.name for module in iter_modules(firmware_sim.wire.__path__)):
        encoder = getattr(import_module(f"{firmware_sim.wire.__name__}.{module}"), "ENCODER", None)
        if encoder is not None:
            register(encoder)


_register_shipped()
