"""Measures of yaw error: PI, E, NE and the largest error.

PI is the mean over sessions of the mean squared yaw error. E is the mean absolute yaw error. NE is E divided by the
duration. Source: J. Borenstein and L. Ojeda, "Heuristic reduction of gyro drift in vehicle tracking
applications", 2009, DOI 10.1504/IJVICS.2009.027747.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gyrodrift.evaluation.reference import Reference
from gyrodrift.values.arrays import Floats


@dataclass(frozen=True, slots=True)
class Score:
    """Yaw errors of a session, or means over several sessions; inf if yaw overflows.

    e_deg, ne
        Mean absolute error E, deg, and NE = E / duration, deg/min.
    pi_deg2
        Mean squared error, deg²; its mean over sessions is PI.
    worst_deg
        Largest absolute error, deg.
    crps_deg
        Mean CRPS of yaw and its sigma, deg; None for a filter without sigma, or where it is not asked for.
    """

    e_deg: float
    ne: float
    pi_deg2: float
    worst_deg: float
    crps_deg: float | None = None


def score_of(reference: Reference, yaw_deg: Floats) -> Score:
    """Score of a yaw, shape (n,), over the samples with a reference."""
    has_reference = np.isfinite(reference.reference_deg)
    with np.errstate(over="ignore", invalid="ignore"):
        error_deg = np.abs(yaw_deg[has_reference] - reference.reference_deg[has_reference])
        e_deg, pi_deg2 = float(np.mean(error_deg)), float(np.mean(error_deg * error_deg))
    if not np.isfinite(pi_deg2):
        return Score(np.inf, np.inf, np.inf, np.inf)
    return Score(e_deg, e_deg / reference.minutes, pi_deg2, float(np.max(error_deg)))


def mean_score(scores: Sequence[Score]) -> Score:
    """Mean of at least one score; every session has the same weight."""
    columns = ([getattr(score, name) for score in scores] for name in ("e_deg", "ne", "pi_deg2", "worst_deg"))
    return Score(*(float(np.mean(column)) for column in columns))
