"""The change of the bias beside the change of the temperature, over steps of many seconds.

A bias that wanders by itself may go along with the temperature, but its steps do not go along with each of its.
"""

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features.block_means import block_means
from gyrodrift.diagnose.features.feature import Feature, ResponseLaw
from gyrodrift.diagnose.features.orthogonal import Basis, orthonormal
from gyrodrift.diagnose.features.units import RMS_DPS

WARMING_BLOCKS = 20
"""In each of the means whose steps are compared."""

LEAST_WARMING_DPS = 4e-3
"""Threshold where the temperature hardly changes: steps of a bias by itself are as large."""

# fmt: off
WARMING = Feature(
    "warming", "environment", "warm", "the bias changes when the temperature changes", 6e-4,
    "0.0006 deg/s per °C, as of `temperature`", reading=RMS_DPS, response=ResponseLaw.LINEAR,
)
# fmt: on


def warming_basis(sensor_c: Floats, block: int) -> Basis:
    """The basis of WARMING, vectors of shape (steps, 1), of temperatures at each sample."""
    steps_c = np.diff(block_means(sensor_c, block * WARMING_BLOCKS))[:, None]
    vectors, thresholds = orthonormal(steps_c, np.array([WARMING.threshold]), 0)
    return Basis(vectors, np.hypot(thresholds, LEAST_WARMING_DPS))


def warming_coefficient(bias_dps: Floats, basis: Basis) -> Floats:
    """WARMING of a bias by blocks, deg/s, shape (1,)."""
    coefficient: Floats = basis.vectors.T @ np.diff(block_means(bias_dps, WARMING_BLOCKS))
    return coefficient
