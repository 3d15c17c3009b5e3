"""The posterior of one effect's size, beside the other effects of a set."""

from dataclasses import dataclass

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.inference.evidence import Response
from gyrodrift.diagnose.posterior.sets import EffectSet, Scorer

CREDIBLE = (0.025, 0.5, 0.975)
"""Quantiles: a central interval that holds the true size in 95 % of cases, and the median."""


@dataclass(frozen=True, slots=True)
class SizePosterior:
    """Size of an effect in its most probable variant, in the unit of the candidate.

    index
        Of the grid size next to the median.
    """

    response: Response
    index: int
    median: float
    low: float
    high: float


def size_posterior(scorer: Scorer, effect_set: EffectSet, name: str, power: float) -> SizePosterior:
    """Quantiles between the sizes of the grid, weighted by prior and density to a power."""
    placed = next(placed_one for placed_one in effect_set.placed if placed_one.template.name == name)
    template = placed.template
    densities = scorer.along(template, [placed_one for placed_one in effect_set.placed if placed_one is not placed])
    log_density = np.logaddexp(
        power * densities.without_unknown + scorer.log_no_unknown, power * densities.either + scorer.log_some_unknown
    )
    weights = np.exp(log_density + template.log_prior - (log_density + template.log_prior).max())
    by_response = np.bincount(template.response, weights, len(template.responses))
    best = int(by_response.argmax())
    chosen = template.response == best
    sizes, mass = template.values()[chosen], weights[chosen]
    low, median, high = (float(value) for value in _quantiles(sizes, mass))
    grid = template.responses[best].candidate.sizes
    index = int(np.abs(grid - median).argmin())
    return SizePosterior(template.responses[best], index, median, low, high)


def _quantiles(sizes: Floats, mass: Floats) -> Floats:
    """CREDIBLE of a density that is linear between the sizes, in rising order."""
    order = np.argsort(sizes)
    sizes, mass = sizes[order], mass[order]
    if len(sizes) == 1:
        return np.full(len(CREDIBLE), sizes[0])
    cells = 0.5 * (mass[1:] + mass[:-1])
    total = np.concatenate([[0.0], np.cumsum(cells)])
    quantiles: Floats = np.interp(CREDIBLE, total / total[-1], sizes)
    return quantiles
