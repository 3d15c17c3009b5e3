"""The search over sets of causes: forward addition, pairs, exchange, backward elimination.

What is simulated on the way makes the surrogate better for the steps that follow; each step therefore takes a surrogate
and gives the one that the next step is to use.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from gyrodrift.diagnose.inference.acceptance import all_show, passes_acceptance, shows
from gyrodrift.diagnose.inference.earned import unearned
from gyrodrift.diagnose.inference.evidence import Evidence, Response
from gyrodrift.diagnose.inference.family_wise import pooled_z
from gyrodrift.diagnose.inference.fit import CauseSet, Simulate, best_of, cross_validated
from gyrodrift.diagnose.inference.splits import with_its_kin
from gyrodrift.diagnose.inference.surrogate import Cause, Surrogate, without

MAX_CAUSES = 4
SHORT_LIST = 4
"""Candidates that are simulated again at each step."""

CLOSE = 20.0
"""Log-likelihood: what is so far behind the best by the tables needs no simulation of its own."""

COARSE_STEP = 8
"""Pairs are first tried with every eighth size."""

PAIRS_FROM = 0.5
"""Of the family-wise threshold: where no feature is off by so much, no two causes mask each other."""

PROMISING_PAIRS, BEST_PAIRS = 12, 2
"""Pairs that are looked at more closely, and those of them that are simulated again."""


class Step(NamedTuple):
    """Sets that a step of the search has scored, the best first, and the surrogate that the next step uses."""

    found: list[CauseSet]
    surrogate: Surrogate


class SearchResult(NamedTuple):
    """The end of a search.

    found
        The set that no addition, exchange or removal makes better by enough.
    nothing
        The empty set, for comparison.
    surrogate
        With all that was simulated on the way.
    """

    found: CauseSet
    nothing: CauseSet
    surrogate: Surrogate


def search(evidence: Evidence, simulate: Simulate) -> SearchResult:
    """Find the causes of what deviates."""
    surrogate = Surrogate(evidence)
    nothing = found = CauseSet((), surrogate.scores(()))
    while len(found.causes) < MAX_CAUSES:
        more, surrogate = with_one_more(surrogate, found.causes, simulate)
        accepted = [one for one in more if passes_acceptance(surrogate, one, found)]
        if not accepted:
            break
        found = accepted[0]
        if len(found.causes) == 1:
            found, surrogate = _or_a_pair(surrogate, found, simulate)
        else:
            found, surrogate = exchanged(surrogate, found, simulate)
    found, surrogate = without_idle(surrogate, found, simulate)
    return SearchResult(found, nothing, surrogate)


def with_one_more(surrogate: Surrogate, causes: tuple[Cause, ...], simulate: Simulate) -> Step:
    """Forward addition: the set with each further candidate that shows; what the tables put far behind is left out."""
    evidence, taken = surrogate.evidence, {cause.name for cause in causes}
    rest = [name for name in evidence.candidate_names() if name not in taken]
    tried = [best_of(surrogate, causes, evidence.variants(name)) for name in rest]
    tried = [one for one in tried if not any(one.candidate.stands_against(cause.candidate) for cause in causes)]
    tried = [one for one in tried if shows(surrogate, (*causes, one), one)] or tried
    totals = [_sound_total(surrogate, (*causes, cause), [cause]) for cause in tried]
    order = [number for number in np.argsort(totals)[::-1][:SHORT_LIST] if totals[number] > max(totals) - CLOSE]
    more, surrogate = _all_scored(surrogate, [(*causes, tried[number]) for number in order], simulate)
    return Step([one for one in more if all_show(surrogate, one, taken)], surrogate)


def pairs(surrogate: Surrogate, simulate: Simulate) -> Step:
    """The best of all pairs: two that mask each other show only together."""
    evidence = surrogate.evidence
    chosen = [best_of(surrogate, (), evidence.variants(name)).response for name in evidence.candidate_names()]
    tried: list[tuple[float, tuple[Cause, Cause]]] = []
    for number, first in enumerate(chosen):
        rest = [one for one in chosen[number + 1 :] if not first.candidate.stands_against(one.candidate)]
        for second, scores in zip(rest, surrogate.planes(first, rest, COARSE_STEP), strict=True):
            totals = scores.sum(axis=-1)
            for at, best in enumerate(totals.argmax(axis=1)):
                pair = Cause(first, at * COARSE_STEP), Cause(second, int(best) * COARSE_STEP)
                tried.append((float(totals[at, best]), pair))
    tried.sort(key=lambda one: -one[0])
    short_list: dict[frozenset[str], tuple[Cause, ...]] = {}
    for _, pair in tried:
        short_list.setdefault(frozenset(cause.name for cause in pair), pair)
        if len(short_list) == PROMISING_PAIRS:
            break
    closer = [_best_beside(surrogate, *(cause.response for cause in pair)) for pair in short_list.values()]
    best = sorted(closer, key=lambda pair: -_sound_total(surrogate, pair, pair))[:BEST_PAIRS]
    return _all_scored(surrogate, best, simulate)


def _best_beside(surrogate: Surrogate, first: Response, second: Response) -> tuple[Cause, Cause]:
    """Two candidates at the best of all their sizes: of two that do nearly the same, one alone leads nowhere."""
    (scores,) = surrogate.planes(first, (second,), 1)
    at_first, at_second = np.unravel_index(int(scores.sum(axis=-1).argmax()), scores.shape[:2])
    return Cause(first, int(at_first)), Cause(second, int(at_second))


def exchanged(surrogate: Surrogate, found: CauseSet, simulate: Simulate) -> tuple[CauseSet, Surrogate]:
    """Try each other candidate in the place of each cause."""
    best = found
    for cause in found.causes:
        more, surrogate = with_one_more(surrogate, without(found.causes, cause), simulate)
        best = max([best, *more], key=lambda one: one.total)
    return best, surrogate


def without_idle(surrogate: Surrogate, found: CauseSet, simulate: Simulate) -> tuple[CauseSet, Surrogate]:
    """Backward elimination: drop what no longer passes beside the others."""
    while len(found.causes) > 1:
        rest = [without(found.causes, cause) for cause in found.causes]
        shorter, surrogate = _all_scored(surrogate, rest, simulate)
        moved = [causes for causes in rest if all(causes != one.causes for one in shorter)]
        as_they_are, known = _all_scored(_exact_at(surrogate, moved, simulate), moved, simulate)
        if as_they_are and as_they_are[0].total > shorter[0].total:
            shorter, surrogate = as_they_are, known
        if passes_acceptance(surrogate, found, shorter[0]):
            break
        found = shorter[0]
    return found, surrogate


def _exact_at(surrogate: Surrogate, sets: Sequence[tuple[Cause, ...]], simulate: Simulate) -> Surrogate:
    """A surrogate that is exact where these sets are.

    It may have been so at other sizes, from which the tables led no further: then a cause more gains by the sizes of
    the others, and not by itself.
    """
    for causes in sets:
        surrogate = surrogate.refined(causes, simulate(causes))
    return surrogate


def is_worth_pairs(surrogate: Surrogate, found: CauseSet) -> bool:
    """Whether something is left that two causes together could explain."""
    left = pooled_z(surrogate.standardised_residuals(found.causes)) / surrogate.evidence.caution
    return float(np.abs(left).max()) > PAIRS_FROM * surrogate.evidence.stands_out


def _or_a_pair(surrogate: Surrogate, single: CauseSet, simulate: Simulate) -> tuple[CauseSet, Surrogate]:
    """The best single cause, or a pair whose second cause passes beside it."""
    if not is_worth_pairs(surrogate, single):
        return single, surrogate
    both, surrogate = pairs(surrogate, simulate)
    of_one_group, surrogate = with_its_kin(surrogate, single, simulate)
    accepted = [pair for pair in (*both, *of_one_group) if passes_acceptance(surrogate, pair, single)]
    return max([single, *accepted], key=lambda one: one.total), surrogate


def _sound_total(surrogate: Surrogate, causes: Sequence[Cause], new: Sequence[Cause]) -> float:
    """Score of a set by the tables, less what its new causes do not earn, and what those that are no effect cost."""
    return CauseSet(tuple(causes), surrogate.scores(causes), unearned(surrogate, causes, new)).total


def _all_scored(surrogate: Surrogate, sets: Sequence[tuple[Cause, ...]], simulate: Simulate) -> Step:
    """Cross-validate one set after the other; the best first."""
    scored = []
    for causes in sets:
        found, surrogate = cross_validated(surrogate, causes, simulate)
        scored.append(found)
    return Step(sorted(scored, key=lambda one: -one.total), surrogate)
