"""Design matrix of a session: regressors of its residuals, from its motion, temperature and time.

A recording and its simulations have their own design matrices, rebuilt from their own encoder and gyro. So errors of
rebuilding the motion appear in both, and cancel in the comparison.
"""

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import uniform_filter1d

from gyrodrift.diagnose.features.block_means import blocks_with, integral_of, slopes
from gyrodrift.diagnose.features.columns import (
    ANGLE_COLUMNS,
    DRIFT_COLUMNS,
    HISTORY_COLUMNS,
    RATE_COLUMNS,
    warming_basis,
)
from gyrodrift.diagnose.features.motion_terms import MotionTerms, motion_terms_of
from gyrodrift.diagnose.features.orthogonal import Basis, orthonormal, orthonormal_vectors
from gyrodrift.diagnose.features.regimes import Regimes, regimes_of
from gyrodrift.diagnose.features.spreads import DifferenceIndices, difference_indices_of
from gyrodrift.diagnose.features.within_second import lag_basis
from gyrodrift.diagnose.recording.motion import ReplayedMotion
from gyrodrift.diagnose.recording.outliers import Cleaned
from gyrodrift.io.compile import compiled_once
from gyrodrift.values.arrays import Floats, Mask

KNOWN_DPS = 0.01
"""Error of a block's mean rate by an encoder, deg/s. A rounding error far below it does not reduce the weight. Chosen:
about as a block of a usual gyro scatters."""


