"""How far a yaw is off, by the measures that `tune` goes by."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.evaluation.reference import Course


@dataclass(frozen=True, slots=True)
class Score:
    """Yaw errors of a session, or their means over several; inf where yaw left the floats.

    e_deg, ne
        Mean absolute error, deg (equation 10 of the README), and that over the true duration, deg/min (11).
    pi_deg2
        Mean squared error, deg²; its mean over sessions is PI (9).
    worst_deg
        Largest absolute error, deg.
    """

    e_deg: float
    ne: float
    pi_deg2: float
    worst_deg: float


def score_of(course: Course, yaw_deg: Floats) -> Score:
    """The score of a yaw, shape (n,), over the samples that have a reference."""
    known = np.isfinite(course.reference_deg)
    with np.errstate(over="ignore", invalid="ignore"):
        error_deg = np.abs(yaw_deg[known] - course.reference_deg[known])
        e_deg, pi_deg2 = float(np.mean(error_deg)), float(np.mean(error_deg * error_deg))
    if not np.isfinite(pi_deg2):
        return Score(np.inf, np.inf, np.inf, np.inf)
    return Score(e_deg, e_deg / course.minutes, pi_deg2, float(np.max(error_deg)))


def mean_score(scores: Sequence[Score]) -> Score:
    """Every session counts the same, however long; of at least one."""
    columns = ([getattr(score, name) for score in scores] for name in ("e_deg", "ne", "pi_deg2", "worst_deg"))
    return Score(*(float(np.mean(column)) for column in columns))
