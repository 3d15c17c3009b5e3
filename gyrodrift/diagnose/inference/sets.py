"""Sets of effects with their evidence, found by a beam search.

    log evidence = log density at the best points + sum_i log sum_x prior_i(x) density_i(x) / density at the best   (3)

Each effect is summed over its own points (variant, size and form error) beside the others at their best ones.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.inference.density import (
    DEGREES_OF_FREEDOM,
    Groups,
    LogDensities,
    log_densities,
    log_no_unknown,
)
from gyrodrift.diagnose.inference.evidence import Response
from gyrodrift.diagnose.inference.factors import explained
from gyrodrift.diagnose.inference.log_variances import combined
from gyrodrift.diagnose.inference.observation import Observation
from gyrodrift.diagnose.inference.template import COARSE_STEP, Template
from gyrodrift.diagnose.simulate.response_table import SimulatedSet, Sized

EFFECT, OUT_OF_CATALOGUE = 0.03, 0.01
"""Prior probability of an effect, and of a form that no effect has."""

EXACT, CLOSE_TO_IT, USUAL, RESEMBLING = 0.02, 0.05, 0.1, 0.4
"""Relative standard deviation by which each feature of an effect may differ from the simulated one: of an effect that
is as the simulator has it, of a usual one, and of an unknown one that is only like it."""

RESEMBLING_SCATTER = 4.0
"""Factor of the variance of a random effect for one that is only like it."""

MOST_EFFECTS = 3
BEAM = 6
"""Sets that are extended by one effect."""

FITTED = 3 * BEAM
"""Sets of one size whose points are fitted together."""

LIKELIHOOD_POWER = 0.5
"""Power of the likelihood that the search goes by, lower than that of the posterior so that fewer sets are missed."""

CLOSE = 6.0
"""Log posterior below the best at which longer sets are no longer looked for."""

ONE_POINT = 1.0
"""Logarithm of how many points hold most of the evidence of an effect, before its points are summed."""

RIVAL_RESPONSES = 3
"""Variants of an effect whose points are summed."""

LESS_LIKELY = 5.0
"""Log density by which an unknown effect has to fit better before points are chosen beside it."""


class Placed(NamedTuple):
    """A template at one of its points, and the relative error of its form."""

    template: Template
    point: int
    form_error: float = USUAL

    @property
    def size(self) -> float:
        """In units of the candidate's sizes."""
        return float(self.template.size[self.point])

    @property
    def response(self) -> Response:
        """Variant and phase."""
        return self.template.responses[int(self.template.response[self.point])]

    @property
    def sized(self) -> Sized:
        """As it is simulated."""
        return Sized(self.response.candidate, self.size, self.response.phases_deg)

    @property
    def variance(self) -> Floats:
        """(S, F) of a random effect."""
        total: Floats = self.template.scatter[self.point] + np.square(self.template.factors[self.point]).sum(axis=1)
        return total


class Correction(NamedTuple):
    """What a simulation of a whole set adds to the sum of its templates: (S, F) change and its variance."""

    change: Floats
    variance: Floats


