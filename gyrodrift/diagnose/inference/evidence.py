"""What inference works on: how far each feature deviates, and what each candidate would do to it."""

from dataclasses import dataclass, field

from gyrodrift.arrays import Floats, Mask
from gyrodrift.diagnose.inference.family_wise import family_wise_threshold
from gyrodrift.diagnose.simulate.candidate import Candidate

NOT_COMPARED = 1e6
"""Standard deviation of what cannot be compared, in units of the features."""


@dataclass(frozen=True, slots=True, eq=False)
class Response:
    """What a variant of a candidate does.

    mean
        (sizes, S, F) change of the features; of a random candidate at its simulated sizes only.
    phases_deg
        (S,) of a candidate whose phase is free: the one that each session shows; None of all others.
    realised
        (simulated sizes, S, realisations, F) of a random candidate: the change of each; None of all others.
    """

    candidate: Candidate
    mean: Floats
    phases_deg: Floats | None = None
    realised: Floats | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Evidence:
    """Sessions as rows, F features as columns.

    names
        Of the sessions.
    difference
        (S, F) recording less simulation, and less what the replay itself leaves.
    sigma
        (S, F) spread of that where there is no gap, and the relevance threshold, together.
    nulls
        (S, runs, F) differences without a gap, in units of sigma.
    caution
        (F,) by how many times further a feature has to be off to stand out, since sigma itself is not known well.
    stands_out
        Pooled z beyond which a feature deviates: chance makes one of all features do so in FAMILY_WISE_ERROR.
    """

    names: tuple[str, ...]
    difference: Floats
    sigma: Floats
    nulls: Floats
    responses: tuple[Response, ...]
    caution: Floats | float = 1.0
    stands_out: float = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "stands_out", family_wise_threshold(self.nulls))

    @property
    def z(self) -> Floats:
        """(S, F) how far each feature deviates before anything is added."""
        return self.difference / self.sigma

    @property
    def is_compared(self) -> Mask:
        """(S, F) features of which a session can speak."""
        known: Mask = self.sigma < NOT_COMPARED
        return known

    def effects(self) -> list[Response]:
        """Responses of effects of the catalog."""
        return [response for response in self.responses if not response.candidate.is_out_of_catalogue]
