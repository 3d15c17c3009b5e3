"""From scores to words: which causes are named, with what probability, what is unexplained, and what kind it is."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np

from firmware_sim.effects.effect import Effect
from gyrodrift.arrays import Floats, Mask
from gyrodrift.diagnose.inference.alternatives import Alternatives
from gyrodrift.diagnose.inference.deviations import (
    STANDS_OUT,
    UNEXPLAINED,
    Deviation,
    deviations,
    explained_share,
    held_out_z,
    out_of_catalogue,
    pooled_z,
    shared,
    worst_first,
)
from gyrodrift.diagnose.inference.gap import SimToRealGap, gap_of, no_gap
from gyrodrift.diagnose.inference.parameters import Parameter, effect_of, parameters_of
from gyrodrift.diagnose.inference.probability import LogisticFeatures, probability_of
from gyrodrift.diagnose.inference.search import SearchResult
from gyrodrift.diagnose.inference.surrogate import Cause
from gyrodrift.diagnose.simulate.candidates import KINDS

EXPLAINED = 0.4
"""Causes that take away less of what deviates than this, and leave something, are no explanation."""


class Kind(StrEnum):
    """What is said of the gap."""

    NONE = "none"
    EFFECT = "effect"
    PARTLY = "partly"
    UNKNOWN = "unknown"


@dataclass(frozen=True, slots=True)
class NamedCause:
    """An effect that is held to act; `meaning` is what it does, in a sentence for a person."""

    cause: Cause
    effect: Effect
    group: str
    meaning: str
    probability: float
    parameters: tuple[Parameter, ...]
    tied_with: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Verdict:
    """All that is concluded.

    where, unexplained
        What deviates before anything is added, and what still does after; the worst first.
    after_z
        (sessions, F) what held-out sessions leave unexplained.
    """

    kind: Kind
    causes: tuple[NamedCause, ...]
    where: tuple[Deviation, ...]
    unexplained: tuple[Deviation, ...]
    gap: SimToRealGap
    after_z: Floats = field(repr=False)


def verdict_of(result: SearchResult, alternatives: Sequence[Alternatives]) -> Verdict:
    """Judge what was found."""
    surrogate, evidence = result.surrogate, result.surrogate.evidence
    after_z = held_out_z(surrogate, result.found)
    before, after = pooled_z(evidence.z), pooled_z(after_z)
    deviates = np.abs(before) > STANDS_OUT
    explained = explained_share(deviates, before, after) if deviates.any() else 1.0
    others = out_of_catalogue(surrogate, result.found)
    unexplained = worst_first([*others, *deviations(after, UNEXPLAINED)])
    causes = _named(alternatives, float(np.clip(1.0 - explained, 0.0, 1.0)))
    kind = kind_of(deviates, explained, has_causes=bool(causes), has_unexplained=bool(unexplained))
    where = deviations(before, STANDS_OUT)
    if kind is Kind.UNKNOWN and others:
        first = others[0]  # what it depends on says more than what else that moves
        where = shared([first, *(one for one in where if one.feature != first.feature)])
    return Verdict(
        kind=kind,
        causes=causes,
        where=where,
        unexplained=unexplained if causes else where,
        gap=no_gap(evidence) if kind is Kind.NONE else gap_of(evidence, after_z if causes else evidence.z),
        after_z=after_z,
    )


def kind_of(deviates: Mask, explained: float, *, has_causes: bool, has_unexplained: bool) -> Kind:
    """What is said of the gap, by the features that deviate, (F,), and the share of them that is explained."""
    if not has_causes:
        return Kind.UNKNOWN if deviates.any() else Kind.NONE
    if not has_unexplained:
        return Kind.EFFECT
    return Kind.PARTLY if explained >= EXPLAINED else Kind.UNKNOWN


def _named(alternatives: Sequence[Alternatives], unexplained: float) -> tuple[NamedCause, ...]:
    """The most probable first."""
    named = [
        NamedCause(
            cause=one.cause,
            effect=effect_of(one),
            group=one.cause.candidate.group,
            meaning=KINDS[one.cause.name].meaning,
            probability=probability_of(LogisticFeatures(one.rival_weight, unexplained, one.cause.is_random)),
            parameters=parameters_of(one),
            tied_with=one.tied_with,
        )
        for one in alternatives
    ]
    # Of causes that are as good as equally probable, first what has no realisations to choose from.
    return tuple(sorted(named, key=lambda one: (-round(one.probability, 1), one.cause.candidate.realisations)))
