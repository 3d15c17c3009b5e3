"""The posterior over sets of effects and an unknown effect: probabilities and ties."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from gyrodrift.diagnose.inference.scorer import EffectSet, Scorer, log_prior_of
from gyrodrift.values.arrays import Floats, Mask

POWER = 0.8
"""Power of the likelihood. Measured: on 73 simulated cases and 35 of them without the true effect, the mean logarithm
of the stated probabilities is the same within 1 % from 0.6 to 1."""

RESEMBLING = 0.3
"""Prior odds of an unknown effect that resembles an effect to the effect itself. Chosen, not measured."""

TIED = 0.05
"""Least ratio at which two effects tie: the probability of the second without the first, to that of the first without
the second. Chosen: a rarer alternative is not worth a line."""

SIMILAR = 0.8
"""Least cosine of the changes of the features by two effects that tie. Chosen: at 0.8 one of them explains two thirds
of the squared gap of the other."""

MEMBER = 0.2
"""Least probability of the first effect of a slot: a sum over many improbable effects names none of them. Chosen."""

MASS = 0.95
"""Probability of the sets of effects that are listed together. Chosen, by convention: that of an interval."""

RARE = 0.02
"""Probability below which an effect is not reported. Chosen: less than the prior, so the recordings speak against
it."""


@dataclass(frozen=True, slots=True)
class WeightedSet:
    """A hypothesis: the effects that act, whether an unknown effect acts, and their joint probability."""

    names: frozenset[str]
    is_unknown: bool
    effect_set: EffectSet
    probability: float


@dataclass(frozen=True, slots=True)
class Slot:
    """An effect and the effects tied with it.

    probability
        Probability that the first effect acts.
    total
        Probability that any of them acts.
    """

    name: str
    tied_with: tuple[str, ...]
    probability: float
    total: float


class ProbableSet(NamedTuple):
    """Effects of the catalog that act together, whether something unknown acts too, and the probability of this."""

    effects: tuple[str, ...]
    is_unknown: bool
    probability: float


@dataclass(frozen=True)
class Posterior:
    """Hypotheses whose probabilities add up to 1."""

    hypotheses: tuple[WeightedSet, ...]

    @cached_property
    def weights(self) -> Floats:
        """(H,) probabilities."""
        return np.array([hypothesis.probability for hypothesis in self.hypotheses])

    @property
    def no_gap(self) -> float:
        """Probability that nothing acts."""
        return sum(
            hypothesis.probability
            for hypothesis in self.hypotheses
            if not hypothesis.names and not hypothesis.is_unknown
        )

    @property
    def unknown(self) -> float:
        """Probability that an effect outside the catalog acts."""
        return sum(hypothesis.probability for hypothesis in self.hypotheses if hypothesis.is_unknown)

    @property
    def most_probable(self) -> EffectSet:
        """The set of the most probable hypothesis."""
        return max(self.hypotheses, key=lambda hypothesis: hypothesis.probability).effect_set

    def by_mass(self, least: float) -> list[EffectSet]:
        """Fitted sets with at least this probability, with or without an unknown effect, the most probable first."""
        masses: dict[EffectSet, float] = {}
        for hypothesis in self.hypotheses:
            masses[hypothesis.effect_set] = masses.get(hypothesis.effect_set, 0.0) + hypothesis.probability
        return sorted((item for item, mass in masses.items() if mass > least), key=lambda item: -masses[item])

    def probable_sets(self) -> tuple[ProbableSet, ...]:
        """The fewest sets of effects that have MASS of the probability together, the most probable first."""
        masses: dict[tuple[tuple[str, ...], bool], float] = {}
        for item in self.hypotheses:
            key = tuple(sorted(name for name in item.names if not name.startswith("?"))), item.is_unknown
            masses[key] = masses.get(key, 0.0) + item.probability
        sets = [ProbableSet(*key, mass) for key, mass in sorted(masses.items(), key=lambda pair: -pair[1])]
        before = np.cumsum([0.0, *(item.probability for item in sets)])
        return tuple(item for item, mass in zip(sets, before[:-1], strict=True) if mass < MASS)

    def best_with(self, names: Collection[str]) -> EffectSet:
        """The most probable set with the given effects, or with as many of them as any set has."""
        required = {*names}
        return max(self.hypotheses, key=lambda item: (len(required & item.names), item.probability)).effect_set

    @cached_property
    def inclusion(self) -> dict[str, float]:
        """Probability of each effect."""
        names = sorted(set().union(*(hypothesis.names for hypothesis in self.hypotheses)))
        return {name: float(self.weights[self.has(name)].sum()) for name in names}

    def has(self, name: str) -> Mask:
        """(H,) hypotheses with an effect."""
        return np.array([name in hypothesis.names for hypothesis in self.hypotheses])

    def without(self, names: Collection[str]) -> "Posterior":
        """The posterior in which a hypothesis with the given effects counts as the hypothesis without them."""
        return Posterior(tuple(replace(item, names=item.names - {*names}) for item in self.hypotheses))

    def slots(self) -> list[Slot]:
        """Effects of the catalog with their ties, the most probable first. An effect is in a single slot."""
        remaining = {name: mass for name, mass in self.inclusion.items() if not name.startswith("?") and mass > RARE}
        slots = []
        while remaining:
            first = max(remaining, key=lambda name: remaining[name])
            if remaining[first] < MEMBER:
                break
            tied = [name for name in sorted(remaining, key=lambda name: -remaining[name]) if self._is_tied(first, name)]
            one_of = np.logical_or.reduce([self.has(name) for name in (first, *tied)])
            slots.append(Slot(first, tuple(tied), self.inclusion[first], float(self.weights[one_of].sum())))
            remaining = {name: mass for name, mass in remaining.items() if name not in {first, *tied}}
        return slots

    def _is_tied(self, first: str, name: str) -> bool:
        """Whether the second effect may act instead of the first, both seldom act together, and they look alike."""
        if name == first:
            return False
        has_first, has_name = self.has(first), self.has(name)
        alone, instead = (self.weights[mask].sum() for mask in (has_first & ~has_name, has_name & ~has_first))
        together = self.weights[has_first & has_name].sum()
        is_open = bool(instead >= TIED * max(alone, 1e-12) and together < 0.5 * self.inclusion[name])
        return is_open and self._similarity(first, name) >= SIMILAR

    def _similarity(self, first: str, name: str) -> float:
        """Cosine of the changes of the features by two effects at their best sizes; 1 for an effect not simulated."""
        changes = [self._change(effect) for effect in (first, name)]
        if any(change is None for change in changes):
            return 1.0
        a, b = (change.ravel() for change in changes if change is not None)
        return float(a @ b) / max(float(np.linalg.norm(a) * np.linalg.norm(b)), 1e-12)

    def _change(self, name: str) -> Floats | None:
        """(S, F) root mean square change by an effect with the sign of its mean, in standard deviations of chance."""
        placed = next((item for item in self.best_with({name}).placed if item.template.name == name), None)
        if placed is None:
            return None
        mean = placed.template.mean[placed.point]
        change: Floats = np.copysign(np.sqrt(np.square(mean) + placed.variance), mean)
        return change


def posterior_of(scorer: Scorer, sets: Sequence[EffectSet], power: float = POWER) -> Posterior:
    """Normalize over all sets, each with and without an unknown effect, and with one that resembles an effect."""
    drafts = [draft for effect_set in sets for draft in _drafts(scorer, effect_set, power)]
    log_weights = np.array([weight for *_, weight in drafts])
    weights = np.exp(log_weights - np.logaddexp.reduce(log_weights))
    return Posterior(
        tuple(
            WeightedSet(names, is_unknown, effect_set, float(weight))
            for (names, is_unknown, effect_set, _), weight in zip(drafts, weights, strict=True)
        )
    )


def _drafts(scorer: Scorer, effect_set: EffectSet, power: float) -> list[tuple[frozenset[str], bool, EffectSet, float]]:
    """Hypotheses with a set: names of the effects, whether an unknown effect acts, the set, and the log weight."""
    prior = sum(log_prior_of(placed.template) for placed in effect_set.placed)
    names = frozenset(effect_set.names)
    has_form = any(placed.template.is_out_of_catalogue for placed in effect_set.placed)
    none, some = scorer.with_priors(effect_set.without_unknown, effect_set.unknown, power)
    drafts = [(names, has_form, effect_set, prior + none), (names, True, effect_set, prior + some)]
    for name, (without_unknown, unknown) in zip(effect_set.names, effect_set.resembling, strict=False):
        if np.isfinite(without_unknown):
            like = prior + np.log(RESEMBLING)
            evidences = scorer.with_priors(without_unknown, unknown, power)
            drafts += [(names - {name}, True, effect_set, like + evidence) for evidence in evidences]
    return drafts
