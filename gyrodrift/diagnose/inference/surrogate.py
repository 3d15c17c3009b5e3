"""The surrogate of the simulator: tables of responses that are added, corrected where a set was simulated as a whole.

A hypothesis is a set of candidates with sizes. The surrogate predicts a mean and a spread for every feature of every
session under it. It never changes: what is learned from a further simulation makes a new one, so that every prediction
and every score follows from the surrogate and the set alone.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.inference.evidence import Evidence, Response
from gyrodrift.diagnose.inference.likelihood import Scatter, combined, log_likelihood_of_events
from gyrodrift.diagnose.simulate.candidate import Candidate
from gyrodrift.diagnose.simulate.response_table import SimulatedSet

FREE_PHASE_COST = 1.0
"""Log-likelihood that a phase gains in a session by being fitted to it, where there is nothing: two normal numbers in
place of one are worth a half to one."""

TINY = 1e-30
"""Keeps a share of nothing from being undefined."""


@dataclass(frozen=True, slots=True)
class Cause:
    """A candidate at one of its sizes; `at` is the number of the size."""

    response: Response
    at: int

    @property
    def candidate(self) -> Candidate:
        """What may act."""
        return self.response.candidate

    @property
    def name(self) -> str:
        """Of the effect."""
        return self.candidate.name

    @property
    def is_out_of_catalogue(self) -> bool:
        """Whether no effect of the simulator does this."""
        return self.candidate.is_out_of_catalogue

    @property
    def is_random(self) -> bool:
        """Whether two realisations of it differ."""
        return self.candidate.realisations > 1

    @property
    def size(self) -> float:
        """In the units of the candidate's sizes."""
        return float(self.candidate.sizes[self.at])


def without(causes: Sequence[Cause], one: Cause) -> tuple[Cause, ...]:
    """The other causes of a set."""
    return tuple(cause for cause in causes if cause is not one)


class Prediction(NamedTuple):
    """Of a set of causes, (sessions, F) each.

    change
        Of the features.
    scatter
        By random causes, and by what is not known of a set from a few simulations of it.
    discrepancy
        The model-discrepancy variance.
    """

    change: Floats
    scatter: Scatter
    discrepancy: Floats

    @property
    def variance(self) -> Floats:
        """Of the scatter."""
        return self.scatter.variance


class Correction(NamedTuple):
    """What simulations of a set of candidates as a whole say, (sessions, F) each.

    change
        What the tables lack of it.
    variance
        What scatters about it, beyond chance and what random causes do.
    """

    responses: frozenset[Response]
    change: Floats
    variance: Floats


