"""Densities of sets of placed effects against an observation, with their priors and corrections."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple, TypeVar

import numpy as np

from gyrodrift.diagnose.features.vector import combined
from gyrodrift.diagnose.inference.density import (
    Groups,
    log_densities,
    log_no_unknown,
)
from gyrodrift.diagnose.inference.evidence import Response
from gyrodrift.diagnose.inference.factors import explained
from gyrodrift.diagnose.inference.observation import Observation
from gyrodrift.diagnose.inference.template import Template
from gyrodrift.diagnose.simulate.response_table import SimulatedSet, Sized
from gyrodrift.values.arrays import Floats

Values = TypeVar("Values", float, Floats)

EFFECT, OUT_OF_CATALOGUE = 0.03, 0.01
"""Prior probability of an effect, and of an out-of-catalog form. Chosen: of 28 effects, about one acts."""

MOVED = 0.02
"""Relative change of a size after which a set is simulated again. Chosen: two steps of the finer sizes."""

EXACT, CLOSE_TO_IT, USUAL, RESEMBLING = 0.02, 0.05, 0.1, 0.4
"""Relative standard deviation of each feature of an effect about its simulation, called the form error. An effect with
an exact form (a gain, a limit) has 0.02 or 0.1, any other effect 0.05 or 0.1. An unknown effect that resembles an
effect has 0.4. Chosen, not measured."""

SCATTER = {USUAL: 2.0, RESEMBLING: 4.0}
"""Factor of the variance of a random effect by the error of its form, otherwise 1. A device scatters more than the
simulated process. Measured: 1/f noise as others simulate it needs about 2. Chosen: 4, twice that."""

ONE_POINT = 1.0
"""Logarithm of the number of points that hold most of the evidence of an effect, used before its points are summed.
Chosen: an estimate, about three points."""

TINY = 1e-30
"""Least square in a division. Chosen: far below every square that counts."""


class Placed(NamedTuple):
    """A template at one of its points, and the relative error of its form."""

    template: Template
    point: int
    form_error: float = USUAL

    @property
    def size(self) -> float:
        """Size in the unit of the candidate."""
        return float(self.template.size[self.point])

    @property
    def response(self) -> Response:
        """Variant and phase."""
        return self.template.responses[int(self.template.response[self.point])]

    @property
    def sized(self) -> Sized:
        """Candidate, size and phases for a simulation."""
        return Sized(self.response.candidate, self.size, self.response.phases_deg)

    @property
    def variance(self) -> Floats:
        """(S, F) of a random effect."""
        total: Floats = self.template.scatter[self.point] + np.square(self.template.factors[self.point]).sum(axis=1)
        return total


class Densities(NamedTuple):
    """(P,) log densities at points of a template, without an unknown effect and given that one acts."""

    without_unknown: Floats
    unknown: Floats


class Correction(NamedTuple):
    """Simulated change of a whole set minus the sum of its templates: (S, F) change and its variance.

    sizes
        Sizes at which the set was simulated, by name of the effect.
    """

    change: Floats
    variance: Floats
    sizes: Mapping[str, float]


@dataclass(frozen=True, slots=True, eq=False)
class EffectSet:
    """A set of effects.

    placed
        The best point of each effect.
    without_unknown, unknown
        Log evidence without and with an unknown effect.
    resembling
        For each effect: log evidences without and with another unknown effect, if an unknown effect resembles it.
    """

    placed: tuple[Placed, ...]
    without_unknown: float
    unknown: float
    resembling: tuple[tuple[float, float], ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the effects."""
        return tuple(placed.template.name for placed in self.placed)


def log_prior_of(template: Template) -> float:
    """Log prior odds that an effect acts."""
    prior = OUT_OF_CATALOGUE if template.is_out_of_catalogue else EFFECT
    return float(np.log(prior / (1.0 - prior)))


