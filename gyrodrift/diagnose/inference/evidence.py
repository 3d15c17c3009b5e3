"""Input of the inference: the deviation of each feature, and the response of the features to each candidate."""

from dataclasses import dataclass, field

from gyrodrift.arrays import Floats, Mask
from gyrodrift.diagnose.inference.family_wise import family_wise_threshold
from gyrodrift.diagnose.simulate.candidate import Candidate

NOT_COMPARED = 1e6
"""Standard deviation of features that are not compared, in units of the features."""


@dataclass(frozen=True, slots=True, eq=False)
class Response:
    """Response of the features to a variant of a candidate.

    mean
        (sizes, S, F) change of the features; of a random candidate at its simulated sizes only.
    phases_deg
        (S,) phase that each session shows, of a candidate with a free phase; None of all others.
    realised
        (simulated sizes, S, realisations, F) changes of a random candidate; None of all others.
    """

    candidate: Candidate
    mean: Floats
    phases_deg: Floats | None = None
    realised: Floats | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Evidence:
    """Sessions as rows, F features as columns.

    names
        Names of the sessions.
    difference
        (S, F) recording minus simulation, minus the mean of the null.
    sigma
        (S, F) standard deviation without a gap, relevance threshold included.
    nulls
        (S, runs, F) differences without a gap, in units of sigma.
    sigma_factor
        (F,) factor of sigma where sigma itself is not known well; it applies to single features only.
    threshold_z
        Pooled z beyond which a feature deviates. Any feature exceeds it by chance with FAMILY_WISE_ERROR.
    """

    names: tuple[str, ...]
    difference: Floats
    sigma: Floats
    nulls: Floats
    responses: tuple[Response, ...]
    sigma_factor: Floats | float = 1.0
    threshold_z: float = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "threshold_z", family_wise_threshold(self.nulls))

    @property
    def z(self) -> Floats:
        """(S, F) deviation of each feature from the rig, in sigma."""
        return self.difference / self.sigma

    @property
    def is_compared(self) -> Mask:
        """(S, F) features that a session determines."""
        compared: Mask = self.sigma < NOT_COMPARED
        return compared

    def effects(self) -> list[Response]:
        """Responses of effects of the catalog."""
        return [response for response in self.responses if not response.candidate.is_out_of_catalogue]
