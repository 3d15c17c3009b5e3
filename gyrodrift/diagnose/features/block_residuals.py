"""Block residuals: mean rate of the gyro less that of the encoder, before and after the regressors are removed."""

from dataclasses import dataclass

import numpy as np

from gyrodrift.diagnose.features.block_means import integral_of, slopes
from gyrodrift.diagnose.features.design_matrix import DesignMatrix
from gyrodrift.diagnose.recording.order_statistics import median
from gyrodrift.diagnose.recording.outliers import Cleaned
from gyrodrift.values.arrays import Floats


@dataclass(frozen=True, slots=True)
class BlockResiduals:
    """Residuals of a recording or simulation against a design matrix, deg/s, shape (blocks,).

    static
        Coefficients of the vectors of `design.static`, shape (columns,).
    unexplained_dps
        Residuals after all static regressors.
    bias_dps
        Bias: residuals after the fast regressors only, interpolated over blocks with a changing rate.
    """

    design: DesignMatrix
    static: Floats
    unexplained_dps: Floats
    bias_dps: Floats


def block_residuals_of(cleaned: Cleaned, design: DesignMatrix) -> BlockResiduals:
    """Compute the residuals of a recording or simulation."""
    centered_dps = _centered_dps(cleaned, design)
    static = _static(centered_dps, design)
    return BlockResiduals(
        design=design,
        static=static,
        unexplained_dps=_without_static(centered_dps, static, design),
        bias_dps=_bias_dps(centered_dps, design),
    )


def block_residual_dps(cleaned: Cleaned, design: DesignMatrix) -> Floats:
    """Mean rate of the gyro less that of the encoder in every block, deg/s, shape (blocks,).

    The angle between integrated rate and encoder is averaged in a window at the edges of a block. So the rounding of a
    single angle has little influence.
    """
    away_deg = integral_of(cleaned.rate_dps, design.period_s) - cleaned.encoder_deg
    return slopes(away_deg, design.period_s, design.block)


def unexplained_dps(cleaned: Cleaned, design: DesignMatrix) -> Floats:
    """Block residuals after all static regressors, deg/s, shape (blocks,)."""
    centered_dps = _centered_dps(cleaned, design)
    return _without_static(centered_dps, _static(centered_dps, design), design)


def _centered_dps(cleaned: Cleaned, design: DesignMatrix) -> Floats:
    """Block residuals less their median at rest, deg/s; 0 in blocks in which the gyro is at its limit."""
    residual_dps = block_residual_dps(cleaned, design)
    at_rest = design.regimes.block_at_rest
    level = median(residual_dps[at_rest]) if at_rest.any() else 0.0
    centered: Floats = np.where(design.is_silent, 0.0, residual_dps - level)
    return centered


def _static(centered_dps: Floats, design: DesignMatrix) -> Floats:
    static: Floats = design.static.vectors.T @ (design.root_weights * centered_dps)
    return static


def _without_static(centered_dps: Floats, static: Floats, design: DesignMatrix) -> Floats:
    """Residuals less their weighted mean and the static regressors, deg/s; 0 in blocks at the gyro's limit."""
    mean_dps = np.average(centered_dps, weights=np.square(design.root_weights))
    remainder: Floats = centered_dps - mean_dps - design.static.vectors @ static / design.root_weights
    return np.where(design.is_silent, 0.0, remainder)


def _bias_dps(centered_dps: Floats, design: DesignMatrix) -> Floats:
    """Residuals less the fast regressors, deg/s, interpolated over blocks with a changing rate or at the limit."""
    roots = design.root_weights
    slow_dps = centered_dps - design.fast_vectors @ (design.fast_vectors.T @ (roots * centered_dps)) / roots
    index, is_even = np.arange(len(slow_dps)), design.regimes.block_is_even & ~design.is_silent
    bias_dps: Floats = np.interp(index, index[is_even], slow_dps[is_even]) if is_even.any() else slow_dps
    return bias_dps
