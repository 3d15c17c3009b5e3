"""The table of a session: how far its features are off, by chance and by each candidate; a value, and no simulation."""

from dataclasses import dataclass
from typing import NamedTuple

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.simulate.candidate import Candidate


class Sized(NamedTuple):
    """A candidate with its size; where its phase is free, with that of each session, degrees."""

    candidate: Candidate
    size: float
    phases_deg: Floats | None = None

    @property
    def is_random(self) -> bool:
        """Whether two realisations of it differ."""
        return self.candidate.realisations > 1


class SimulatedSet(NamedTuple):
    """What a whole set of candidates does to the features, the mean over a few runs: (sessions, F), or (F,) of one.

    variance
        Of single runs.
    runs
        How many there were.
    """

    change: Floats
    variance: Floats
    runs: int


@dataclass(frozen=True, slots=True)
class ResponseTable:
    """What a session says, of F features.

    difference, thresholds
        (F,) features of the recording less those of the rig driven through it; their relevance thresholds.
    runs
        (realisations, F) features of the latter.
    nulls
        (realisations, F) the null distribution: the same differences where the recording is the rig itself.
    responses
        Of each candidate that was simulated: (grid points, realisations, F), change of the features when it is added.
    extra_sigma
        (F,) standard deviation that is added before a single feature counts as deviating, because a few recordings say
        little of chance; 0 without a baseline.
    """

    name: str
    difference: Floats
    thresholds: Floats
    runs: Floats
    nulls: Floats
    responses: dict[str, Floats]
    extra_sigma: Floats | float = 0.0


def key(candidate: Candidate) -> str:
    """By which its responses are found."""
    return f"{candidate.name} {candidate.variant}"


def simulated_key(candidate: Candidate, phase_deg: float) -> str:
    """The same of a candidate once per turn at another phase."""
    return f"{candidate.name} phase_deg {phase_deg:.4g}"
