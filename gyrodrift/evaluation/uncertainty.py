"""How honest a stated uncertainty of yaw is: how often the truth lies within it, and what it is worth."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr

from gyrodrift.arrays import Floats
from gyrodrift.evaluation.reference import Reference

SIGMAS = 2.0


@dataclass(frozen=True, slots=True)
class Uncertainty:
    """A standard deviation of yaw held against the reference, over a session, or their means over several.

    coverage
        Share of the samples whose error is within two standard deviations, 0 to 1.
    crps_deg
        Continuous ranked probability score, deg: the mean absolute error of what is stated as a normal distribution;
        that of yaw without an uncertainty is E.
    """

    coverage: float
    crps_deg: float


def uncertainty_of(reference: Reference, yaw_deg: Floats, sigma_deg: Floats) -> Uncertainty | None:
    """Of a yaw and its standard deviation, shape (n,), over the samples that have a reference.

    None where the standard deviation is not a number somewhere: then it is not stated.
    """
    known = np.isfinite(reference.reference_deg)
    errors_deg, sigmas_deg = yaw_deg[known] - reference.reference_deg[known], sigma_deg[known]
    if not (np.isfinite(sigmas_deg).all() and np.isfinite(errors_deg).all()):
        return None
    coverage = float(np.mean(np.abs(errors_deg) <= SIGMAS * sigmas_deg))
    return Uncertainty(coverage, float(np.mean(normal_crps(errors_deg, sigmas_deg))))


def normal_crps(errors: Floats, sigmas: Floats) -> Floats:
    """The score of normal distributions whose means are off by so much, in the same unit; that of σ = 0 is |error|.

    Equation 21 of T. Gneiting and A. E. Raftery, "Strictly proper scoring rules, prediction, and estimation", 2007,
    DOI 10.1198/016214506000001437: σ·(z·(2Φ(z) − 1) + 2φ(z) − 1/√π) with z = error/σ.
    """
    widths = np.where(sigmas > 0.0, sigmas, 1.0)
    z = errors / widths
    densities = np.exp(-0.5 * z * z) / np.sqrt(2.0 * np.pi)
    scores: Floats = widths * (z * (2.0 * ndtr(z) - 1.0) + 2.0 * densities - 1.0 / np.sqrt(np.pi))
    return np.where(sigmas > 0.0, scores, np.abs(errors))


def mean_uncertainty(stated: Sequence[Uncertainty | None]) -> Uncertainty | None:
    """Every session counts the same; None where it is not stated for one of them."""
    known = [one for one in stated if one is not None]
    if not known or len(known) < len(stated):
        return None
    return Uncertainty(float(np.mean([one.coverage for one in known])), float(np.mean([one.crps_deg for one in known])))
