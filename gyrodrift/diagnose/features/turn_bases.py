"""Bases of what comes several times per turn: sines of multiples of the angle, and these times the rate."""

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.compile import compiled_once
from gyrodrift.diagnose.features.motion_terms import MotionTerms
from gyrodrift.diagnose.features.orthogonal import orthonormal

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
