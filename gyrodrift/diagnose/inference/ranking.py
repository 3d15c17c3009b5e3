"""Ranking of effects: evidence alone and with the named causes; and pairs with similar responses."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.inference.evidence import pooled_z
from gyrodrift.diagnose.inference.explanation import Explanation
from gyrodrift.diagnose.inference.gap import WORST_Z
from gyrodrift.diagnose.inference.parameters import unit_of
from gyrodrift.diagnose.inference.scorer import EffectSet, Placed
from gyrodrift.diagnose.inference.template import Template

SIMILAR = 0.8
"""Cosine of two responses from which on they are called similar."""


@dataclass(frozen=True, slots=True)
class Ranked:
    """A candidate at the size that fits best by itself.

    probability
        Posterior probability that it acts.
    gain
        Log evidence of the effect alone, minus that of the rig as it is.
    gain_with_causes
        Log evidence with the named causes, minus that of the causes; None for the causes and for untried sets.
    takes_away
        Explained share of the deviations; below 0 if it adds to them, None without deviations.
    """

    name: str
    stage: str
    group: str
    value: float
    unit: str
    probability: float
    gain: float
    gain_with_causes: float | None
    takes_away: float | None


@dataclass(frozen=True, slots=True)
class SimilarPair:
    """Two candidates that change the features of these sessions in similar proportions."""

    first: str
    second: str
    cosine: float


def ranking(explanation: Explanation) -> tuple[Ranked, ...]:
    """Effects of the catalog with a noticeable size, the largest evidence first."""
    sets = {frozenset(item.effect_set.names): item.effect_set for item in explanation.posterior.hypotheses}
    named = frozenset(explanation.named)
    alone = [
        item for names, item in sets.items() if len(names) == 1 and not item.placed[0].template.is_out_of_catalogue
    ]
    return tuple(sorted((_ranked(explanation, item, sets, named) for item in alone), key=lambda ranked: -ranked.gain))


def _ranked(
    explanation: Explanation, alone: EffectSet, sets: dict[frozenset[str], EffectSet], named: frozenset[str]
) -> Ranked:
    (placed,) = alone.placed
    candidate, name = placed.response.candidate, placed.template.name
    joined = sets.get(named | {name}) if name not in named else None
    with_causes = sets.get(named)
    return Ranked(
        name,
        candidate.stage,
        candidate.group,
        float(getattr(candidate.make(placed.size), candidate.parameter)),
        unit_of(candidate.parameter),
        explanation.posterior.inclusion.get(name, 0.0),
        alone.without_unknown - sets[frozenset()].without_unknown,
        joined.without_unknown - with_causes.without_unknown
        if joined is not None and with_causes is not None
        else None,
        _taken_away(explanation, placed),
    )


def _taken_away(explanation: Explanation, placed: Placed) -> float | None:
    """Explained share of the squared deviations; chance contributes a square of 1, which stays."""
    evidence, observation = explanation.evidence, explanation.scorer.observation
    before = pooled_z(evidence.z) / evidence.sigma_factor
    unexplained = (observation.difference - explanation.scorer.change([placed])) / np.sqrt(1.0 + placed.variance)
    after = pooled_z(np.where(observation.is_compared, unexplained, 0.0)) / evidence.sigma_factor
    deviates = np.abs(before) > evidence.threshold_z
    if not deviates.any():
        return None
    squares = [np.square(np.minimum(np.abs(z[deviates]), WORST_Z)) for z in (before, after)]
    beyond_chance = [np.maximum(z - 1.0, 0.0).sum() for z in squares]
    return float(1.0 - beyond_chance[1] / beyond_chance[0])


def similar_pairs(templates: Sequence[Template]) -> tuple[SimilarPair, ...]:
    """Pairs of effects that these sessions hardly separate, the most similar first."""
    directions = [
        (template.name, direction)
        for template in templates
        if not template.is_out_of_catalogue
        for direction in _directions(template)
    ]
    closest: dict[tuple[str, str], float] = {}
    for number, (first, direction) in enumerate(directions):
        for second, second_direction in directions[number + 1 :]:
            cosine = abs(float(direction @ second_direction))
            if first != second and cosine > max(SIMILAR, closest.get((first, second), 0.0)):
                closest[first, second] = cosine
    pairs = sorted(closest.items(), key=lambda pair: -pair[1])
    return tuple(SimilarPair(first, second, cosine) for (first, second), cosine in pairs)


def _directions(template: Template) -> list[Floats]:
    """Response of each variant at its smallest noticeable size, as vectors of length 1."""
    lengths = np.linalg.norm(template.mean.reshape(len(template.size), -1), axis=1)
    directions = []
    for response in np.unique(template.response):
        own = np.flatnonzero(template.response == response)
        smallest = own[lengths[own].argmin()]
        if lengths[smallest] > 0.0:
            directions.append(template.mean[smallest].ravel() / lengths[smallest])
    return directions
