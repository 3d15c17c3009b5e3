"""How small each effect could have been and still been named in these sessions."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from firmware_sim.effects.effect import Effect
from gyrodrift.arrays import Floats
from gyrodrift.diagnose.inference.evidence import Response
from gyrodrift.diagnose.inference.parameters import unit_of
from gyrodrift.diagnose.inference.posterior import POWER
from gyrodrift.diagnose.inference.sets import ONE_POINT, Scorer, log_prior_of
from gyrodrift.diagnose.inference.template import Template

NINE_IN_TEN = 1.2816
"""Standard normal quantile that nine of ten recordings exceed."""


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


def detectable(scorer: Scorer, responses: Sequence[Response]) -> tuple[Detectable, ...]:
    """Of each effect of the catalog, in the order of the candidates: what nine of ten recordings show."""
    found: dict[str, Detectable] = {}
    for response in responses:
        candidate = response.candidate
        name = candidate.parameter
        one = Detectable(candidate.name, candidate.stage, name, None, unit_of(name))
        template = scorer.templates.get(candidate.name)
        if template is not None and response in template.responses:
            own = np.flatnonzero(template.response == template.responses.index(response))
            seen = template.size[own][odds(scorer, template.at(own)) > 0.0] if len(own) else np.zeros(0)
            if len(seen):
                effect = candidate.make(min((float(size) for size in seen), key=abs))
                one = replace(one, value=abs(float(getattr(effect, name))), at=_others(effect, name))
        known = found.get(candidate.name)
        if known is None or _shows_first(one, known) is (candidate.phase_deg is None):
            found[candidate.name] = one
    return tuple(found.values())


def odds(scorer: Scorer, template: Template) -> Floats:
    """(P,) log posterior odds of an effect against nothing that nine of ten recordings with it reach, about.

    A log-likelihood ratio with mean D scatters by the root of 2 D. What is random counts by what its features scatter:
    half the sum of v - log(1 + v), with v its variance in units of that without a gap.
    """
    covariance = scorer.observation.covariance
    shift = np.einsum("psf,fst,ptf->p", template.mean, np.linalg.inv(covariance), template.mean, optimize=True)
    diagonal = np.diagonal(covariance, axis1=1, axis2=2).T
    scatter = (template.scatter + np.square(template.factors).sum(axis=2)) / diagonal
    gain = 0.5 * shift + 0.5 * (scatter - np.log1p(scatter)).sum(axis=(1, 2))
    sure = gain - NINE_IN_TEN * np.sqrt(2.0 * gain)
    found: Floats = POWER * (sure + template.log_prior + ONE_POINT) + log_prior_of(template)
    return found


def _shows_first(one: Detectable, other: Detectable) -> bool:
    return one.value is not None and (other.value is None or one.value < other.value)


def _others(effect: Effect, parameter: str) -> dict[str, float]:
    return effect.model_dump(exclude_unset=True, exclude={"name", parameter, "phase_deg"})