@dataclass(frozen=True, slots=True, eq=False)
class EffectSet:
    """A set of effects.

    placed
        The best point of each effect.
    without_unknown, unknown
        Log evidence without and with an unknown effect.
    resembling
        For each effect the log evidences, without and with an unknown effect, if an unknown effect only resembles it.
    """

    placed: tuple[Placed, ...]
    without_unknown: float
    unknown: float
    resembling: tuple[tuple[float, float], ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the effects."""
        return tuple(placed.template.name for placed in self.placed)


class Profile(NamedTuple):
    """One effect beside others at their points.

    best, at_best
        The point that fits best, and the log densities there, without and with an unknown effect.
    parts
        The points that were summed, with their densities at each of the form errors of the effect, the last of which is
        that of what only resembles it.
    """

    best: Placed
    at_best: Floats
    parts: tuple[tuple[Template, tuple[LogDensities, ...]], ...]

    def log_sums(self) -> Floats:
        """Log evidence without and with an unknown effect, of the effect; its form errors are equally probable."""
        sums = [_sums(template, one) for template, by_form in self.parts for one in by_form[:-1]]
        total: Floats = _total(sums) - np.log(len(self.parts[0][1]) - 1)
        return total

    def log_sums_resembling(self) -> Floats:
        """The same of what only resembles it."""
        return _total([_sums(template, by_form[-1]) for template, by_form in self.parts])


def _sums(template: Template, densities: LogDensities) -> list[float]:
    return [log_sum(density + template.log_prior) for density in densities]


def _total(sums: Sequence[list[float]]) -> Floats:
    total: Floats = np.logaddexp.reduce(np.array(sums), axis=0)
    return total


def log_sum(values: Floats) -> float:
    """Logarithm of the sum of exponentials."""
    return float(np.logaddexp.reduce(values))


def log_prior_of(template: Template) -> float:
    """Log prior odds that an effect acts."""
    prior = OUT_OF_CATALOGUE if template.is_out_of_catalogue else EFFECT
    return float(np.log(prior / (1.0 - prior)))


@dataclass(frozen=True)
class Scorer:
    """Densities of sets of placed templates against an observation.

    templates
        Of each effect, with all its points.
    corrections
        Of sets that were simulated as a whole, by their names.
    """

    observation: Observation
    groups: Groups
    templates: Mapping[str, Template]
    corrections: dict[frozenset[str], Correction] = field(default_factory=dict)

    def of_sessions(self, rows: Sequence[int]) -> "Scorer":
        """The same with some of the sessions."""
        return Scorer(
            self.observation.of_sessions(rows),
            self.groups,
            {name: template.of_sessions(rows) for name, template in self.templates.items()},
            {names: Correction(one.change[rows], one.variance[rows]) for names, one in self.corrections.items()},
        )

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
        none = np.zeros((1, *shape))
        known = self._of_residual(self.observation.difference - none, none, none, none, self.observation.covariance)
        return EffectSet((), float(known.without_unknown[0]), float(known.either[0]))

    def along(self, template: Template, others: Sequence[Placed], form_error: float = USUAL) -> LogDensities:
        """Densities at all points of a template; `either` holds those with an unknown effect."""
        change, covariance = self.prediction(others, template.name)
        residual = self.observation.difference - self._combined(change, template.mean)
        correction = self._correction({*(placed.template.name for placed in others), template.name})
        is_simulated = False
        if correction is not None:
            names, of_set = correction
            residual = residual - of_set.change
            is_simulated = template.name in names
        form = _form(template.mean, 0.0 if is_simulated else template.doubt, form_error)
        wider = RESEMBLING_SCATTER if form_error == RESEMBLING else 1.0
        scatter = wider * template.scatter
        residual, cost = self._beside_factors(
            residual, np.sqrt(wider) * template.factors, others, form, scatter, covariance
        )
        known, unknown = self._of_residual(residual, template.mean, scatter, form, covariance)
        return LogDensities(known + cost, unknown + cost)

    def _beside_factors(
        self, residual: Floats, own: Floats, others: Sequence[Placed], form: Floats, scatter: Floats, covariance: Floats
    ) -> tuple[Floats, Floats]:
        """Residual less what random effects explain of it, and the logarithm of what that costs."""
        placed = np.concatenate(
            [np.zeros((residual.shape[1], 0, residual.shape[2])), *(one.template.factors[one.point] for one in others)],
            axis=1,
        )
        if own.shape[2] + placed.shape[1] == 0:
            return residual, np.zeros(len(residual))
        diagonal = np.diagonal(covariance, axis1=1, axis2=2).T
        variance = diagonal + np.square(form) + scatter
        return explained(residual, np.ascontiguousarray(own), placed, variance, DEGREES_OF_FREEDOM)

    def prediction(self, placed: Sequence[Placed], *more: str) -> tuple[Floats, Floats]:
        """(S, F) change by a set and (F, S, S) covariance beside it; `more` names stand for what joins it.

        The change is that of the templates alone; the covariance holds the error of a correction.
        """
        change, covariance = np.zeros_like(self.observation.difference), self.observation.covariance.copy()
        sessions = np.arange(self.observation.sessions)
        correction = self._correction({*(one.template.name for one in placed), *more})
        simulated = frozenset() if correction is None else correction[0]
        for one in placed:
            template, point = one.template, one.point
            change = self._combined(change, template.mean[point])
            doubt = 0.0 if template.name in simulated else template.doubt[point]
            form = _form(template.mean[point], doubt, one.form_error).T
            covariance += 0.5 * form[:, :, None] * form[:, None, :]
            covariance[:, sessions, sessions] += 0.5 * np.square(form) + template.scatter[point].T
        if correction is not None:
            covariance[:, sessions, sessions] += correction[1].variance.T
        return change, covariance

    def is_simulated(self, effect_set: EffectSet) -> bool:
        """Whether it was simulated as a whole."""
        return frozenset(effect_set.names) in self.corrections

    def correct(self, effect_set: EffectSet, simulated: SimulatedSet) -> None:
        """Remember what a simulation of a set adds to the sum of its templates.

        Of a change no more is believed than its own error leaves. A recording is one more run; two runs that have
        nothing in common differ by chance twice, and what they differ by beyond that joins the variance.
        """
        unit, compared = self.observation.unit, self.observation.is_compared
        summed, _ = self.prediction(effect_set.placed)
        variance = simulated.variance / np.square(unit)
        away = np.where(compared, simulated.change / unit - summed, 0.0)
        known = sum((placed.variance for placed in effect_set.placed), np.zeros_like(unit))
        more = np.maximum(variance.mean(axis=0) - 2.0 - known, 0.0) + variance / simulated.runs
        change = beyond_noise(away, variance / simulated.runs)
        self.corrections[frozenset(effect_set.names)] = Correction(change, np.where(compared, more, 0.0))

    def change(self, placed: Sequence[Placed]) -> Floats:
        """(S, F) change by a set, corrected where it was simulated as a whole."""
        change, _ = self.prediction(placed)
        correction = self._correction({one.template.name for one in placed})
        return change if correction is None else change + correction[1].change

    def _correction(self, names: set[str]) -> tuple[frozenset[str], Correction] | None:
        """Of the largest part of a set that was simulated."""
        parts = [(known, correction) for known, correction in self.corrections.items() if known <= names]
        return max(parts, key=lambda part: len(part[0]), default=None)

    def _of_residual(
        self, residual: Floats, mean: Floats, scatter: Floats, form: Floats, covariance: Floats
    ) -> LogDensities:
        without_unknown, either = log_densities(residual, mean, scatter, form, covariance, self.groups)
        none = without_unknown + self.log_no_unknown
        unknown = either + np.log1p(-np.exp(np.minimum(none - either, -1e-12))) - self.log_some_unknown
        return LogDensities(without_unknown, unknown)

    def _combined(self, change: Floats, increment: Floats) -> Floats:
        """Logarithms of variances add as variances, in the units of the features."""
        if not change.any():
            return np.broadcast_to(change, increment.shape) + increment
        unit = self.observation.unit
        added: Floats = combined(np.broadcast_to(change * unit, increment.shape), increment * unit) / unit
        return added


TINY = 1e-30
"""Keeps a share of nothing from being undefined."""


def beyond_noise(change: Floats, variance: Floats) -> Floats:
    """What is to be believed of a change that is known with a variance: nothing of what is no larger than its error.

    Shrinkage after W. James and C. Stein, Estimation with quadratic loss (1961). A random cause that may go either way
    does so in the mean of a few simulations, too.
    """
    squares = np.square(change)
    believed: Floats = change * np.maximum(squares - variance, 0.0) / np.maximum(squares, TINY)
    return believed


def _form(mean: Floats, doubt: Floats | float, form_error: float) -> Floats:
    """Standard deviation of a mean, with its sign."""
    form: Floats = np.copysign(np.hypot(form_error * mean, doubt), mean)
    return form


def find_sets(scorer: Scorer) -> list[EffectSet]:
    """All sets that the search looked at."""
    found = {frozenset[str](): scorer.nothing()}
    frontier = [*found.values()]
    for depth in range(MOST_EFFECTS):
        longer = extended(scorer, frontier)
        found.update(longer)
        frontier = sorted(longer.values(), key=lambda item: -scorer.log_posterior(item, LIKELIHOOD_POWER))[:BEAM]
        best = max(scorer.log_posterior(item, LIKELIHOOD_POWER) for item in found.values())
        if not frontier or (depth and scorer.log_posterior(frontier[0], LIKELIHOOD_POWER) < best - CLOSE):
            break
    return list(found.values())


def extended(scorer: Scorer, frontier: Sequence[EffectSet]) -> dict[frozenset[str], EffectSet]:
    """Sets with one effect more; the points of the promising ones are fitted together."""
    longer: dict[frozenset[str], EffectSet] = {}
    for base in frontier:
        for template in scorer.templates.values():
            if template.name not in base.names:
                item = _with(scorer, base, template)
                names = frozenset(item.names)
                known = longer.get(names)
                if known is None or (
                    scorer.log_posterior(item, LIKELIHOOD_POWER) > scorer.log_posterior(known, LIKELIHOOD_POWER)
                ):
                    longer[names] = item
    best = sorted(longer.values(), key=lambda item: -scorer.log_posterior(item, LIKELIHOOD_POWER))[:FITTED]
    return longer | {frozenset(item.names): fitted(scorer, item) for item in best}


def _with(scorer: Scorer, base: EffectSet, template: Template) -> EffectSet:
    """A set with one template more, summed over its coarse points only."""
    coarse = template.at(template.coarse)
    densities = scorer.along(coarse, base.placed)
    scale = log_sum(template.log_prior) - log_sum(coarse.log_prior)
    known, unknown = (log_sum(one + coarse.log_prior) + scale for one in densities)
    others = sum(float(placed.template.log_prior[placed.point]) + ONE_POINT for placed in base.placed)
    placed = (*base.placed, Placed(template, int(template.coarse[_best(densities, coarse.log_prior)])))
    return EffectSet(placed, known + others, unknown + others)


def _best(densities: LogDensities, log_prior: Floats) -> int:
    known, unknown = densities
    return int(np.argmax((known if known.max() > unknown.max() - LESS_LIKELY else unknown) + log_prior))


def fitted(scorer: Scorer, effect_set: EffectSet) -> EffectSet:
    """The best point of each effect beside the best of the others, and evidence by equation (3)."""
    placed = list(effect_set.placed)
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
        if one.template.is_out_of_catalogue
        else _pair(evidence + profile.log_sums_resembling() - profile.log_sums())
        for one, profile in zip(placed, profiles, strict=True)
    ]
    return EffectSet(tuple(placed), float(evidence[0]), float(evidence[1]), tuple(resembling))


def _pair(values: Floats) -> tuple[float, float]:
    return float(values[0]), float(values[1])


def profile_of(scorer: Scorer, name: str, others: Sequence[Placed]) -> Profile:
    """Sum the points near the best of the best variants; the best of all and its neighbors are divided further."""
    template = scorer.templates[name]
    coarse = template.at(template.coarse)
    rough = scorer.along(coarse, others)
    order = np.argsort(-(np.maximum(*rough) + coarse.log_prior))
    _, first = np.unique(coarse.response[order], return_index=True)
    centers = template.coarse[order[np.sort(first)[:RIVAL_RESPONSES]]]
    nearby = [template.near(int(center), COARSE_STEP) for center in centers]
    points = template.at(np.concatenate(nearby))
    usual = scorer.along(points, others)
    best = int(np.concatenate(nearby)[_best(usual, points.log_prior)])
    divided = template.near(best, 1)
    kept = sorted({*map(int, np.concatenate(nearby))} - {*divided})
    known = known_forms(template)
    templates = (template.finer(divided), *([template.at(kept)] if kept else []))
    parts = tuple(
        (part, tuple(scorer.along(part, others, error) for error in (*known, RESEMBLING))) for part in templates
    )
    return Profile(*_best_of(*parts[0], known), parts)


def known_forms(template: Template) -> tuple[float, ...]:
    """Form errors that an effect may have, equally probable."""
    if template.is_out_of_catalogue:
        return (USUAL,)
    return (EXACT if template.responses[0].candidate.is_exact else CLOSE_TO_IT, USUAL)


def _best_of(template: Template, by_form: Sequence[LogDensities], known: Sequence[float]) -> tuple[Placed, Floats]:
    places = [_best(densities, template.log_prior) for densities in by_form[:-1]]
    at_places = [
        np.array([density[place] for density in densities])
        for place, densities in zip(places, by_form[:-1], strict=True)
    ]
    form = int(np.argmax([max(both[0], both[1] - LESS_LIKELY) for both in at_places]))
    return Placed(template, places[form], known[form]), at_places[form]
