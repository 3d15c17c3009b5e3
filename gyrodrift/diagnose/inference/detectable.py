"""How small each effect could have been and still been seen in these sessions."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from firmware_sim.effects.effect import Effect
from gyrodrift.diagnose.inference.acceptance import GAIN
from gyrodrift.diagnose.inference.evidence import Evidence
from gyrodrift.diagnose.inference.parameters import unit_of
from gyrodrift.diagnose.inference.realisations import sure_gains

CLEAR_GAIN = 2.0 * GAIN
"""Of the log-likelihood: twice what accepts a cause. What is random has to gain so much, since the realisations of
another device differ from those that are simulated."""


@dataclass(frozen=True, slots=True)
class Detectable:
    """The smallest size of an effect that these sessions would have shown.

    value
        None where no size that was tried would.
    at
        Its other parameters, such as the height of a jump: of the variant that shows first. A phase, which nobody knows
        beforehand, is none of them: the size shows at any.
    """

    effect: str
    stage: str
    parameter: str
    value: float | None
    unit: str
    at: Mapping[str, float] = field(default_factory=dict)


def detectable(evidence: Evidence) -> tuple[Detectable, ...]:
    """Of each effect of the catalogue that was tried, in the order of the candidates: what nine of ten recordings show.

    Of one that is random, what nine of ten devices do.
    """
    found: dict[str, Detectable] = {}
    for response in evidence.responses:
        candidate = response.candidate
        if candidate.is_out_of_catalogue:
            continue
        name, unit = candidate.parameter, unit_of(candidate.parameter)
        asked = GAIN if response.realised is None else CLEAR_GAIN
        seen = candidate.sizes[sure_gains(evidence, response) > asked]
        one = Detectable(candidate.name, candidate.stage, name, None, unit)
        if len(seen):
            effect = candidate.make(min((float(size) for size in seen), key=abs))
            one = replace(one, value=abs(float(getattr(effect, name))), at=_others(effect, name))
        known = found.get(candidate.name)
        if known is None or _shows_first(one, known) is (candidate.phase_deg is None):
            found[candidate.name] = one
    return tuple(found.values())


def _shows_first(one: Detectable, other: Detectable) -> bool:
    return one.value is not None and (other.value is None or one.value < other.value)


def _others(effect: Effect, parameter: str) -> dict[str, float]:
    return effect.model_dump(exclude_unset=True, exclude={"name", parameter, "phase_deg"})