def root_weights_of(motion: ReplayedMotion, count_deg: float, block: int, sigma_dps: float) -> Floats:
    """Square roots of the weights of blocks, shape (blocks,).

    motion, count_deg
        The rebuilt motion, and the step of the encoder.
    sigma_dps
        White noise of a sample of the gyro, which limits the weight of a block.
    """
    if count_deg == 0.0:
        return np.ones(len(motion.angle_deg) // block)
    rounding_deg = motion.angle_deg - count_deg * np.rint(motion.angle_deg / count_deg)
    rounding_dps = slopes(rounding_deg, motion.period_s, block)
    variance = uniform_filter1d(np.square(rounding_dps), 3)  # over 3 blocks, since rounding may be 0 in a single one
    least_variance = KNOWN_DPS**2 + sigma_dps**2 / block
    roots: Floats = np.sqrt(least_variance / (least_variance + variance))
    return roots


TURN_ORDERS = (3, 8)
"""Smallest and largest number of periods per turn in the turn bases. Derived: 1 and 2 periods are columns. Chosen: 8,
the highest order of random functions of the angle."""


def turn_bases(terms: MotionTerms, block: int) -> tuple[Floats, Floats]:
    """Orthonormal sines and cosines of multiples of the angle, and their products with the rate; (blocks, columns)."""
    means = np.zeros((2, len(terms.rate_dps) // block, 2 * (TURN_ORDERS[1] - TURN_ORDERS[0] + 1)))
    _add_means(terms.sine, terms.cosine, terms.rate_dps, block, TURN_ORDERS[0], means)
    ones = np.ones(means.shape[2])
    return orthonormal(means[0], ones, 0).vectors, orthonormal(means[1], ones, 0).vectors


@compiled_once(fastmath={"reassoc", "nsz"})
def _add_means(sine: Floats, cosine: Floats, rate: Floats, block: int, lowest: int, means: Floats) -> None:
    """Add block means of cosine and sine of multiples of the angle, from `lowest` on, alone and times the rate."""
    along, across = np.empty(block), np.empty(block)
    for row in range(means.shape[1]):
        inside = slice(row * block, (row + 1) * block)
        x, y, weight = cosine[inside], sine[inside], rate[inside]
        for n in range(block):
            along[n], across[n] = x[n], y[n]
        for order in range(2, lowest + means.shape[2] // 2):
            sums = (0.0, 0.0, 0.0, 0.0)
            for n in range(block):
                a, b = along[n] * x[n] - across[n] * y[n], along[n] * y[n] + across[n] * x[n]
                along[n], across[n] = a, b
                sums = (sums[0] + a, sums[1] + b, sums[2] + a * weight[n], sums[3] + b * weight[n])
            if order >= lowest:
                column = 2 * (order - lowest)
                means[0, row, column], means[0, row, column + 1] = sums[0] / block, sums[1] / block
                means[1, row, column], means[1, row, column + 1] = sums[2] / block, sums[3] / block


BLOCK_S = 1.0
"""Length of a block, s. Chosen: in one second an encoder with steps of 0.01 degrees gives the mean rate within 0.004
deg/s."""

SILENT = 1e-3
"""Square root of the weight of a block in which the gyro is at its limit. The motion beyond the limit is known from the
encoder's counts alone, so the residuals of these blocks are large and say nothing about the gyro. Chosen: a weight of
1e-6, which is negligible without being 0."""

COLUMNS = (*RATE_COLUMNS, *DRIFT_COLUMNS, *ANGLE_COLUMNS, *HISTORY_COLUMNS)
"""All regressors in the order of the orthogonalization: a part common to two columns counts for the first."""

CONSTANT = 1
"""Number of leading columns that are no features. By definition: the constant, since the bias is calibrated."""


@dataclass(frozen=True, slots=True)
class DesignMatrix:
    """Motion of a session, its regimes, and orthonormal bases of its regressors.

    samples, period_s, block
        Number of samples, sample period, and samples in a block.
    difference_indices
        Differences of neighboring means that lie within a regime.
    is_silent
        Blocks in which the gyro is at the limit that the rig states, shape (blocks,).
    root_weights
        Square roots of the weights of blocks, shape (blocks,); 1 if the encoder's rounding is negligible.
    static
        Basis of COLUMNS, shape (blocks, columns), orthonormal after multiplication by the root weights. Residuals have
        to be multiplied by the root weights, too.
    fast_vectors
        Orthonormal basis of a constant and the columns that are no slow bias, weighted alike; shape (blocks, columns).
    lag
        Basis of LAG_FEATURES, shape (n, features).
    warming
        Basis of WARMING: differences of the temperature between successive means of WARMING_BLOCKS blocks.
    turn_basis, turn_rate_basis
        Orthonormal sines of multiples of the angle, and their products with the rate; shape (blocks, columns).
    """

    motion: ReplayedMotion
    samples: int
    period_s: float
    block: int
    regimes: Regimes
    difference_indices: DifferenceIndices
    is_silent: Mask
    root_weights: Floats
    static: Basis
    fast_vectors: Floats
    lag: Basis
    warming: Basis
    turn_basis: Floats
    turn_rate_basis: Floats

    def regressor(self, name: str) -> Floats:
        """Values of one of COLUMNS at all samples, shape (n,); computed here, since only block means are stored."""
        column = next(column for column in COLUMNS if column.name == name)
        return column.compute(motion_terms_of(self.motion, self.regimes.speed_dps))


def design_matrix_of(
    cleaned: Cleaned, motion: ReplayedMotion, sigma_dps: float = 0.0, at_limit: Mask | None = None
) -> DesignMatrix:
    """Design matrix of a recording and the motion that was rebuilt from it.

    sigma_dps
        White noise of a sample of the gyro.
    at_limit
        Samples at which the gyro is at its limit, shape (n,); None if the rig has no limit.
    """
    samples, period_s = len(motion.rate_dps), cleaned.recording.period_s
    block = max(1, round(BLOCK_S / period_s))
    lag = lag_basis(cleaned.encoder_deg, period_s)
    regimes = regimes_of(motion, block)
    terms = motion_terms_of(motion, regimes.speed_dps)
    means = [slopes(integral_of(column.compute(terms), period_s), period_s, block) for column in COLUMNS]
    is_silent = np.zeros(samples // block, bool) if at_limit is None else blocks_with(at_limit, period_s, block)
    encoder_weights = root_weights_of(motion, cleaned.step_deg, block, sigma_dps)
    root_weights = np.where(is_silent, SILENT, encoder_weights)
    regressors = root_weights[:, None] * np.column_stack([np.ones(samples // block), *means])
    turn_basis, turn_rate_basis = turn_bases(terms, block)
    return DesignMatrix(
        motion=motion,
        samples=samples,
        period_s=period_s,
        block=block,
        regimes=regimes,
        difference_indices=difference_indices_of(regimes),
        is_silent=is_silent,
        root_weights=root_weights,
        static=orthonormal(regressors, np.array([column.threshold for column in COLUMNS]), CONSTANT),
        fast_vectors=_fast_vectors(regressors),
        lag=lag,
        warming=warming_basis(motion.sensor_c, block),
        turn_basis=turn_basis,
        turn_rate_basis=turn_rate_basis,
    )


def _fast_vectors(regressors: Floats) -> Floats:
    kept = [0, *(number for number, column in enumerate(COLUMNS, CONSTANT) if not column.is_slow)]
    return orthonormal_vectors(regressors[:, kept])
