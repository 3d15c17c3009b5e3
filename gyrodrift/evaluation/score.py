"""Measures of yaw error (PI, E, NE and the largest error), and of a stated uncertainty (coverage and CRPS).

PI is the mean over sessions of the mean squared yaw error. E is the mean absolute yaw error. NE is E divided by the
duration. Source: J. Borenstein and L. Ojeda, "Heuristic reduction of gyro drift in vehicle tracking
applications", 2009, DOI 10.1504/IJVICS.2009.027747.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr

from gyrodrift.evaluation.reference import Reference
from gyrodrift.values.arrays import Floats

SIGMAS = 2.0
"""Half width of the interval of `Uncertainty.coverage`, in standard deviations: chosen, 95.4 % if normal."""


@dataclass(frozen=True, slots=True)
class Uncertainty:
    """Calibration of the standard deviation of yaw, on a session or as a mean over sessions.

    coverage
        Share of the samples whose error is within two standard deviations, 0 to 1.
    crps_deg
        Continuous ranked probability score of a normal distribution, deg. It equals E if the standard deviation is 0.
    """

    coverage: float
    crps_deg: float


def uncertainty_of(reference: Reference, yaw_deg: Floats, sigma_deg: Floats) -> Uncertainty | None:
    """Coverage and CRPS of a yaw and its standard deviation, shape (n,), over the samples with a reference.

    None if a standard deviation is NaN: the filter does not estimate it.
    """
    has_reference = np.isfinite(reference.reference_deg)
    errors_deg, sigmas_deg = yaw_deg[has_reference] - reference.reference_deg[has_reference], sigma_deg[has_reference]
    if not (np.isfinite(sigmas_deg).all() and np.isfinite(errors_deg).all()):
        return None
    coverage = float(np.mean(np.abs(errors_deg) <= SIGMAS * sigmas_deg))
    return Uncertainty(coverage, float(np.mean(normal_crps(errors_deg, sigmas_deg))))


def normal_crps(errors: Floats, sigmas: Floats) -> Floats:
    """CRPS of normal distributions with these errors of the mean, in the same unit; |error| for σ = 0, NaN for NaN.

    Equation 21 of T. Gneiting and A. E. Raftery, "Strictly proper scoring rules, prediction, and estimation", 2007,
    DOI 10.1198/016214506000001437: σ·(z·(2Φ(z) − 1) + 2φ(z) − 1/√π) with z = error/σ.
    """
    widths = np.where(sigmas > 0.0, sigmas, 1.0)
    z = errors / widths
    densities = np.exp(-0.5 * z * z) / np.sqrt(2.0 * np.pi)
    scores: Floats = widths * (z * (2.0 * ndtr(z) - 1.0) + 2.0 * densities - 1.0 / np.sqrt(np.pi))
    return np.where(sigmas > 0.0, scores, np.where(np.isnan(sigmas), np.nan, np.abs(errors)))


def mean_uncertainty(stated: Sequence[Uncertainty | None]) -> Uncertainty | None:
    """Mean with the same weight for every session; None if a session states no uncertainty."""
    stated_values = [value for value in stated if value is not None]
    if not stated_values or len(stated_values) < len(stated):
        return None
    return Uncertainty(
        float(np.mean([value.coverage for value in stated_values])),
        float(np.mean([value.crps_deg for value in stated_values])),
    )


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
