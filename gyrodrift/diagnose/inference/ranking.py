"""Every effect in a row: what each alone would explain, what it adds to the causes found, and which look alike."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.inference.deviations import WORST_Z
from gyrodrift.diagnose.inference.explanation import Explanation
from gyrodrift.diagnose.inference.family_wise import pooled_z
from gyrodrift.diagnose.inference.parameters import unit_of
from gyrodrift.diagnose.inference.sets import EffectSet, Placed
from gyrodrift.diagnose.inference.template import Template

ALIKE = 0.8
"""Cosine of two responses from which on they are called alike."""


@dataclass(frozen=True, slots=True)
class Ranked:
    """A candidate at the size that fits best by itself.

    gain
        Of the logarithm of the evidence over the rig as it stands, all sessions together.
    gain_beside
        The same over the causes that were found, when it joins them; None for these, and where that was not tried.
    takes_away
        Share of what deviates; below 0 where it adds to it, None where nothing deviates.
    """

    name: str
    stage: str
    group: str
    value: float
    unit: str
    gain: float
    gain_beside: float | None
    takes_away: float | None


@dataclass(frozen=True, slots=True)
class Alike:
    """Two candidates that change the features of these sessions in nearly the same proportions."""

    first: str
    second: str
    cosine: float


def ranking(explanation: Explanation) -> tuple[Ranked, ...]:
    """Effects of the catalog that some size of would be noticed, the best first."""
    sets = {frozenset(item.effect_set.names): item.effect_set for item in explanation.posterior.hypotheses}
    named = frozenset(explanation.named)
    alone = [
        item for names, item in sets.items() if len(names) == 1 and not item.placed[0].template.is_out_of_catalogue
    ]
    return tuple(sorted((_ranked(explanation, item, sets, named) for item in alone), key=lambda one: -one.gain))


def _ranked(
    explanation: Explanation, alone: EffectSet, sets: dict[frozenset[str], EffectSet], named: frozenset[str]
) -> Ranked:
    (placed,) = alone.placed
    candidate, name = placed.response.candidate, placed.template.name
    beside = sets.get(named | {name}) if name not in named else None
    with_causes = sets.get(named)
    return Ranked(
        name,
        candidate.stage,
        candidate.group,
        float(getattr(candidate.make(placed.size), candidate.parameter)),
        unit_of(candidate.parameter),
        alone.without_unknown - sets[frozenset()].without_unknown,
        beside.without_unknown - with_causes.without_unknown
        if beside is not None and with_causes is not None
        else None,
        _taken_away(explanation, placed),
    )


def _taken_away(explanation: Explanation, placed: Placed) -> float | None:
    """Share of the squares of what deviates; chance has a square of 1, which nothing takes away."""
    evidence, observation = explanation.evidence, explanation.scorer.observation
    before = pooled_z(evidence.z) / evidence.caution
    left = (observation.difference - explanation.scorer.change([placed])) / np.sqrt(1.0 + placed.variance)
    after = pooled_z(np.where(observation.is_compared, left, 0.0)) / evidence.caution
    deviates = np.abs(before) > evidence.stands_out
    if not deviates.any():
        return None
    squares = [np.square(np.minimum(np.abs(z[deviates]), WORST_Z)) for z in (before, after)]
    held = [np.maximum(each - 1.0, 0.0).sum() for each in squares]
    return float(1.0 - held[1] / held[0])


def lookalikes(templates: Sequence[Template]) -> tuple[Alike, ...]:
    """Pairs of effects that these sessions hardly separate, the closest first."""
    directions = [
        (template.name, direction)
        for template in templates
        if not template.is_out_of_catalogue
        for direction in _directions(template)
    ]
    closest: dict[tuple[str, str], float] = {}
    for number, (first, one) in enumerate(directions):
        for second, other in directions[number + 1 :]:
            cosine = abs(float(one @ other))
            if first != second and cosine > max(ALIKE, closest.get((first, second), 0.0)):
                closest[first, second] = cosine
    pairs = sorted(closest.items(), key=lambda pair: -pair[1])
    return tuple(Alike(first, second, cosine) for (first, second), cosine in pairs)


def _directions(template: Template) -> list[Floats]:
    """What each variant does at the smallest size that would be noticed, as vectors of length 1."""
    lengths = np.linalg.norm(template.mean.reshape(len(template.size), -1), axis=1)
    found = []
    for response in np.unique(template.response):
        own = np.flatnonzero(template.response == response)
        at = own[lengths[own].argmin()]
        if lengths[at] > 0.0:
            found.append(template.mean[at].ravel() / lengths[at])
    return found
