"""Response table of a session: feature differences, their null distribution, and responses to candidates."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from gyrodrift.diagnose.features.vector import in_device
from gyrodrift.diagnose.simulate.candidate import Candidate
from gyrodrift.values.arrays import Floats

ENOUGH = 8
"""Number of realizations from which on a session has its own mean and covariance. Chosen: fewer say little of a
covariance, and are pooled over sessions."""


class Sized(NamedTuple):
    """A candidate with a size, and its phases in degrees, one per session, if its phase is free."""

    candidate: Candidate
    size: float
    phases_deg: Floats | None = None

    @property
    def is_random(self) -> bool:
        """Whether the effect is random, so that realizations differ."""
        return self.candidate.realisations > 1


class SimulatedSet(NamedTuple):
    """Change of the features by a set of candidates: shape (sessions, F), or (F,) for one session.

    change
        Mean over all runs.
    variance
        Variance of single runs.
    runs
        Number of runs.
    """

    change: Floats
    variance: Floats
    runs: int


@dataclass(frozen=True, slots=True)
class ResponseTable:
    """Differences, null distribution and responses of a session with F features.

    difference, thresholds
        Features of the recording less the mean of its simulations, and their relevance thresholds; shape (F,).
    runs
        Features of the simulations, shape (realizations, F).
    nulls
        Null distribution of `difference`, from simulations that are taken for recordings; shape (realizations, F).
    responses
        Change of the features by a candidate, shape (grid points, realizations, F), by `key` of the candidate.
    offset
        Difference of a baseline to the simulator, shape (F,), which is subtracted from `difference`; None without one.
        The responses are those of the device then.
    extra_sigma
        Standard deviation, shape (F,), that is added before a single feature counts as deviating. It covers the small
        number of baseline recordings; 0 without a baseline.
    device_sigma, degrees
        Standard deviation of the device from recording to recording, shape (F,), a part of the thresholds, and its
        degrees of freedom; 0 and infinite without a baseline.
    """

    name: str
    difference: Floats
    thresholds: Floats
    runs: Floats
    nulls: Floats
    responses: dict[str, Floats]
    offset: Floats | None = None
    extra_sigma: Floats | float = 0.0
    device_sigma: Floats | float = 0.0
    degrees: float = np.inf

    def in_device(self, change: Floats) -> Floats:
        """Change of the features, (…, F), of the recorded device, from that of the simulator."""
        return change if self.offset is None else in_device(change, self.offset, self.runs.mean(axis=0))


def key(candidate: Candidate) -> str:
    """Key of a candidate's responses in a table."""
    return f"{candidate.name} {candidate.variant}"


def simulated_key(candidate: Candidate, phase_deg: float) -> str:
    """Key of the simulation of a once-per-turn candidate at a phase."""
    return f"{candidate.name} phase_deg {phase_deg:.4g}"
