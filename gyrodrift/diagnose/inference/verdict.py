"""What is said of the gap: its kind, the causes, what deviates before and after, and what is negligible."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum

import numpy as np

from firmware_sim.effects.effect import Effect
from gyrodrift.arrays import Floats
from gyrodrift.diagnose.inference.deviations import Deviation, shared
from gyrodrift.diagnose.inference.evidence import Evidence
from gyrodrift.diagnose.inference.gap import SimToRealGap, gap_of, no_gap
from gyrodrift.diagnose.inference.parameters import Parameter
from gyrodrift.diagnose.simulate.candidates import KINDS
from gyrodrift.diagnose.simulate.response_table import Sized

NEGLIGIBLE_DEG = 0.3
"""Mean absolute yaw that an effect may cost in a session, where its size does not matter either."""


class Kind(StrEnum):
    """What is said of the gap."""

    NONE = "none"
    EFFECT = "effect"
    PARTLY = "partly"
    UNKNOWN = "unknown"


@dataclass(frozen=True, slots=True)
class NamedCause:
    """An effect that is held to act.

    meaning
        What it does, in a sentence for a person.
    group_probability
        That it acts, or another effect that is of its group or tied with it.
    """

    cause: Sized
    effect: Effect
    group: str
    meaning: str
    probability: float
    group_probability: float
    parameters: tuple[Parameter, ...]
    tied_with: tuple[str, ...]

    @property
    def in_rig(self) -> Effect | None:
        """What the rig says of it, where it has it already."""
        return self.cause.candidate.in_rig

    @property
    def is_as_in_rig(self) -> bool:
        """Whether the rig has it just so, as far as the sessions know."""
        has = self.in_rig
        return has is not None and all(one.low <= float(getattr(has, one.name)) <= one.high for one in self.parameters)

    def in_session(self, number: int, stands: Sequence[Effect]) -> Effect:
        """The effect with the phase that session `number` shows; `stands` is what the rig of that session has."""
        phases_deg = self.cause.phases_deg
        if phases_deg is None:
            return self.cause.candidate.turned(self.effect, stands)
        return self.effect.model_copy(update={"phase_deg": float(phases_deg[number])})


@dataclass(frozen=True, slots=True)
class Negligible:
    """An effect that acts and costs nothing; `yaw_deg` is what it costs, mean absolute yaw, deg."""

    cause: NamedCause
    yaw_deg: float


@dataclass(frozen=True, slots=True)
class Verdict:
    """All that is concluded.

    where, unexplained
        What deviates before anything is added, and what still does after; the worst first.
    after_z
        (sessions, F) what held-out sessions leave unexplained.
    negligible
        Effects that act, and cost nothing.
    """

    kind: Kind
    causes: tuple[NamedCause, ...]
    where: tuple[Deviation, ...]
    unexplained: tuple[Deviation, ...]
    gap: SimToRealGap
    after_z: Floats = field(repr=False)
    negligible: tuple[Negligible, ...] = ()

    @property
    def acting(self) -> tuple[NamedCause, ...]:
        """All that is held to act, whether it costs something or not."""
        return (*self.causes, *(one.cause for one in self.negligible))


def is_small(cause: NamedCause) -> bool:
    """Whether an effect, or what it is off the rig by, is below the size at which it begins to matter."""
    name = cause.cause.candidate.parameter
    least = KINDS[cause.effect.name].matters_from or 0.0
    has = 0.0 if cause.in_rig is None else float(getattr(cause.in_rig, name))
    return abs(float(getattr(cause.effect, name)) - has) < least


def set_aside(verdict: Verdict, costs_deg: Mapping[str, float]) -> Verdict:
    """The verdict with causes set aside that cost less than NEGLIGIBLE_DEG, by their names."""
    aside = tuple(
        Negligible(one, costs_deg[one.effect.name])
        for one in verdict.causes
        if costs_deg.get(one.effect.name, np.inf) < NEGLIGIBLE_DEG
    )
    names = {one.cause.effect.name for one in aside}
    kept = tuple(one for one in verdict.causes if one.effect.name not in names)
    kind = verdict.kind
    if aside and not kept:
        kind = Kind.NONE if verdict.kind is Kind.EFFECT else Kind.UNKNOWN
    return replace(verdict, kind=kind, causes=kept, negligible=aside)


def less(verdict: Verdict, causes: Collection[str], forms: Collection[str], evidence: Evidence) -> Verdict:
    """The verdict without some of its causes, and without some forms that no effect has, by their features: chance.

    A feature that stands out by itself still does.
    """

    def stays(one: Deviation) -> bool:
        return one.feature not in forms or abs(one.z) > evidence.stands_out

    where, unexplained = (shared([*filter(stays, each)]) for each in (verdict.where, verdict.unexplained))
    kept = tuple(one for one in verdict.causes if one.effect.name not in causes)
    if kept:
        kind = Kind.EFFECT if verdict.kind is Kind.PARTLY and not unexplained else verdict.kind
        return replace(verdict, kind=kind, causes=kept, where=where, unexplained=unexplained)
    kind = Kind.UNKNOWN if where else Kind.NONE
    gap = gap_of(evidence, evidence.z) if where else no_gap(evidence)
    return replace(verdict, kind=kind, causes=(), where=where, unexplained=where, gap=gap, after_z=evidence.z)
