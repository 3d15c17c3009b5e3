"""Calibration of a stated uncertainty of yaw: coverage and CRPS."""

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
