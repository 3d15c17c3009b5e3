"""From scores to words: which causes are named, with what probability, what is unexplained, and what kind it is."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum

import numpy as np

from firmware_sim.effects.effect import Effect
from gyrodrift.arrays import Floats
from gyrodrift.diagnose.inference.alternatives import Alternatives
from gyrodrift.diagnose.inference.deviations import (
    UNEXPLAINED,
    Deviation,
    deviations,
    explained_share,
    held_out_z,
    moved_by,
    out_of_catalogue,
    shared,
    shared_with_unknown,
    worst_first,
)
from gyrodrift.diagnose.inference.evidence import Evidence
from gyrodrift.diagnose.inference.family_wise import pooled_z
from gyrodrift.diagnose.inference.gap import SimToRealGap, gap_of, no_gap
from gyrodrift.diagnose.inference.parameters import Parameter, effect_of, parameters_of
from gyrodrift.diagnose.inference.probability import LogisticFeatures, probability_of
from gyrodrift.diagnose.inference.search import SearchResult
from gyrodrift.diagnose.inference.surrogate import Cause
from gyrodrift.diagnose.simulate.candidates import KINDS

LEAST_BESIDE = 0.1
"""However much a cause explains, what is left counts for so much of that beside it: of 23 causes that were stated with
0.9 and more beside something unexplained, four were wrong."""

EXPLAINED = 0.4
"""Causes that take away less of what deviates than this, and leave something, are no explanation."""


LIKELY, DOUBTFUL = 0.6, 0.5
"""Where no feature stands out, a cause that is hardly more probable than not is none. Where one does, causes that
leave nothing, and are each less probable than not with all that may stand for it, could explain anything: the gap is
unknown."""

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

    cause: Cause
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
        phases_deg = self.cause.response.phases_deg
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


def verdict_of(result: SearchResult, alternatives: Sequence[Alternatives]) -> Verdict:
    """Judge what was found."""
    surrogate, evidence = result.surrogate, result.surrogate.evidence
    after_z = held_out_z(surrogate, result.found)
    before, after = pooled_z(evidence.z) / evidence.caution, pooled_z(after_z) / evidence.caution
    deviates = np.abs(before) > evidence.stands_out
    explained = explained_share(deviates, before, after) if deviates.any() else 1.0
    others = out_of_catalogue(surrogate, result.found)
    unexplained = worst_first([*others, *deviations(after, UNEXPLAINED * evidence.stands_out)])
    every = _named(alternatives, result, float(np.clip(1.0 - explained, 0.0, 1.0)), unexplained)
    causes = tuple(one for one in every if not one.is_as_in_rig)
    if not deviates.any():
        causes = tuple(one for one in causes if one.probability > LIKELY)
    elif not unexplained and all(one.group_probability < DOUBTFUL for one in causes):
        causes = ()
    shows = bool(deviates.any() or others)  # a form that no effect has shows in the likelihood, though in no feature
    kind = kind_of(explained, shows=shows, has_causes=bool(causes), has_unexplained=bool(unexplained))
    where = deviations(before, evidence.stands_out)
    if kind is Kind.UNKNOWN and others:
        first = others[0]  # what it depends on says more than what else that moves
        where = shared([first, *(one for one in where if one.feature != first.feature)])
    return Verdict(
        kind=kind,
        causes=causes,
        where=where,
        unexplained=unexplained if causes else where,
        gap=no_gap(evidence) if kind is Kind.NONE else gap_of(evidence, after_z if causes else evidence.z),
        after_z=after_z if causes or others else evidence.z,
    )


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


def kind_of(explained: float, *, shows: bool, has_causes: bool, has_unexplained: bool) -> Kind:
    """What is said of a gap, if there is one, by the share that is explained of what deviates."""
    if not has_causes:
        return Kind.UNKNOWN if shows else Kind.NONE
    if not has_unexplained:
        return Kind.EFFECT
    return Kind.PARTLY if explained >= EXPLAINED else Kind.UNKNOWN


def _named(
    alternatives: Sequence[Alternatives], result: SearchResult, share_left: float, unexplained: Sequence[Deviation]
) -> tuple[NamedCause, ...]:
    """The most probable first, beside a share of what deviates that all causes leave."""
    worst = max((abs(one.z) for one in unexplained), default=0.0)
    moved = {one.cause: moved_by(result.surrogate, result.found, one.cause) for one in alternatives}
    named = []
    for one in sorted(alternatives, key=lambda one: -one.gain):
        moves = moved[one.cause]
        beside_unknown = max(worst**2 / (worst**2 + moves**2), LEAST_BESIDE) if worst else 0.0
        beside_unknown = max(beside_unknown, shared_with_unknown(result.surrogate, result.found, one.cause))
        rivals = one.rival_weight + _completes(one.cause, moved)
        by_itself = LogisticFeatures(rivals, share_left, one.cause.is_random, beside_unknown)
        named.append(
            NamedCause(
                cause=one.cause,
                effect=effect_of(one),
                group=one.cause.candidate.group,
                meaning=KINDS[one.cause.name].meaning,
                probability=probability_of(by_itself),
                group_probability=probability_of(by_itself._replace(rivals=one.weight_of_others)),
                parameters=parameters_of(one),
                tied_with=one.tied_with,
            )
        )
    # Of causes that are as good as equally probable, first what has no realisations to choose from.
    return tuple(sorted(named, key=lambda one: (-round(one.probability, 1), one.cause.candidate.realisations)))


def _completes(one: Cause, moved: Mapping[Cause, float]) -> bool:
    """Whether a cause may be no more than what the form of a stronger one of its group lacks."""
    return any(
        other.candidate.group == one.candidate.group and not other.candidate.is_exact and moves > moved[one]
        for other, moves in moved.items()
    )
