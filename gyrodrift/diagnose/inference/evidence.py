"""What inference works on: how far each feature deviates, and what each candidate would do to it."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.inference.family_wise import family_wise_threshold
from gyrodrift.diagnose.inference.likelihood import CROSS_TALK, EXACT_CROSS_TALK, Scatter, discrepancy_variance
from gyrodrift.diagnose.simulate.candidate import Candidate

NOT_COMPARED = 1e6
"""Standard deviation of what cannot be compared, in units of the features."""


class Usual(NamedTuple):
    """What most realisations of a candidate do, by medians, (sizes, F) each.

    shift
        By which the change of a feature differs from the mean of all.
    spread
        Standard deviation about that, no more than that of all.
    """

    shift: Floats
    spread: Floats


@dataclass(frozen=True, slots=True, eq=False)
class Response:
    """What a candidate does at each of its sizes; two of them are the same only where they are one object.

    mean
        (sizes, sessions, F) change of the features.
    spread
        (sizes, F) standard deviation of that change where it is random, else 0.
    usual
        What most realisations do, where few change a feature much; None where that is not known apart.
    phases_deg
        (sessions,) of a candidate whose phase is free: the one that each session shows; None of all others.
    realised
        (grid points, sessions, realisations, F) of a random candidate: the change of each; None of all others.
    """

    candidate: Candidate
    mean: Floats
    spread: Floats
    phases_deg: Floats | None = None
    realised: Floats | None = None
    usual: Usual | None = None

    def scatter(self, sizes: slice | int) -> Scatter:
        """Of the features about the mean at some sizes, (sizes, F), or at one, (F,)."""
        spread = self.spread[sizes]
        if self.usual is None:
            return Scatter(np.square(spread), np.square(spread), np.zeros_like(spread))
        return Scatter(np.square(spread), np.square(self.usual.spread[sizes]), self.usual.shift[sizes])


@dataclass(frozen=True, slots=True, eq=False)
class Evidence:
    """Sessions as rows, F features as columns.

    names
        Of the sessions.
    difference
        (sessions, F) recording less simulation, and less what the replay itself leaves.
    sigma
        (sessions, F) spread of that where there is no gap, and the relevance threshold, together.
    chance
        (sessions, F) the spread alone. The threshold is room for whatever does not matter, and so for what scatters
        within it, too.
    nulls
        (sessions, runs, F) differences without a gap, in units of sigma.
    caution
        (F,) by how many times further a feature has to be off to stand out, since sigma itself is not known well.
    stands_out
        Pooled z beyond which a feature deviates: chance makes one of all features do so in FAMILY_WISE_ERROR.
    discrepancies
        Of each response its model-discrepancy variance, (sizes, sessions, F); it follows from the others.
    """

    names: tuple[str, ...]
    difference: Floats
    sigma: Floats
    chance: Floats
    nulls: Floats
    responses: tuple[Response, ...]
    caution: Floats | float = 1.0
    discrepancies: dict[Response, Floats] = field(init=False, repr=False)
    stands_out: float = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "stands_out", family_wise_threshold(self.nulls))
        found = {one: discrepancy_variance(one.mean, self.difference, _cross_talk(one)) for one in self.responses}
        object.__setattr__(self, "discrepancies", found)

    @property
    def z(self) -> Floats:
        """(sessions, F) how far each feature deviates before anything is added."""
        return self.difference / self.sigma

    def variance_with(self, scatter: Floats) -> Floats:
        """Of the difference where more scatters by such a variance, (…, sessions, F)."""
        found: Floats = np.maximum(self.sigma**2, self.chance**2 + scatter)
        return found

    def only(self, names: Sequence[str]) -> "Evidence":
        """The same with some of the candidates."""
        return replace(self, responses=tuple(one for one in self.responses if one.candidate.name in names))

    def candidate_names(self) -> list[str]:
        """Of all candidates, each once."""
        return list(dict.fromkeys(response.candidate.name for response in self.responses))

    def variants(self, name: str) -> list[Response]:
        """The responses of one candidate: it is tried with several values of its second parameter."""
        return [response for response in self.responses if response.candidate.name == name]


def _cross_talk(response: Response) -> float:
    return EXACT_CROSS_TALK if response.candidate.is_exact else CROSS_TALK
