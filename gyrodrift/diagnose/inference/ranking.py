"""Ranking of effects: evidence alone and with the named causes."""

from dataclasses import dataclass

from gyrodrift.diagnose.inference.explanation import Explanation
from gyrodrift.diagnose.inference.parameters import unit_of
from gyrodrift.diagnose.inference.scorer import EffectSet


@dataclass(frozen=True, slots=True)
class Ranked:
    """A candidate at the size that fits best by itself.

    probability
        Posterior probability that the effect acts.
    gain
        Log evidence of the effect alone, minus that of the rig as it is.
    gain_with_causes
        Log evidence of the causes with the effect, minus that of the causes; None for a cause and for an untried set.
    """

    name: str
    stage: str
    group: str
    value: float
    unit: str
    probability: float
    gain: float
    gain_with_causes: float | None


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
    )
