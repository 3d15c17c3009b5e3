"""What the residuals of a session are held against: the motion, temperature and time of the recording itself.

The same design matrix serves the recording and every simulation driven through its motion, so that a difference of
their features is a difference of what was measured.
"""

from dataclasses import dataclass

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features.block_means import block_means
from gyrodrift.diagnose.features.drift_columns import DRIFT_COLUMNS
from gyrodrift.diagnose.features.history_columns import HISTORY_COLUMNS
from gyrodrift.diagnose.features.motion_terms import motion_terms_of
from gyrodrift.diagnose.features.orthogonal import Basis, orthonormal, orthonormal_vectors
from gyrodrift.diagnose.features.rate_columns import ANGLE_COLUMNS, RATE_COLUMNS
from gyrodrift.diagnose.features.regimes import Regimes, regimes_of
from gyrodrift.diagnose.features.spreads import SpreadPlaces, spread_places_of
from gyrodrift.diagnose.features.warming import warming_basis
from gyrodrift.diagnose.features.within_second import lag_basis
from gyrodrift.diagnose.recording.motion import ReplayedMotion
from gyrodrift.diagnose.recording.outliers import Cleaned, motion_behind

BLOCK_S = 1.0
"""Over a second an encoder of 0.01 degrees knows the mean rate to some 0.004 deg/s."""

COLUMNS = (*RATE_COLUMNS, *DRIFT_COLUMNS, *ANGLE_COLUMNS, *HISTORY_COLUMNS)
"""In the order in which they are made orthogonal: what two of them share counts for the first."""

CONSTANT = 1
"""The bias is calibration: the first column, and no feature."""

TURN_ORDERS = (3, 8)
"""Parts of a turn, the first and the last that are looked for; halves and wholes are columns."""


@dataclass(frozen=True, slots=True)
class DesignMatrix:
    """The motion of a session, what it did when, and orthonormal bases of its regressors.

    samples, period_s, block
        Length of the grid, distance in s, samples in a block.
    static
        Of COLUMNS, vectors of shape (blocks, columns).
    fast_vectors
        Shape (blocks, some): a constant and the columns that no slow bias can be taken for, orthonormal.
    out_of_catalogue
        Of the columns that no effect of the catalogue depends on: the regressor at each sample, shape (n,).
    lag
        Of LAG_FEATURES: what the rate does within a second, vectors of shape (n, features).
    warming
        Of WARMING: the change of the temperature from one mean of WARMING_BLOCKS to the next.
    turn_basis, turn_rate_basis
        Of sines of multiples of the angle, and of these times the rate: shape (blocks, some), orthonormal.
    """

    motion: ReplayedMotion
    is_coarse: bool
    samples: int
    period_s: float
    block: int
    regimes: Regimes
    spread_places: SpreadPlaces
    static: Basis
    fast_vectors: Floats
    out_of_catalogue: dict[str, Floats]
    lag: Basis
    warming: Basis
    turn_basis: Floats
    turn_rate_basis: Floats


def design_matrix_of(real: Cleaned) -> DesignMatrix:
    """The design matrix of a recording."""
    motion = motion_behind(real)
    samples, period_s = len(motion.rate_dps), real.recording.period_s
    block = max(1, round(BLOCK_S / period_s))
    regimes = regimes_of(motion, block)
    terms = motion_terms_of(motion, regimes.speed_dps)
    columns = [column.compute(terms) for column in COLUMNS]
    regressors = np.column_stack([block_means(column, block) for column in (np.ones(samples), *columns)])
    return DesignMatrix(
        motion=motion,
        is_coarse=real.is_coarse,
        samples=samples,
        period_s=period_s,
        block=block,
        regimes=regimes,
        spread_places=spread_places_of(regimes),
        static=orthonormal(regressors, np.array([column.threshold for column in COLUMNS]), CONSTANT),
        fast_vectors=_fast_vectors(regressors),
        out_of_catalogue={
            column.name: values for column, values in zip(COLUMNS, columns, strict=True) if not column.in_catalogue
        },
        lag=lag_basis(real.encoder_deg, period_s),
        warming=warming_basis(motion.sensor_c, block),
        turn_basis=_turn_basis(motion, np.ones(samples), block),
        turn_rate_basis=_turn_basis(motion, motion.rate_dps, block),
    )


def _fast_vectors(regressors: Floats) -> Floats:
    kept = [0, *(number for number, column in enumerate(COLUMNS, CONSTANT) if not column.is_slow)]
    return orthonormal_vectors(regressors[:, kept])


def _turn_basis(motion: ReplayedMotion, weight: Floats, block: int) -> Floats:
    once = np.exp(1j * np.deg2rad(motion.angle_deg))
    columns = []
    turned = weight * once**2
    for _ in range(TURN_ORDERS[0], TURN_ORDERS[1] + 1):
        turned = turned * once
        columns += [block_means(turned.real, block), block_means(turned.imag, block)]
    return orthonormal(np.column_stack(columns), np.ones(len(columns)), 0).vectors
