"""Sets of effects with their evidence, effect_set by a beam search.

    log evidence = log density at the best points + sum_i log sum_x prior_i(x) density_i(x) / density at the best   (3)

Each effect is summed over its own points beside the placed_others at theirs.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.inference.likelihood import combined
from gyrodrift.diagnose.posterior.density import FORM_ERROR, Groups, LogDensities, log_densities, log_no_unknown
from gyrodrift.diagnose.posterior.observation import Observation
from gyrodrift.diagnose.posterior.template import Template

EFFECT, OUT_OF_CATALOGUE = 0.03, 0.01
"""Prior probability of density effect, and of density form that no effect has."""

RESEMBLING_FORM_ERROR, RESEMBLING_SCATTER = 0.4, 4.0
"""Relative form error of an unknown effect that is only like an effect, and the factor of its scatter."""

MOST_EFFECTS = 3
BEAM = 6
"""Sets that are extended at density step."""

FITTED = 3 * BEAM
"""Sets of density size whose points are fitted together."""

LIKELIHOOD_POWER = 0.5
"""Power of the likelihood that the search goes by, lower than that of the posterior so that fewer sets are missed."""

CLOSE = 6.0
"""Log posterior below the best at which longer sets are no longer looked for."""

ONE_POINT = 1.0
"""Logarithm of how many points hold most of the evidence of an effect, before its points are summed."""


@dataclass(frozen=True, slots=True)
class PlacedTemplate:
    """A template at a point of its grid."""

    template: Template
    point: int


@dataclass(frozen=True, slots=True, eq=False)
class EffectSet:
    """A set of effects.

    without_unknown, unknown
        Log evidence without and with an unknown effect.
    placed
        The best point of each effect.
    resembling
        For each effect the log evidences, without and with an unknown effect, if an unknown effect only resembles it.
    """

    placed: tuple[PlacedTemplate, ...]
    without_unknown: float
    unknown: float
    resembling: tuple[tuple[float, float], ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the effects."""
        return tuple(placed.template.name for placed in self.placed)


def log_sum(values: Floats) -> float:
    """Logarithm of the sum of exponentials."""
    return float(np.logaddexp.reduce(values))


def log_prior_of(template: Template) -> float:
    """Log prior odds that an effect acts."""
    prior = OUT_OF_CATALOGUE if template.is_out_of_catalogue else EFFECT
    return float(np.log(prior / (1.0 - prior)))


@dataclass(frozen=True)
class Scorer:
    """Densities of sets of placed templates against an observation."""

    observation: Observation
    groups: Groups

    @cached_property
    def log_no_unknown(self) -> float:
        """Log prior that nothing unknown acts."""
        return log_no_unknown(self.groups.number)

    @cached_property
    def log_some_unknown(self) -> float:
        """Log prior that something unknown acts."""
        return float(np.log(-np.expm1(self.log_no_unknown)))

    def log_posterior(self, effect_set: EffectSet, power: float) -> float:
        """Log posterior of a set but for a constant, at a power of the likelihood."""
        prior = sum(log_prior_of(placed.template) for placed in effect_set.placed)
        evidence = (
            power * effect_set.without_unknown + self.log_no_unknown,
            power * effect_set.unknown + self.log_some_unknown,
        )
        return prior + log_sum(np.array(evidence))

    def nothing(self) -> EffectSet:
        """The empty set."""
        shape = self.observation.difference.shape
        without_unknown, unknown = self._densities((), np.zeros((1, *shape)), np.zeros((1, shape[1])), FORM_ERROR)
        return EffectSet((), float(without_unknown[0]), float(unknown[0]))

    def along(
        self, template: Template, placed_others: Sequence[PlacedTemplate], points: Iterable[int] | None = None
    ) -> LogDensities:
        """Densities at points of a template, all by default; `either` holds those with an unknown effect."""
        index = slice(None) if points is None else np.array([*points])
        return self._densities(placed_others, template.mean[index], template.scatter[index], FORM_ERROR)

    def along_resembling(self, template: Template, placed_others: Sequence[PlacedTemplate]) -> LogDensities:
        """Densities of an unknown effect that is only like the template."""
        return self._densities(
            placed_others, template.mean, RESEMBLING_SCATTER * template.scatter, RESEMBLING_FORM_ERROR
        )

    def _densities(
        self, placed_others: Sequence[PlacedTemplate], mean: Floats, scatter: Floats, form_error: float
    ) -> LogDensities:
        change, covariance = self._prediction(placed_others)
        residual = self.observation.difference - self._combined(change, mean)
        without_unknown, either = log_densities(residual, mean, scatter, covariance, self.groups, form_error)
        none = without_unknown + self.log_no_unknown
        unknown = either + np.log1p(-np.exp(np.minimum(none - either, -1e-12))) - self.log_some_unknown
        return LogDensities(without_unknown, unknown)

    def _prediction(self, placed_others: Sequence[PlacedTemplate]) -> tuple[Floats, Floats]:
        """(S, F) prediction and (F, S, S) covariance of placed templates."""
        change, covariance = np.zeros_like(self.observation.difference), self.observation.covariance.copy()
        sessions = np.arange(self.observation.sessions)
        for placed in placed_others:
            mean, scatter = placed.template.mean[placed.point], placed.template.scatter[placed.point]
            change = self._combined(change, mean)
            half = 0.5 * FORM_ERROR**2
            covariance += half * mean.T[:, :, None] * mean.T[:, None, :]
            covariance[:, sessions, sessions] += half * np.square(mean.T) + scatter[:, None]
        return change, covariance

    def _combined(self, change: Floats, increment: Floats) -> Floats:
        """Logarithms of variances add as variances, in the units of the features."""
        if not change.any():
            return np.broadcast_to(change, increment.shape) + increment
        unit = self.observation.unit
        added: Floats = combined(np.broadcast_to(change * unit, increment.shape), increment * unit) / unit
        return added


