"""How far a yaw is off, by the measures that everything here goes by.

PI is the mean over sessions of the mean squared yaw error, E the mean absolute yaw error, NE is E over the true
duration: the measures of J. Borenstein and L. Ojeda, "Heuristic reduction of gyro drift in vehicle tracking
applications", 2009, DOI 10.1504/IJVICS.2009.027747, and of the tables published with it.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.evaluation.reference import Reference


@dataclass(frozen=True, slots=True)
class Score:
    """Yaw errors of a session, or their means over several; inf where yaw left the floats.

    e_deg, ne
        Mean absolute error E, deg, and NE, that over the true duration, deg/min.
    pi_deg2
        Mean squared error, deg²; its mean over sessions is PI.
    worst_deg
        Largest absolute error, deg.
    """

    e_deg: float
    ne: float
    pi_deg2: float
    worst_deg: float


def score_of(reference: Reference, yaw_deg: Floats) -> Score:
    """The score of a yaw, shape (n,), over the samples that have a reference."""
    known = np.isfinite(reference.reference_deg)
    with np.errstate(over="ignore", invalid="ignore"):
        error_deg = np.abs(yaw_deg[known] - reference.reference_deg[known])
        e_deg, pi_deg2 = float(np.mean(error_deg)), float(np.mean(error_deg * error_deg))
    if not np.isfinite(pi_deg2):
        return Score(np.inf, np.inf, np.inf, np.inf)
    return Score(e_deg, e_deg / reference.minutes, pi_deg2, float(np.max(error_deg)))


def mean_score(scores: Sequence[Score]) -> Score:
    """Every session counts the same, however long; of at least one."""
    columns = ([getattr(score, name) for score in scores] for name in ("e_deg", "ne", "pi_deg2", "worst_deg"))
    return Score(*(float(np.mean(column)) for column in columns))
