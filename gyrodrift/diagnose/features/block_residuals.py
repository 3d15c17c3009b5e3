"""Block by block, what is left of the rate without the encoder's: before and after the regressors are taken out."""

from dataclasses import dataclass

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features.block_means import LEAST_DPS, integral_of, slopes
from gyrodrift.diagnose.features.design_matrix import DesignMatrix
from gyrodrift.diagnose.recording.order_statistics import MAD_TO_SIGMA
from gyrodrift.diagnose.recording.outliers import Cleaned

HOLD_SIGMAS = 4.0
"""Blocks further off than this are held there, where single ones would pass for a step or a period."""


@dataclass(frozen=True, slots=True)
class BlockResiduals:
    """Residuals of a recording or simulation against a design matrix, deg/s, shape (blocks,) each.

    static
        Coefficients on the vectors of `design.static`, shape (columns,).
    unexplained_dps
        What the regressors leave.
    even_dps
        The same with outliers held at HOLD_SIGMAS, and zero where the rate changes.
    bias_dps
        The bias by itself, slow regressors left in it, as it is in the blocks that rest or turn steadily.
    """

    design: DesignMatrix
    static: Floats
    unexplained_dps: Floats
    even_dps: Floats
    bias_dps: Floats


def block_residuals_of(cleaned: Cleaned, design: DesignMatrix) -> BlockResiduals:
    """All that the features of the blocks are computed from."""
    centred_dps = _centred_dps(cleaned, design)
    static = _static(centred_dps, design)
    unexplained_dps = _without_static(centred_dps, static, design)
    limit_dps = HOLD_SIGMAS * MAD_TO_SIGMA * np.median(np.abs(unexplained_dps)) + LEAST_DPS
    held_dps = np.clip(unexplained_dps, -limit_dps, limit_dps)
    return BlockResiduals(
        design=design,
        static=static,
        unexplained_dps=unexplained_dps,
        even_dps=np.where(design.regimes.block_is_even, held_dps, 0.0),
        bias_dps=_bias_dps(centred_dps, design),
    )


def block_residual_dps(cleaned: Cleaned, design: DesignMatrix) -> Floats:
    """Mean rate of each block less that of the encoder, deg/s, shape (blocks,).

    The angle between the integrated rate and the encoder is averaged about each edge of a block, so that the rounding
    of a single angle does not count.
    """
    away_deg = integral_of(cleaned.rate_dps, design.period_s) - cleaned.encoder_deg
    return slopes(away_deg, design.period_s, design.block)


def unexplained_dps(cleaned: Cleaned, design: DesignMatrix) -> Floats:
    """What the regressors leave of the block residuals, deg/s, shape (blocks,)."""
    centred_dps = _centred_dps(cleaned, design)
    return _without_static(centred_dps, _static(centred_dps, design), design)


def _centred_dps(cleaned: Cleaned, design: DesignMatrix) -> Floats:
    """Block residuals less their level at rest; none where the gyro says nothing."""
    residual_dps = block_residual_dps(cleaned, design)
    at_rest = design.regimes.block_at_rest
    level = np.median(residual_dps[at_rest]) if at_rest.any() else 0.0
    centred: Floats = np.where(design.is_silent, 0.0, residual_dps - level)
    return centred


def _static(centred_dps: Floats, design: DesignMatrix) -> Floats:
    static: Floats = design.static.vectors.T @ (design.root_weights * centred_dps)
    return static


def _without_static(centred_dps: Floats, static: Floats, design: DesignMatrix) -> Floats:
    mean_dps = np.average(centred_dps, weights=np.square(design.root_weights))
    left: Floats = centred_dps - mean_dps - design.static.vectors @ static / design.root_weights
    return np.where(design.is_silent, 0.0, left)


def _bias_dps(centred_dps: Floats, design: DesignMatrix) -> Floats:
    roots = design.root_weights
    slow_dps = centred_dps - design.fast_vectors @ (design.fast_vectors.T @ (roots * centred_dps)) / roots
    place, even = np.arange(len(slow_dps)), design.regimes.block_is_even & ~design.is_silent
    bias_dps: Floats = np.interp(place, place[even], slow_dps[even]) if even.any() else slow_dps
    return bias_dps
