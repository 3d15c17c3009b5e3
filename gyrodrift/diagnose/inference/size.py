"""Posterior of the size of an effect, given the other effects of a set."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gyrodrift.diagnose.inference.evidence import Response
from gyrodrift.diagnose.inference.ridge import pair_in, summed_along
from gyrodrift.diagnose.inference.scorer import EffectSet, Scorer
from gyrodrift.diagnose.inference.sets import profile_of
from gyrodrift.values.arrays import Floats

CREDIBLE = (0.025, 0.5, 0.975)
"""Quantiles: a central interval that holds the true size in 95 % of cases, and the median."""


@dataclass(frozen=True, slots=True)
class SizePosterior:
    """Size of an effect in its most probable variant, in the unit of the candidate.

    is_low_open, is_high_open
        Whether the interval ends at the smallest or the largest size that was tried.
    """

    response: Response
    median: float
    low: float
    high: float
    is_low_open: bool = False
    is_high_open: bool = False


def size_posterior(scorer: Scorer, effect_set: EffectSet, name: str, power: float) -> SizePosterior:
    """Quantiles of the sizes in the most probable variant, weighted by prior and density to a power.

    If another effect of the set acts like this effect, the posterior is summed over the size of the other effect.
    """
    fixed = [placed for placed in effect_set.placed if placed.template.name != name]
    profile = profile_of(scorer, name, fixed)
    response = int(profile.best.template.response[profile.best.point])
    sizes, log_weights = [], []
    for template, by_form in profile.parts:
        is_same = template.response == response
        for densities in by_form[:-1]:
            log_density = np.logaddexp(*scorer.with_priors(*densities, power))
            sizes.append(template.size[is_same])
            log_weights.append((log_density + template.log_prior)[is_same])
    pair = pair_in(effect_set.names)
    if pair is not None and name in pair:
        sizes, log_weights = ([values] for values in summed_along(scorer, effect_set.placed, name, power))
    low, median, high = quantiles(np.concatenate(sizes), np.concatenate(log_weights), CREDIBLE)
    best = profile.best.template.responses[response]
    return SizePosterior(best, median, low, high, *open_ends(best.candidate.sizes, low, high))


def open_ends(tried: Floats, low: float, high: float) -> tuple[bool, bool]:
    """Whether an interval ends within half a step of the smallest and of the largest size that was tried."""
    if len(tried) == 1:
        return False, False
    return bool(low < 0.5 * (tried[0] + tried[1])), bool(high > 0.5 * (tried[-1] + tried[-2]))


def quantiles(sizes: Floats, log_weights: Floats, shares: Sequence[float]) -> list[float]:
    """Quantiles of weighted sizes; the weight of a size is spread over the interval halfway to its neighbors."""
    every, slot = np.unique(sizes, return_inverse=True)
    mass = np.bincount(slot, np.exp(log_weights - log_weights.max()))
    if len(every) == 1:
        return [float(every[0])] * len(shares)
    edges = np.concatenate([every[:1], 0.5 * (every[1:] + every[:-1]), every[-1:]])
    total = np.concatenate([[0.0], np.cumsum(mass)]) / mass.sum()
    return [float(value) for value in np.interp(shares, total, edges)]
