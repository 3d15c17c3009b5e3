"""What the residuals of a session are held against: the motion, temperature and time of the recording itself.

A recording and each simulation have their own, rebuilt from their own encoder and gyro: what goes wrong in rebuilding
goes wrong in both.
"""

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import uniform_filter1d

from gyrodrift.arrays import Floats, Mask
from gyrodrift.compile import compiled_once
from gyrodrift.diagnose.features.block_means import integral_of, slopes, touches
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

KNOWN_DPS = 0.01
"""A block whose rounding adds less than this is known as well as any."""


def root_weights_of(motion: ReplayedMotion, count_deg: float, block: int, sigma_dps: float) -> Floats:
    """Square roots of weights, shape (blocks,).

    motion, count_deg
        The rebuilt motion, whose angles are those of the encoder, and the step of the encoder.
    sigma_dps
        White noise of a sample of the gyro, which no block is known better than.
    """
    if count_deg == 0.0:
        return np.ones(len(motion.angle_deg) // block)
    rounding_deg = motion.angle_deg - count_deg * np.rint(motion.angle_deg / count_deg)
    rounding_dps = slopes(rounding_deg, motion.period_s, block)
    variance = uniform_filter1d(np.square(rounding_dps), 3)  # one of three blocks may be rounded to the truth by chance
    known = KNOWN_DPS**2 + sigma_dps**2 / block
    roots: Floats = np.sqrt(known / (known + variance))
    return roots


TURN_ORDERS = (3, 8)
"""Parts of a turn, the first and the last that are looked for; halves and wholes are columns."""


def turn_bases(terms: MotionTerms, block: int) -> tuple[Floats, Floats]:
    """Sine and cosine of each multiple, and both times the rate: shape (blocks, some) each, orthonormal."""
    means = np.zeros((2, len(terms.rate_dps) // block, 2 * (TURN_ORDERS[1] - TURN_ORDERS[0] + 1)))
    _add_means(terms.sine, terms.cosine, terms.rate_dps, block, TURN_ORDERS[0], means)
    ones = np.ones(means.shape[2])
    return orthonormal(means[0], ones, 0).vectors, orthonormal(means[1], ones, 0).vectors


@compiled_once(fastmath={"reassoc", "nsz"})
def _add_means(sine: Floats, cosine: Floats, rate: Floats, block: int, lowest: int, means: Floats) -> None:
    """Means over blocks of cosine and sine of each multiple from the lowest on, by itself and times the rate."""
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
"""Over a second an encoder of 0.01 degrees knows the mean rate to some 0.004 deg/s."""

SILENT = 1e-3
"""Root of the weight of a block in which the gyro is at its limit. How far the motion goes beyond is known from counts
alone, and no finer than these: residuals there, the largest of all, would tell of nothing else."""

COLUMNS = (*RATE_COLUMNS, *DRIFT_COLUMNS, *ANGLE_COLUMNS, *HISTORY_COLUMNS)
"""In the order in which they are made orthogonal: what two of them share counts for the first."""

CONSTANT = 1
"""The bias is calibration: the first column, and no feature."""


@dataclass(frozen=True, slots=True)
class DesignMatrix:
    """The motion of a session, what it did when, and orthonormal bases of its regressors.

    samples, period_s, block
        Length of the grid, distance in s, samples in a block.
    is_silent
        Shape (blocks,): where the gyro of the rig says no more than that it is at its limit.
    root_weights
        Shape (blocks,): square roots of how well the encoder knows the mean rate of each block, 1 for very well.
    static
        Of COLUMNS, vectors of shape (blocks, columns), orthonormal under these weights: to be used on what was
        multiplied by the roots.
    fast_vectors
        Shape (blocks, some): a constant and the columns that no slow bias can be taken for, orthonormal likewise.
    lag
        Of LAG_FEATURES: what the rate does within a second, vectors of shape (n, features).
    warming
        Of WARMING: the change of the temperature from one mean of WARMING_BLOCKS to the next.
    turn_basis, turn_rate_basis
        Of sines of multiples of the angle, and of these times the rate: shape (blocks, some), orthonormal.
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
        """One of COLUMNS at each sample, shape (n,): blocks have their means, and samples are too many to keep."""
        column = next(column for column in COLUMNS if column.name == name)
        return column.compute(motion_terms_of(self.motion, self.regimes.speed_dps))


def design_matrix_of(
    real: Cleaned, motion: ReplayedMotion, sigma_dps: float = 0.0, at_limit: Mask | None = None
) -> DesignMatrix:
    """The design matrix of a recording and the motion that was rebuilt from it.

    sigma_dps
        White noise of a sample of its gyro.
    at_limit
        (n,) samples at which its gyro is at its limit by what the rig says; None for none.
    """
    samples, period_s = len(motion.rate_dps), real.recording.period_s
    block = max(1, round(BLOCK_S / period_s))
    lag = lag_basis(real.encoder_deg, period_s)
    regimes = regimes_of(motion, block)
    terms = motion_terms_of(motion, regimes.speed_dps)
    means = [slopes(integral_of(column.compute(terms), period_s), period_s, block) for column in COLUMNS]
    is_silent = np.zeros(samples // block, bool) if at_limit is None else touches(at_limit, period_s, block)
    known = root_weights_of(motion, real.step_deg, block, sigma_dps)
    root_weights = np.where(is_silent, SILENT, known)
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
