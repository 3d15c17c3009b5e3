"""Effects and encoders that other packages add to the simulated device, by entry points.

One of `gyrodrift.effects` names a class derived from `firmware_sim.effects.effect.Effect`. Its class attribute
`candidate` may be the `CandidateKind` by which `diagnose` looks for the effect in recordings. One of
`gyrodrift.encoders` names a `WireEncoder`, the device's side of a protocol.
"""

from typing import Any

from firmware_sim.effects import catalogue
from firmware_sim.effects.effect import Effect
from firmware_sim.effects.triaxial.catalogue import TRIAXIAL
from firmware_sim.wire import registry
from firmware_sim.wire.encoder import WireEncoder
from gyrodrift.io.plug_ins import EntryPoint, PlugIns, named_record, subclass_of


def _accept(entry: EntryPoint, value: Any) -> type[Effect]:
    """Register the class of another package in the catalogue of the simulator, unless its module did so."""
    effect: type[Effect] = subclass_of(Effect, entry, value)
    if catalogue.name_of(effect) != entry.name:
        raise ValueError(f"its name is {catalogue.name_of(effect)!r}")
    candidate = effect.candidate
    if candidate is not None and (candidate.name != entry.name or candidate.parameter not in effect.model_fields):
        raise ValueError(f"its candidate is for {candidate.name} with {candidate.parameter}")
    return effect if catalogue.CATALOGUE.get(entry.name) is effect else catalogue.register(effect)


EFFECTS: PlugIns[type[Effect]] = PlugIns("effect", _accept, (*catalogue.CATALOGUE, *TRIAXIAL))
"""Effects of plug-ins; rig files and command lines know them after `load`."""


def _accept_encoder(entry: EntryPoint, value: Any) -> WireEncoder:
    """Register the encoder of another package in the simulated device, unless its module did so."""
    encoder = named_record(WireEncoder)(entry, value)
    if registry.ENCODERS.get(entry.name) is not encoder:
        registry.register(encoder)
    return encoder


ENCODERS: PlugIns[WireEncoder] = PlugIns("encoder", _accept_encoder, tuple(registry.ENCODERS))
"""Encoders of plug-ins; `--protocol` of the simulated device and of `replay` knows them after `load_encoders`."""


def load_encoders() -> None:
    """Make the encoders of plug-ins known to command lines."""
    ENCODERS.added()


def load() -> list[type[Effect]]:
    """Make the effects of plug-ins known to rig files, command lines and `diagnose`; those that work."""
    return [effect for effect in EFFECTS.added().values() if isinstance(effect, type)]
