"""Sets of effects with their evidence, found by a beam search.

    log evidence = log density at the best points + sum_i log sum_x prior_i(x) density_i(x) / density at the best   (3)

Each effect is summed over its own points (variant, size and form error), with the other effects at their best points.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from gyrodrift.diagnose.inference.ridge import pair_in, placed_together
from gyrodrift.diagnose.inference.scorer import (
    CLOSE_TO_IT,
    EXACT,
    ONE_POINT,
    RESEMBLING,
    USUAL,
    Densities,
    EffectSet,
    Placed,
    Scorer,
)
from gyrodrift.diagnose.inference.template import COARSE_STEP, Template
from gyrodrift.values.arrays import Floats

MOST_EFFECTS = 3
"""Largest number of effects in a set. Chosen: for speed."""

BEAM = 6
"""Number of sets that are extended by one effect. Chosen: for speed."""

FITTED = 3 * BEAM
"""Number of sets of one size whose points are fitted together. Chosen: for speed."""

LIKELIHOOD_POWER = 0.5
"""Power of the likelihood in the search. Chosen: lower than that of the posterior so that fewer sets are missed."""

CLOSE = 6.0
"""Log posterior below the best set at which the search for longer sets ends. Chosen: for speed; e⁻⁶ is a quarter of a
percent."""

SUMMED_RESPONSES = 3
"""Number of variants of an effect whose points are summed. Chosen: for speed."""

LESS_LIKELY = 5.0
"""Log density by which an unknown effect has to fit better before points are chosen together with it. Chosen: e⁵ is
150, which chance hardly reaches."""


class EffectProfile(NamedTuple):
    """One effect at its points; the other effects of a set are fixed at their points.

    best, at_best
        The point that fits best, and the log densities there, without and with an unknown effect.
    parts
        The points that were summed, with their densities at each form error of the effect. The last form error is
        RESEMBLING.
    """

    best: Placed
    at_best: Floats
    parts: tuple[tuple[Template, tuple[Densities, ...]], ...]

    def log_sums(self) -> Floats:
        """Log evidence of the effect without and with an unknown effect; its form errors are equally probable."""
        sums = [_sums(template, densities) for template, by_form in self.parts for densities in by_form[:-1]]
        total: Floats = _total(sums) - np.log(len(self.parts[0][1]) - 1)
        return total

    def log_sums_resembling(self) -> Floats:
        """Log evidence, without and with an unknown effect, of an unknown effect that resembles the effect."""
        return _total([_sums(template, by_form[-1]) for template, by_form in self.parts])


def _sums(template: Template, densities: Densities) -> list[float]:
    return [log_sum(density + template.log_prior) for density in densities]


def _total(sums: Sequence[list[float]]) -> Floats:
    total: Floats = np.logaddexp.reduce(np.array(sums), axis=0)
    return total


def log_sum(values: Floats) -> float:
    """Logarithm of the sum of exponentials."""
    return float(np.logaddexp.reduce(values))


def find_sets(scorer: Scorer) -> list[EffectSet]:
    """All sets that the search evaluated."""
    by_names = {frozenset[str](): scorer.nothing()}
    frontier = [*by_names.values()]
    for depth in range(MOST_EFFECTS):
        longer = extended(scorer, frontier)
        by_names.update(longer)
        frontier = sorted(longer.values(), key=lambda item: -scorer.log_posterior(item, LIKELIHOOD_POWER))[:BEAM]
        best = max(scorer.log_posterior(item, LIKELIHOOD_POWER) for item in by_names.values())
        if not frontier or (depth and scorer.log_posterior(frontier[0], LIKELIHOOD_POWER) < best - CLOSE):
            break
    return list(by_names.values())


def extended(scorer: Scorer, frontier: Sequence[EffectSet]) -> dict[frozenset[str], EffectSet]:
    """Sets with an additional effect; the points of the best sets are fitted together."""
    longer: dict[frozenset[str], EffectSet] = {}
    for base in frontier:
        for template in scorer.templates.values():
            if template.name not in base.names:
                item = _with(scorer, base, template)
                names = frozenset(item.names)
                earlier = longer.get(names)
                if earlier is None or (
                    scorer.log_posterior(item, LIKELIHOOD_POWER) > scorer.log_posterior(earlier, LIKELIHOOD_POWER)
                ):
                    longer[names] = item
    best = sorted(longer.values(), key=lambda item: -scorer.log_posterior(item, LIKELIHOOD_POWER))[:FITTED]
    return longer | {frozenset(item.names): fitted(scorer, item) for item in best}


def _with(scorer: Scorer, base: EffectSet, template: Template) -> EffectSet:
    """A set with an additional template, summed over its coarse points; a pair that compensates is fitted jointly."""
    if pair_in([*base.names, template.name]) not in (None, pair_in(base.names)):
        return fitted(scorer, EffectSet((*base.placed, Placed(template, 0)), 0.0, 0.0))
    coarse = template.subset(template.coarse)
    densities = scorer.along(coarse, base.placed)
    scale = log_sum(template.log_prior) - log_sum(coarse.log_prior)
    without_unknown, unknown = (log_sum(density + coarse.log_prior) + scale for density in densities)
    log_widths = sum(float(placed.template.log_prior[placed.point]) + ONE_POINT for placed in base.placed)
    placed = (*base.placed, Placed(template, int(template.coarse[_best(densities, coarse.log_prior)])))
    return EffectSet(placed, without_unknown + log_widths, unknown + log_widths)


def _best(densities: Densities, log_prior: Floats) -> int:
    """Index of the point that fits best; with an unknown effect only if that fits better by LESS_LIKELY."""
    without_unknown, unknown = densities
    return int(
        np.argmax((without_unknown if without_unknown.max() > unknown.max() - LESS_LIKELY else unknown) + log_prior)
    )


def fitted(scorer: Scorer, effect_set: EffectSet) -> EffectSet:
    """Place each effect at its best point, given the other effects, and compute the evidence by equation (3)."""
    placed = placed_together(scorer, effect_set.placed)
    if not placed:
        return scorer.nothing()
    for _ in range(2 if len(placed) > 1 else 1):
        profiles = []
        for i, current in enumerate(placed):
            profile = profile_of(scorer, current.template.name, [*placed[:i], *placed[i + 1 :]])
            placed[i] = profile.best
            profiles.append(profile)
    widths = [profile.log_sums() - profile.at_best for profile in profiles]
    evidence = profiles[-1].at_best + np.sum(widths, axis=0)
    resembling = [
        (-np.inf, -np.inf)
        if item.template.is_out_of_catalogue
        else _pair(evidence + profile.log_sums_resembling() - profile.log_sums())
        for item, profile in zip(placed, profiles, strict=True)
    ]
    return EffectSet(tuple(placed), float(evidence[0]), float(evidence[1]), tuple(resembling))


def _pair(values: Floats) -> tuple[float, float]:
    return float(values[0]), float(values[1])


def profile_of(scorer: Scorer, name: str, fixed: Sequence[Placed]) -> EffectProfile:
    """Sum an effect over points near the best points of its best variants; the grid is finer about the best point."""
    template = scorer.templates[name]
    coarse = template.subset(template.coarse)
    rough = scorer.along(coarse, fixed)
    order = np.argsort(-(np.maximum(*rough) + coarse.log_prior))
    _, first = np.unique(coarse.response[order], return_index=True)
    centers = template.coarse[order[np.sort(first)[:SUMMED_RESPONSES]]]
    nearby = [template.near(int(center), COARSE_STEP) for center in centers]
    points = template.subset(np.concatenate(nearby))
    usual = scorer.along(points, fixed)
    best = int(np.concatenate(nearby)[_best(usual, points.log_prior)])
    divided = template.near(best, 1)
    kept = sorted({*map(int, np.concatenate(nearby))} - {*divided})
    form_errors = known_forms(template)
    templates = (template.finer(divided), *([template.subset(kept)] if kept else []))
    parts = tuple(
        (part, tuple(scorer.along(part, fixed, error) for error in (*form_errors, RESEMBLING))) for part in templates
    )
    return EffectProfile(*_best_of(*parts[0], form_errors), parts)


def known_forms(template: Template) -> tuple[float, ...]:
    """Possible form errors of an effect, equally probable."""
    if template.is_out_of_catalogue:
        return (USUAL,)
    return (EXACT if template.responses[0].candidate.is_exact else CLOSE_TO_IT, USUAL)


def _best_of(template: Template, by_form: Sequence[Densities], form_errors: Sequence[float]) -> tuple[Placed, Floats]:
    """Best point over all form errors, and the log densities there, without and with an unknown effect."""
    points = [_best(densities, template.log_prior) for densities in by_form[:-1]]
    at_points = [
        np.array([density[point] for density in densities])
        for point, densities in zip(points, by_form[:-1], strict=True)
    ]
    form = int(np.argmax([max(pair[0], pair[1] - LESS_LIKELY) for pair in at_points]))
    return Placed(template, points[form], form_errors[form]), at_points[form]