@dataclass(frozen=True, slots=True, eq=False)
class Surrogate:
    """Predictions on evidence that does not change.

    corrections
        One for each set that was simulated; where two fit a larger set equally well, the first holds.
    """

    evidence: Evidence
    corrections: tuple[Correction, ...] = ()

    def prediction(self, causes: Sequence[Cause]) -> Prediction:
        """What a set of causes does."""
        added, known = self._added(causes), self._correction(_responses(causes))
        if known is None:
            return added
        return added._replace(change=added.change + known.change, scatter=added.scatter.widened(known.variance))

    def scores(self, causes: Sequence[Cause]) -> Floats:
        """(sessions,) logarithm of the likelihood of each session's features, less the price of phases fitted to it."""
        predicted, evidence = self.prediction(causes), self.evidence
        fitted = sum(cause.response.phases_deg is not None for cause in causes)
        left, scatter = evidence.difference - predicted.change, predicted.scatter.through(evidence.variance_with)
        likelihood = log_likelihood_of_events(left, scatter, predicted.discrepancy)
        return likelihood - FREE_PHASE_COST * fitted

    def standardised_residuals(self, causes: Sequence[Cause]) -> Floats:
        """(sessions, F) what the causes leave unexplained, in standard deviations of chance and discrepancy."""
        predicted, evidence = self.prediction(causes), self.evidence
        variance = evidence.variance_with(predicted.variance) + predicted.discrepancy
        left: Floats = (evidence.difference - predicted.change) / np.sqrt(variance)
        return left

    def curves(self, others: Sequence[Cause], responses: Iterable[Response], step: int = 1) -> Iterator[Floats]:
        """(sizes, sessions) scores when each of the candidates joins others, at all of its sizes or every `step`th."""
        beside = self._added(others)
        for response in responses:
            yield self._curve(beside, _responses(others), response, step)

    def curve(self, others: Sequence[Cause], response: Response, step: int = 1) -> Floats:
        """The same for one candidate."""
        return next(self.curves(others, (response,), step))

    def planes(self, first: Response, responses: Iterable[Response], step: int) -> Iterator[Floats]:
        """(sizes of the first, sizes, sessions) scores when each of the candidates joins a first one."""
        single = [self._added((Cause(first, at),)) for at in range(0, len(first.candidate.sizes), step)]
        changes, scatters, discrepancies = zip(*single, strict=True)
        scatter = Scatter(*map(_stacked, zip(*scatters, strict=True)))
        beside = Prediction(_stacked(changes), scatter, _stacked(discrepancies))
        for response in responses:
            yield self._curve(beside, frozenset({first}), response, step)

    def _curve(self, beside: Prediction, others: frozenset[Response], response: Response, step: int) -> Floats:
        """(…, sizes, sessions) beside what the tables say of others, (…, 1, sessions, F), or (sessions, F) for none."""
        both = others | {response}
        known = self._correction(both)
        change = combined(beside.change, response.mean[::step]) + (0.0 if known is None else known.change)
        is_random = response.candidate.realisations > 1
        sizes = slice(None, None, step) if is_random else slice(1)  # else 0 at all sizes
        own = Scatter(*(each[:, None] for each in response.scatter(sizes)))
        scatter = beside.scatter.beside(own).widened(0.0 if known is None else known.variance)
        discrepancy = beside.discrepancy + self.evidence.discrepancies[response][::step]
        total = scatter.through(self.evidence.variance_with)
        likelihood = log_likelihood_of_events(self.evidence.difference - change, total, discrepancy)
        fitted = sum(one.phases_deg is not None for one in both)
        return likelihood - FREE_PHASE_COST * fitted

    def knows(self, causes: Sequence[Cause]) -> bool:
        """Whether this set of candidates was simulated as a whole, at whatever sizes."""
        return self._knows(_responses(causes))

    def refined(self, causes: Sequence[Cause], simulated: SimulatedSet) -> "Surrogate":
        """A surrogate that is exact at a set of causes that was simulated, as far as a few runs know it.

        Sets within this one come behind all others from then on: they are the older knowledge of it.
        """
        responses = _responses(causes)
        others = [one for one in self.corrections if not one.responses <= responses]
        within = [one for one in self.corrections if one.responses < responses]
        added = self._added(causes)
        change = beyond_noise(simulated.change - added.change, simulated.variance / simulated.runs)
        new = Correction(responses, change, self._scatter(simulated, added.variance))
        return replace(self, corrections=(*others, new, *within))

    def _added(self, causes: Sequence[Cause]) -> Prediction:
        """By the tables alone."""
        change, *none, discrepancy = (np.zeros_like(self.evidence.difference) for _ in range(5))
        scatter = Scatter(*none)
        for cause in causes:
            mean = cause.response.mean[cause.at]
            change = combined(change, mean)
            scatter = scatter.beside(cause.response.scatter(cause.at))
            discrepancy = discrepancy + self.evidence.discrepancies[cause.response][cause.at]
        return Prediction(change, scatter, discrepancy)

    def _scatter(self, simulated: SimulatedSet, known: Floats) -> Floats:
        """(sessions, F) by which simulations of a set scatter more than a rig without it, and their mean with them.

        A recording is one more run. Two runs that have nothing in common differ by chance twice. Coarse counts are
        rounded otherwise in each, and a set that turns them to others moves features by more than that. Of few runs
        half is believed, and half of the others' sessions.
        """
        ratio = simulated.variance / self.evidence.sigma**2
        variance = 0.5 * (ratio + ratio.mean(axis=0)) * self.evidence.sigma**2
        more: Floats = np.maximum(variance - 2.0 * self.evidence.sigma**2 - known, 0.0)
        scatter: Floats = more + variance / simulated.runs
        return scatter

    def _knows(self, responses: frozenset[Response]) -> bool:
        return any(one.responses == responses for one in self.corrections)

    def _correction(self, responses: frozenset[Response]) -> Correction | None:
        """Of the set, or of the largest part of it that was simulated as a whole.

        What was simulated of one variant of a candidate is believed of the others, too: else the fit would flee to
        variants that were not corrected yet.
        """
        names = _names(responses)
        parts = [one for one in self.corrections if _names(one.responses) <= names]
        return max(parts, key=lambda one: (len(one.responses), len(one.responses & responses)), default=None)


def beyond_noise(change: Floats, variance: Floats) -> Floats:
    """What is to be believed of a change that is known with a variance: nothing of what is no larger than its error.

    Shrinkage after W. James and C. Stein, Estimation with quadratic loss (1961). A random cause that may go either way
    does so in the mean of a few simulations, too.
    """
    squares = np.square(change)
    believed: Floats = change * np.maximum(squares - variance, 0.0) / np.maximum(squares, TINY)
    return believed


def _stacked(values: Sequence[Floats]) -> Floats:
    """(sizes, 1, sessions, F) to be beside the sizes of another candidate."""
    return np.array(values)[:, None]


def _responses(causes: Sequence[Cause]) -> frozenset[Response]:
    return frozenset(cause.response for cause in causes)


def _names(responses: frozenset[Response]) -> frozenset[str]:
    return frozenset(one.candidate.name for one in responses)
