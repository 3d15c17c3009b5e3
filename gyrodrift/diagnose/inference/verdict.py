"""The verdict: its kind, the causes, the deviating features before and after, and negligible effects."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from firmware_sim.effects.effect import Effect
from gyrodrift.diagnose.inference.gap import Deviation, SimToRealGap
from gyrodrift.diagnose.inference.parameters import Parameter
from gyrodrift.diagnose.simulate.candidates import KINDS
from gyrodrift.diagnose.simulate.response_table import Sized

NEGLIGIBLE_DEG = 0.3
"""Mean absolute yaw in a session below which a small effect is negligible. Chosen: small beside the yaw error of a
usual session."""

ADOPTED_FROM = 0.5
"""Probability from which on a cause goes into the rig that is written. Chosen: it, or an effect that reads like it, is
more probable than not. Ties change these recordings alike, so the first of them corrects the simulator for such
motion."""

OPEN_FROM = 0.15
"""Probability of something unknown from which on a question is open. Chosen: the share of the gap that may stay open,
1 - CLOSED."""


class Kind(StrEnum):
    """Kind of a verdict."""

    NONE = "none"
    EFFECT = "effect"
    PARTLY = "partly"
    UNKNOWN = "unknown"


@dataclass(frozen=True, slots=True)
class NamedCause:
    """An effect that probably acts.

    meaning
        A sentence for a person.
    group_probability
        Probability that the effect acts, or an effect tied with it.
    gap_share
        Share of the gap that returns if only the other causes are added to the rig.
    is_withdrawn
        Whether the cause stays out of the rig that is written, because yaw is further from the recordings with it.
    """

    cause: Sized
    effect: Effect
    group: str
    meaning: str
    probability: float
    group_probability: float
    parameters: tuple[Parameter, ...]
    tied_with: tuple[str, ...]
    gap_share: float = 0.0
    is_withdrawn: bool = False

    @property
    def expected_share(self) -> float:
        """Expected share of the gap that the effect or its ties explain: `group_probability` times `gap_share`."""
        return self.group_probability * self.gap_share

    @property
    def in_rig(self) -> Effect | None:
        """The effect as the rig has it; None if the rig lacks it."""
        return self.cause.candidate.in_rig

    @property
    def is_adopted(self) -> bool:
        """Whether the cause goes into the rig that is written."""
        return self.group_probability >= ADOPTED_FROM and not self.is_withdrawn

    @property
    def is_as_in_rig(self) -> bool:
        """Whether the interval of the size holds the size in the rig."""
        has = self.in_rig
        return has is not None and all(
            parameter.low <= float(getattr(has, parameter.name)) <= parameter.high for parameter in self.parameters
        )

    def in_session(self, number: int, rig_effects: Sequence[Effect]) -> Effect:
        """The effect with the phase of session `number`; `rig_effects` are the effects in the rig of that session."""
        phases_deg = self.cause.phases_deg
        if phases_deg is None:
            return self.cause.candidate.at_rig_phase(self.effect, rig_effects)
        return self.effect.model_copy(update={"phase_deg": float(phases_deg[number])})


@dataclass(frozen=True, slots=True)
class Negligible:
    """An effect that acts and hardly changes yaw; `yaw_deg` is its mean absolute change, deg."""

    cause: NamedCause
    yaw_deg: float


@dataclass(frozen=True, slots=True)
class Verdict:
    """The verdict.

    causes
        Causes, the most probable first, as in `gap.json`.
    where, unexplained
        Features that deviate from the rig, and from the rig with the causes, the worst first.
    negligible
        Effects that act and hardly change yaw.
    probability_none, probability_unknown
        Posterior probabilities that nothing acts, and that something unknown acts; None if a baseline decided.
    """

    kind: Kind
    causes: tuple[NamedCause, ...]
    where: tuple[Deviation, ...]
    unexplained: tuple[Deviation, ...]
    gap: SimToRealGap
    negligible: tuple[Negligible, ...] = ()
    probability_none: float | None = None
    probability_unknown: float | None = None

    @property
    def may_have_unknown(self) -> bool:
        """Whether something unknown is probable enough to leave a question open."""
        return self.probability_unknown is not None and self.probability_unknown > OPEN_FROM

    @property
    def causes_by_share(self) -> tuple[NamedCause, ...]:
        """Causes by their expected share of the gap, the largest first: the order for people."""
        return tuple(sorted(self.causes, key=lambda cause: (-cause.expected_share, -cause.probability)))

    @property
    def acting(self) -> tuple[NamedCause, ...]:
        """Causes and negligible effects."""
        return (*self.causes, *(item.cause for item in self.negligible))


def is_small(cause: NamedCause) -> bool:
    """Whether an effect, or its difference to the rig, is below the size at which it matters."""
    name = cause.cause.candidate.parameter
    least = KINDS[cause.effect.name].matters_from or 0.0
    has = 0.0 if cause.in_rig is None else float(getattr(cause.in_rig, name))
    return abs(float(getattr(cause.effect, name)) - has) < least


def with_negligible(verdict: Verdict, costs_deg: Mapping[str, float]) -> Verdict:
    """The verdict with causes moved to `negligible` if they change yaw by less than NEGLIGIBLE_DEG."""
    aside = tuple(
        Negligible(cause, costs_deg[cause.effect.name])
        for cause in verdict.causes
        if costs_deg.get(cause.effect.name, np.inf) < NEGLIGIBLE_DEG
    )
    names = {cause.cause.effect.name for cause in aside}
    kept = tuple(cause for cause in verdict.causes if cause.effect.name not in names)
    kind = verdict.kind
    if aside and not kept:
        kind = Kind.NONE if verdict.kind is Kind.EFFECT else Kind.UNKNOWN
    return replace(verdict, kind=kind, causes=kept, negligible=aside)


def withdrawn(verdict: Verdict) -> Verdict:
    """The verdict with causes that stay out of the rig."""
    return replace(verdict, causes=tuple(replace(cause, is_withdrawn=True) for cause in verdict.causes))
