"""Smallest size of each effect that these sessions would have shown."""

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
        None if no size that was tried would.
    other_parameters
        Its other parameters, such as the height of a jump, of the most sensitive variant. A phase is none of them: the
        size shows at any phase.
    """

    effect: str
    stage: str
    parameter: str
    value: float | None
    unit: str
    other_parameters: Mapping[str, float] = field(default_factory=dict)


def detectable(scorer: Scorer, responses: Sequence[Response]) -> tuple[Detectable, ...]:
    """Smallest size of each effect that nine of ten such sets of recordings show, in the order of the candidates."""
    smallest: dict[str, Detectable] = {}
    for response in responses:
        candidate = response.candidate
        name = candidate.parameter
        result = Detectable(candidate.name, candidate.stage, name, None, unit_of(name))
        template = scorer.templates.get(candidate.name)
        if template is not None and response in template.responses:
            own = np.flatnonzero(template.response == template.responses.index(response))
            noticed = template.size[own][odds(scorer, template.subset(own)) > 0.0] if len(own) else np.zeros(0)
            if len(noticed):
                effect = candidate.make(min((float(size) for size in noticed), key=abs))
                result = replace(
                    result, value=abs(float(getattr(effect, name))), other_parameters=_other_parameters(effect, name)
                )
        earlier = smallest.get(candidate.name)
        if earlier is None or _shows_first(result, earlier) is (candidate.phase_deg is None):
            smallest[candidate.name] = result
    return tuple(smallest.values())


def odds(scorer: Scorer, template: Template) -> Floats:
    """(P,) log posterior odds of an effect against nothing that about nine of ten recordings with it reach.

    A log-likelihood ratio with mean D has a standard deviation of sqrt(2 D). A random effect counts by the variance v
    of its features, in units of the variance without a gap: half the sum of v - log(1 + v).
    """
    covariance = scorer.observation.covariance
    shift = np.einsum("psf,fst,ptf->p", template.mean, np.linalg.inv(covariance), template.mean, optimize=True)
    diagonal = np.diagonal(covariance, axis1=1, axis2=2).T
    scatter = (template.scatter + np.square(template.factors).sum(axis=2)) / diagonal
    gain = 0.5 * shift + 0.5 * (scatter - np.log1p(scatter)).sum(axis=(1, 2))
    sure = gain - NINE_IN_TEN * np.sqrt(2.0 * gain)
    log_odds: Floats = POWER * (sure + template.log_prior + ONE_POINT) + log_prior_of(template)
    return log_odds


def _shows_first(result: Detectable, earlier: Detectable) -> bool:
    return result.value is not None and (earlier.value is None or result.value < earlier.value)


def _other_parameters(effect: Effect, parameter: str) -> dict[str, float]:
    return effect.model_dump(exclude_unset=True, exclude={"name", parameter, "phase_deg"})