def find_sets(scorer: Scorer, templates: Sequence[Template]) -> list[EffectSet]:
    """All sets that the search looked at."""
    nothing = scorer.nothing()
    effect_set: dict[frozenset[str], EffectSet] = {frozenset(): nothing}
    frontier = [nothing]
    for depth in range(MOST_EFFECTS):
        longer = _extended(scorer, frontier, templates)
        effect_set.update(longer)
        frontier = sorted(
            longer.values(), key=lambda candidate_set: -scorer.log_posterior(candidate_set, LIKELIHOOD_POWER)
        )[:BEAM]
        best = max(scorer.log_posterior(candidate_set, LIKELIHOOD_POWER) for candidate_set in effect_set.values())
        if not frontier or (depth and scorer.log_posterior(frontier[0], LIKELIHOOD_POWER) < best - CLOSE):
            break
    return list(effect_set.values())


def _extended(
    scorer: Scorer, frontier: Sequence[EffectSet], templates: Sequence[Template]
) -> dict[frozenset[str], EffectSet]:
    """Sets with an additional effect; the points of the promising ones are fitted together."""
    longer: dict[frozenset[str], EffectSet] = {}
    for base in frontier:
        for template in templates:
            if template.name not in base.names:
                extended = _with(scorer, base, template)
                names = frozenset(extended.names)
                previous = longer.get(names)
                power = LIKELIHOOD_POWER
                if previous is None or scorer.log_posterior(extended, power) > scorer.log_posterior(previous, power):
                    longer[names] = extended
    best = sorted(longer.values(), key=lambda candidate_set: -scorer.log_posterior(candidate_set, LIKELIHOOD_POWER))[
        :FITTED
    ]
    return longer | {frozenset(candidate_set.names): _fitted(scorer, candidate_set) for candidate_set in best}


def _with(scorer: Scorer, base: EffectSet, template: Template) -> EffectSet:
    """A set with a template increment, summed over its coarse points only."""
    densities = scorer.along(template, base.placed, template.coarse)
    log_prior = template.log_prior[template.coarse]
    scale = log_sum(template.log_prior) - log_sum(log_prior)
    without_unknown, unknown = (
        log_sum(density + log_prior) + scale for density in (densities.without_unknown, densities.either)
    )
    placed_others = sum(float(placed.template.log_prior[placed.point]) + ONE_POINT for placed in base.placed)
    best = _best(densities, log_prior)
    placed = (*base.placed, PlacedTemplate(template, int(template.coarse[best])))
    return EffectSet(placed, without_unknown + placed_others, unknown + placed_others)


def _best(densities: LogDensities, log_prior: Floats) -> int:
    without_unknown, unknown = densities.without_unknown, densities.either
    return int(
        np.argmax((without_unknown if without_unknown.max() > unknown.max() - LESS_LIKELY else unknown) + log_prior)
    )


LESS_LIKELY = 5.0
"""Log density by which an unknown effect has to fit better before points are chosen beside it."""


def _fitted(scorer: Scorer, effect_set: EffectSet) -> EffectSet:
    """The best point of each effect beside the best of the placed_others, and evidence by equation (3)."""
    placed = list(effect_set.placed)
    for _ in range(2 if len(placed) > 1 else 1):
        widths = np.zeros(2)
        for i, current in enumerate(placed):
            template = current.template
            densities = scorer.along(template, [*placed[:i], *placed[i + 1 :]])
            best = _best(densities, template.log_prior)
            placed[i] = PlacedTemplate(template, best)
            for k, density in enumerate((densities.without_unknown, densities.either)):
                widths[k] += log_sum(density + template.log_prior) - density[best]
    without_unknown, unknown = (
        float(densities.without_unknown[best] + widths[0]),
        float(densities.either[best] + widths[1]),
    )
    fitted = EffectSet(tuple(placed), without_unknown, unknown)
    return EffectSet(fitted.placed, without_unknown, unknown, tuple(_resembling(scorer, fitted)))


def _resembling(scorer: Scorer, effect_set: EffectSet) -> list[tuple[float, float]]:
    evidences = []
    for i, placed in enumerate(effect_set.placed):
        template, placed_others = placed.template, [*effect_set.placed[:i], *effect_set.placed[i + 1 :]]
        if template.is_out_of_catalogue:
            evidences.append((-np.inf, -np.inf))
            continue
        resembling, exact = scorer.along_resembling(template, placed_others), scorer.along(template, placed_others)
        gains = [
            log_sum(a + template.log_prior) - log_sum(b + template.log_prior)
            for a, b in ((resembling.without_unknown, exact.without_unknown), (resembling.either, exact.either))
        ]
        evidences.append((effect_set.without_unknown + gains[0], effect_set.unknown + gains[1]))
    return evidences
