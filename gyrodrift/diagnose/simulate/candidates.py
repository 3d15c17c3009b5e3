"""All candidate causes: a record for each effect, what anybody registers beside them, and out-of-catalogue models."""

from collections.abc import Mapping
from types import MappingProxyType

from firmware_sim.effects.catalogue import CATALOGUE
from firmware_sim.rig import Rig
from gyrodrift.diagnose.simulate.candidate import Candidate
from gyrodrift.diagnose.simulate.candidate_kind import CandidateKind, Hints
from gyrodrift.diagnose.simulate.kinds import EFFECTS
from gyrodrift.diagnose.simulate.nuisance import out_of_catalogue

IDEAL = Rig()
"""A rig without effects."""

_KINDS: dict[str, CandidateKind] = {}

KINDS: Mapping[str, CandidateKind] = MappingProxyType(_KINDS)
"""Record by name of the effect; a view that shows what is registered later too."""


def register(kind: CandidateKind) -> CandidateKind:
    """Add an effect to what is tried, behind all others.

    Raises
    ------
    ValueError
        Where the simulator has no such effect or parameter, or there is a record of it already.
    """
    if kind.name not in CATALOGUE:
        raise ValueError(f"{kind.name}: the simulator has no such effect; register that first")
    if kind.parameter not in CATALOGUE[kind.name].model_fields:
        raise ValueError(f"{kind.name}: has no parameter {kind.parameter!r}")
    if kind.name in _KINDS:
        raise ValueError(f"{kind.name}: is a candidate already")
    _KINDS[kind.name] = kind
    return kind


def unregister(name: str) -> None:
    """Take a candidate away again, as a test does with one of its own."""
    del _KINDS[name]


def candidates(hints: Hints, rig: Rig = IDEAL) -> list[Candidate]:
    """All of them on given recordings; those of other phases are not simulated but composed, see `responses`."""
    in_rig = {effect.name: effect for effect in rig.effects}
    is_free = not rig.base.encoder_absolute
    found = [
        candidate
        for kind in KINDS.values()
        for candidate in kind.candidates(hints, in_rig.get(kind.name), is_phase_free=is_free)
    ]
    return [*found, *out_of_catalogue()]


for _kind in EFFECTS:
    register(_kind)
