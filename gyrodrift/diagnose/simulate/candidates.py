"""All candidate causes: effects with a record, effects of users and plug-ins, and out-of-catalog models."""

from collections.abc import Mapping
from types import MappingProxyType

from firmware_sim.effects.catalogue import CATALOGUE
from firmware_sim.rig import Rig
from gyrodrift.diagnose.simulate.candidate import Candidate
from gyrodrift.diagnose.simulate.candidate_kind import CandidateKind, Hints
from gyrodrift.diagnose.simulate.kinds import EFFECTS
from gyrodrift.diagnose.simulate.nuisance import out_of_catalogue
from gyrodrift.simulation.effects import load

IDEAL = Rig()
"""A rig without effects."""

_KINDS: dict[str, CandidateKind] = {}

KINDS: Mapping[str, CandidateKind] = MappingProxyType(_KINDS)
"""Record by name of the effect; a live view, so later registrations appear in it."""


def register(kind: CandidateKind) -> CandidateKind:
    """Add an effect as the last candidate.

    Raises
    ------
    ValueError
        The simulator lacks the effect or the parameter, or the effect already has a record.
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
    """Remove a registered effect, as a test does after it registered its own."""
    del _KINDS[name]


def candidates(hints: Hints, rig: Rig = IDEAL) -> list[Candidate]:
    """All candidates for recordings with these hints and a rig that may have some of the effects already.

    Candidates at phases other than 0 and 90 degrees are combined from those two: see `responses`.
    """
    in_rig = {effect.name: effect for effect in rig.effects}
    is_free = not rig.base.encoder_absolute
    of_effects = [
        candidate
        for kind in KINDS.values()
        for candidate in kind.candidates(hints, in_rig.get(kind.name), is_phase_free=is_free)
    ]
    return [*of_effects, *out_of_catalogue()]


for _kind in EFFECTS:
    register(_kind)
for _effect in load():
    if _effect.candidate is not None and _effect.candidate.name not in KINDS:
        register(_effect.candidate)
