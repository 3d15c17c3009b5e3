"""Smallest size of each effect that these sessions would have shown."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np
from scipy.special import chdtri

from firmware_sim.effects.effect import Effect
from gyrodrift.diagnose.inference.evidence import Response
from gyrodrift.diagnose.inference.parameters import unit_of
from gyrodrift.diagnose.inference.posterior import POWER, RESEMBLING
from gyrodrift.diagnose.inference.scorer import ONE_POINT, TINY, Scorer, log_prior_of
from gyrodrift.diagnose.inference.template import Template
from gyrodrift.values.arrays import Floats

SURE = 0.9
"""Share of the recordings with an effect that show it. Chosen: nine of ten, by convention."""

NINE_IN_TEN = 1.2816
"""Standard normal deviate beyond which one of ten recordings lies. Derived: the 0.9 quantile of the normal
distribution."""


@dataclass(frozen=True, slots=True)
class Detectable:
    """The smallest size of an effect that these sessions would have shown.

    value
        The size; None if these sessions would not have shown any size that was tried.
    other_parameters
        Other parameters of the effect, such as the height of a jump, in the most sensitive variant. The phase is left
        out, because the size shows at any phase.
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
        # The most sensitive variant counts, but the least sensitive phase.
        if earlier is None or _shows_first(result, earlier) is (candidate.phase_deg is None):
            smallest[candidate.name] = result
    return tuple(smallest.values())


def odds(scorer: Scorer, template: Template) -> Floats:
    """(P,) log posterior odds of an effect that about nine of ten recordings with it reach.

    The odds are those against nothing and against an unknown effect that resembles it.

    The log-likelihood ratio of a shift with mean D has a standard deviation of sqrt(2 D). A random effect has the
    variances v along its principal axes, in units of the variance without a gap. Its ratio has the mean
    sum(v - log(1 + v)) / 2 and scatters as sum(v x^2) / 2, with x standard normal.
    """
    shift = _shift(scorer, template)
    scatter = _scatter(scorer, template)
    margin = np.hypot(NINE_IN_TEN * np.sqrt(shift), 0.5 * (scatter.trace - scatter.exceeded))
    sure = 0.5 * (shift + scatter.trace - scatter.log_determinant) - margin
    log_odds: Floats = POWER * (sure + template.log_prior + ONE_POINT) + log_prior_of(template)
    return log_odds + math.log1p(-RESEMBLING)


def _shift(scorer: Scorer, template: Template) -> Floats:
    """(P,) squared length of the mean, in units of the covariance without a gap."""
    inverse = np.linalg.inv(scorer.observation.covariance)
    shift: Floats = np.einsum("psf,fst,ptf->p", template.mean, inverse, template.mean, optimize=True)
    return shift


class _Scatter(NamedTuple):
    """Sums over the variances v of a random effect along its principal axes, (P,) each.

    trace, log_determinant
        Sums of v and of log(1 + v).
    exceeded
        Value that sum(v x^2) exceeds in nine of ten recordings, with x standard normal.
    """

    trace: Floats
    log_determinant: Floats
    exceeded: Floats


def _scatter(scorer: Scorer, template: Template) -> _Scatter:
    """Approximate sum(v x^2) by a multiple of a chi-squared variable with the same mean and variance.

    F. E. Satterthwaite, An approximate distribution of estimates of variance components (1946).
    """
    diagonal = np.diagonal(scorer.observation.covariance, axis1=1, axis2=2).T
    own, factors = template.scatter / diagonal, template.factors / np.sqrt(diagonal)[:, None]
    gram, whitened = factors @ factors.swapaxes(2, 3), (factors / (1.0 + own[:, :, None])) @ factors.swapaxes(2, 3)
    trace = own.sum(axis=(1, 2)) + np.trace(gram, axis1=2, axis2=3).sum(axis=1)
    squares = np.square(own).sum(axis=(1, 2)) + np.square(gram).sum(axis=(1, 2, 3))
    squares += 2.0 * (np.square(factors) * own[:, :, None]).sum(axis=(1, 2, 3))
    log_determinant = np.log1p(own).sum(axis=(1, 2))
    log_determinant += np.linalg.slogdet(np.eye(factors.shape[2]) + whitened)[1].sum(axis=1)
    degrees = np.square(trace) / np.maximum(squares, TINY)
    quantile = np.where(trace > 0.0, chdtri(np.maximum(degrees, TINY), SURE), 0.0)
    return _Scatter(trace, log_determinant, quantile * squares / np.maximum(trace, TINY))


def _shows_first(result: Detectable, earlier: Detectable) -> bool:
    """Whether the first variant shows a smaller size than the second."""
    return result.value is not None and (earlier.value is None or result.value < earlier.value)


def _other_parameters(effect: Effect, parameter: str) -> dict[str, float]:
    return effect.model_dump(exclude_unset=True, exclude={"name", parameter, "phase_deg"})
