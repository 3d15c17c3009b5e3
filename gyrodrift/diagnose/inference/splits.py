"""Pairs that do nearly the same, such as a delay and a low-pass, and whose tables do not add.

The tables know each by itself. What they hold to be nearly as good goes from one of the two to the other; simulations
along it tell how much each of them has.
"""

from collections.abc import Sequence

import numpy as np

from gyrodrift.diagnose.inference.evidence import Response
from gyrodrift.diagnose.inference.fit import CauseSet, Simulate, best_of, cross_validated
from gyrodrift.diagnose.inference.surrogate import Cause, Surrogate
from gyrodrift.diagnose.simulate.candidate import Candidate

SPLIT_STEP, SPLITS = 8, 6
"""Every eighth size of the second, beside the best of the first; so many of them are simulated, the best by the tables
first."""


def with_its_kin(surrogate: Surrogate, single: CauseSet, simulate: Simulate) -> tuple[list[CauseSet], Surrogate]:
    """A single cause in a pair with each other of its group, scored; and the surrogate that knows these pairs."""
    (cause,), found = single.causes, []
    for name in surrogate.evidence.candidate_names():
        variants = surrogate.evidence.variants(name)
        if name != cause.name and _share(cause.candidate, variants[0].candidate):
            kin = best_of(surrogate, single.causes, variants)
            surrogate = _at_best_split(surrogate, cause.response, kin.response, simulate)
            pair, surrogate = cross_validated(surrogate, (cause, kin), simulate)
            found.append(pair)
    return found, surrogate


def _share(one: Candidate, kin: Candidate) -> bool:
    """Whether two may do the same, in a way that their tables do not tell: what is linear adds up."""
    both = one, kin
    is_effect = not any(
        each.is_out_of_catalogue or each.realisations > 1 or each.phase_deg is not None for each in both
    )
    is_linear = all(each.grid_points[0] < 0.0 for each in both)
    return is_effect and not is_linear and one.group == kin.group


def _at_best_split(surrogate: Surrogate, first: Response, second: Response, simulate: Simulate) -> Surrogate:
    """With the simulation of the best of some splits."""
    splits = _splits(surrogate, first, second)
    known = [surrogate.refined(split, simulate(split)) for split in splits]
    totals = [float(one.scores(split).sum()) for one, split in zip(known, splits, strict=True)]
    return known[int(np.argmax(totals))]


def _splits(surrogate: Surrogate, first: Response, second: Response) -> Sequence[tuple[Cause, Cause]]:
    (scores,) = surrogate.planes(first, (second,), 1)
    totals = scores.sum(axis=-1)[:, ::SPLIT_STEP]
    best_first = np.argsort(-totals.max(axis=0))[:SPLITS].tolist()
    return [(Cause(first, int(totals[:, at].argmax())), Cause(second, at * SPLIT_STEP)) for at in best_first]
