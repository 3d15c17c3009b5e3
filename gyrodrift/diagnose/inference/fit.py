"""Sizes of a set of causes: fitted together, simulated again as a whole, scored on sessions that were held out."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.inference.earned import unearned
from gyrodrift.diagnose.inference.evidence import Response
from gyrodrift.diagnose.inference.surrogate import Cause, Surrogate
from gyrodrift.diagnose.simulate.response_table import SimulatedSet

Simulate = Callable[[Sequence[Cause]], SimulatedSet]
"""What a whole set of causes does to the features, by the simulator itself."""

OUT_OF_CATALOGUE_COST = 4.0
"""What no effect of the catalogue does has to explain more by so much than what one of them does."""

SWEEPS = 3
"""Coordinate-wise passes over the sizes of a set."""

NEARLY = 6.0
"""Log-likelihood by which a variant may be behind, by a correction that is another's, and be simulated itself."""

RESIMULATIONS = 2
"""Of a set that is new: the first may move its sizes, the second is at these."""


@dataclass(frozen=True, slots=True)
class CauseSet:
    """A set of causes, and how it scores.

    scores
        (sessions,) each under sizes fitted on the others.
    unearned
        Part of them that causes gain by what they may be off by, and not by what they explain.
    """

    causes: tuple[Cause, ...]
    scores: Floats
    unearned: float = 0.0

    @property
    def names(self) -> tuple[str, ...]:
        """Of the effects."""
        return tuple(cause.name for cause in self.causes)

    @property
    def total(self) -> float:
        """Of all sessions, less what is not earned, and less the price of what no effect does."""
        strange = sum(cause.is_out_of_catalogue for cause in self.causes)
        return float(self.scores.sum()) - self.unearned - OUT_OF_CATALOGUE_COST * strange


class Fitted(NamedTuple):
    """Causes at their best sizes, and the surrogate that knows them."""

    causes: tuple[Cause, ...]
    surrogate: Surrogate


class CrossValidated(NamedTuple):
    """A set with its scores, and the surrogate after the simulations that these took."""

    found: CauseSet
    surrogate: Surrogate


def best_of(
    surrogate: Surrogate,
    others: Sequence[Cause],
    responses: Sequence[Response],
    sessions: Sequence[int] | None = None,
) -> Cause:
    """The best variant and size of a candidate that joins others, by all sessions or some.

    Raises
    ------
    ValueError
        Where there is no response to choose from.
    """
    used = slice(None) if sessions is None else list(sessions)
    best, best_score = None, -np.inf
    for response, scores in zip(responses, surrogate.curves(others, responses), strict=True):
        totals = scores[:, used].sum(axis=1)
        at = int(np.argmax(totals))
        if best is None or totals[at] > best_score:
            best, best_score = Cause(response, at), float(totals[at])
    if best is None:
        raise ValueError("a candidate has at least one response")
    return best


def fitted(surrogate: Surrogate, causes: Sequence[Cause], sessions: Sequence[int] | None = None) -> tuple[Cause, ...]:
    """The same candidates with the best sizes together, and each in the best of its variants."""
    now = list(causes)
    for _ in range(SWEEPS if len(now) > 1 else 1):
        before = list(now)
        for number, cause in enumerate(now):
            others = now[:number] + now[number + 1 :]
            now[number] = best_of(surrogate, others, surrogate.evidence.variants(cause.name), sessions)
        if now == before:
            break
    return tuple(now)


def fitted_without(surrogate: Surrogate, causes: Sequence[Cause], held_out: int) -> tuple[Cause, ...]:
    """The same, but on all other sessions than the one held out; on the only one where there is no other."""
    others = [session for session in range(len(surrogate.evidence.names)) if session != held_out]
    return fitted(surrogate, causes, others or None)


def resimulated(surrogate: Surrogate, causes: Sequence[Cause], simulate: Simulate) -> Fitted:
    """Simulate a set as it is, so that neither interpolation nor addition of its tables matters; fit again."""
    now = tuple(causes)
    for _ in range(RESIMULATIONS):
        was_known = surrogate.knows(now)
        surrogate = surrogate.refined(now, simulate(now))
        again = fitted(surrogate, now)
        if again == now or was_known:
            break
        now = again
    return _in_other_variants(Fitted(now, surrogate), simulate)


def _in_other_variants(found: Fitted, simulate: Simulate) -> Fitted:
    """Simulate each cause in its next best variant too, where that is nearly as good, and fit again.

    What was corrected of one variant is only nearly right of another.
    """
    now, surrogate = found
    for cause in found.causes:
        kept = tuple(one for one in now if one.name != cause.name)
        rest = [one for one in surrogate.evidence.variants(cause.name) if one is not cause.response]
        if not rest or cause.candidate.phase_deg is not None:
            continue
        other = (*kept, best_of(surrogate, kept, rest))
        behind = float((surrogate.scores(now) - surrogate.scores(other)).sum())
        if behind < NEARLY and not surrogate.knows(other):
            surrogate = surrogate.refined(other, simulate(other))
            now = fitted(surrogate, now)
    return Fitted(now, surrogate)


def cross_validated(surrogate: Surrogate, causes: Sequence[Cause], simulate: Simulate) -> CrossValidated:
    """Leave-one-session-out cross-validation: fit on all sessions, score each under sizes fitted on the others."""
    whole, surrogate = resimulated(surrogate, fitted(surrogate, causes), simulate)
    count = len(surrogate.evidence.names)
    scores = surrogate.scores(whole)
    if count > 1:
        for held_out in range(count):
            scores[held_out] = surrogate.scores(fitted_without(surrogate, whole, held_out))[held_out]
    return CrossValidated(CauseSet(whole, scores, unearned(surrogate, whole, whole)), surrogate)