@dataclass(frozen=True)
class Scorer:
    """Densities of sets of placed templates against an observation.

    templates
        Template of each effect, with all its points.
    background
        Random effects that act in any case, such as those of a baseline. They add variance and no mean.
    corrections
        Corrections of sets that were simulated as a whole, by their names.
    """

    observation: Observation
    groups: Groups
    templates: Mapping[str, Template]
    background: tuple[Placed, ...] = ()
    corrections: dict[frozenset[str], Correction] = field(default_factory=dict)

    def of_sessions(self, rows: Sequence[int]) -> "Scorer":
        """The scorer of some sessions."""
        return Scorer(
            self.observation.of_sessions(rows),
            self.groups,
            {name: template.of_sessions(rows) for name, template in self.templates.items()},
            tuple(item._replace(template=item.template.of_sessions(rows)) for item in self.background),
            {
                names: correction._replace(change=correction.change[rows], variance=correction.variance[rows])
                for names, correction in self.corrections.items()
            },
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
        """Log posterior of a set, except for a constant, with a power of the likelihood."""
        prior = sum(log_prior_of(placed.template) for placed in effect_set.placed)
        return prior + float(np.logaddexp(*self.with_priors(effect_set.without_unknown, effect_set.unknown, power)))

    def with_priors(self, without_unknown: Values, unknown: Values, power: float) -> tuple[Values, Values]:
        """Log evidences or densities at a power, each with the prior of its state of the unknown effect."""
        return power * without_unknown + self.log_no_unknown, power * unknown + self.log_some_unknown

    def nothing(self) -> EffectSet:
        """The empty set."""
        shape = self.observation.difference.shape
        none = np.zeros((1, *shape))
        _, covariance = self.prediction(())
        residual = self.observation.difference - none
        residual, cost = self._without_factors(
            residual, np.zeros((1, shape[0], 0, shape[1])), (), none, none, covariance
        )
        without_unknown, unknown = self._of_residual(residual, none, none, none, covariance)
        return EffectSet((), float((without_unknown + cost)[0]), float((unknown + cost)[0]))

    def along(self, template: Template, fixed: Sequence[Placed], form_error: float = USUAL) -> Densities:
        """Densities at all points of a template; the other effects of the set are fixed."""
        change, covariance = self.prediction(fixed, template.name)
        residual = self.observation.difference - self._combined(change, template.mean)
        correction = self._correction({*(placed.template.name for placed in fixed), template.name})
        is_simulated = False
        if correction is not None:
            names, of_set = correction
            residual = residual - of_set.change
            is_simulated = template.name in names
        form = _form(template.mean, 0.0 if is_simulated else template.interpolation_sigma, form_error)
        wider = SCATTER.get(form_error, 1.0)
        scatter = wider * template.scatter
        residual, cost = self._without_factors(
            residual, np.sqrt(wider) * template.factors, fixed, form, scatter, covariance
        )
        without_unknown, unknown = self._of_residual(residual, template.mean, scatter, form, covariance)
        return Densities(without_unknown + cost, unknown + cost)

    def _without_factors(
        self, residual: Floats, own: Floats, fixed: Sequence[Placed], form: Floats, scatter: Floats, covariance: Floats
    ) -> tuple[Floats, Floats]:
        """Residual minus the part that random effects explain, and the log density of that part."""
        placed = np.concatenate(
            [
                np.zeros((residual.shape[1], 0, residual.shape[2])),
                *(item.template.factors[item.point] for item in (*fixed, *self.background)),
            ],
            axis=1,
        )
        if own.shape[2] + placed.shape[1] == 0:
            return residual, np.zeros(len(residual))
        diagonal = np.diagonal(covariance, axis1=1, axis2=2).T
        variance = diagonal + np.square(form) + scatter
        return explained(residual, np.ascontiguousarray(own), placed, variance, self.observation.degrees)

    def prediction(self, placed: Sequence[Placed], *joining: str) -> tuple[Floats, Floats]:
        """(S, F) change and (F, S, S) covariance by a set; `joining` are names of effects that will join it.

        The change is that of the templates alone; the covariance holds the error of a correction.
        """
        covariance = self.observation.covariance.copy()
        sessions = np.arange(self.observation.sessions)
        correction = self._correction({*(item.template.name for item in placed), *joining})
        simulated = frozenset() if correction is None else correction[0]
        for item in placed:
            template, point = item.template, item.point
            interpolation_sigma = 0.0 if template.name in simulated else template.interpolation_sigma[point]
            form = _form(template.mean[point], interpolation_sigma, item.form_error).T
            covariance += 0.5 * form[:, :, None] * form[:, None, :]
            covariance[:, sessions, sessions] += 0.5 * np.square(form) + template.scatter[point].T
        for item in self.background:
            covariance[:, sessions, sessions] += item.template.scatter[item.point].T
        if correction is not None:
            covariance[:, sessions, sessions] += correction[1].variance.T
        return self._summed(placed), covariance

    def _summed(self, placed: Sequence[Placed]) -> Floats:
        """(S, F) change by the templates of a set alone."""
        change = np.zeros_like(self.observation.difference)
        for item in placed:
            change = self._combined(change, item.template.mean[item.point])
        return change

    def is_simulated(self, effect_set: EffectSet) -> bool:
        """Whether a set was simulated as a whole."""
        return frozenset(effect_set.names) in self.corrections

    def has_moved(self, effect_set: EffectSet) -> bool:
        """Whether a size of a set that was simulated as a whole has changed by more than MOVED since."""
        correction = self.corrections.get(frozenset(effect_set.names))
        if correction is None:
            return False
        pairs = [(item.size, correction.sizes[item.template.name]) for item in effect_set.placed]
        return any(abs(size - simulated) > MOVED * abs(simulated) for size, simulated in pairs)

    def correct(self, effect_set: EffectSet, simulated: SimulatedSet) -> None:
        """Store the simulated change of a set minus the sum of its templates.

        The change is shrunk by its own error. The variance of a difference between two independent runs is twice that
        of chance; variance beyond that is charged as variance of the set.
        """
        unit, compared = self.observation.unit, self.observation.is_compared
        variance = simulated.variance / np.square(unit)
        away = np.where(compared, simulated.change / unit - self._summed(effect_set.placed), 0.0)
        template_variance = sum((placed.variance for placed in effect_set.placed), np.zeros_like(unit))
        excess_variance = np.maximum(variance.mean(axis=0) - 2.0 - template_variance, 0.0) + variance / simulated.runs
        change = beyond_noise(away, variance / simulated.runs)
        sizes = {item.template.name: item.size for item in effect_set.placed}
        correction = Correction(change, np.where(compared, excess_variance, 0.0), sizes)
        self.corrections[frozenset(effect_set.names)] = correction

    def change(self, placed: Sequence[Placed]) -> Floats:
        """(S, F) change by a set, corrected where it was simulated as a whole."""
        change = self._summed(placed)
        correction = self._correction({item.template.name for item in placed})
        return change if correction is None else change + correction[1].change

    def _correction(self, names: set[str]) -> tuple[frozenset[str], Correction] | None:
        """Correction of the largest part of a set that was simulated."""
        parts = [part for part in self.corrections.items() if part[0] <= names]
        return max(parts, key=lambda part: len(part[0]), default=None)

    def _of_residual(
        self, residual: Floats, mean: Floats, scatter: Floats, form: Floats, covariance: Floats
    ) -> Densities:
        without_unknown, either = log_densities(
            residual, mean, scatter, form, covariance, self.groups, self.observation.degrees
        )
        none = without_unknown + self.log_no_unknown
        unknown = either + np.log1p(-np.exp(np.minimum(none - either, -1e-12))) - self.log_some_unknown
        return Densities(without_unknown, unknown)

    def _combined(self, change: Floats, increment: Floats) -> Floats:
        """Logarithms of variances add as variances, in the units of the features."""
        if not change.any():
            return np.broadcast_to(change, increment.shape) + increment
        unit = self.observation.unit
        added: Floats = combined(np.broadcast_to(change * unit, increment.shape), increment * unit) / unit
        return added


def beyond_noise(change: Floats, variance: Floats) -> Floats:
    """Shrink a change by its variance: 0 if it is not larger than its standard error.

    Shrinkage after W. James and C. Stein, Estimation with quadratic loss (1961). The mean of a few simulations of a
    random effect is not 0 by chance.
    """
    squares = np.square(change)
    believed: Floats = change * np.maximum(squares - variance, 0.0) / np.maximum(squares, TINY)
    return believed


def _form(mean: Floats, interpolation_sigma: Floats | float, form_error: float) -> Floats:
    """Standard deviation of a mean, with its sign."""
    form: Floats = np.copysign(np.hypot(form_error * mean, interpolation_sigma), mean)
    return form
