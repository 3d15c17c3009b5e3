"""What steps of the rate hide: where its noise is less than a step, means are off by what no noise smooths.

The mean of a quantised value with Gaussian noise of standard deviation σ is off by at most about
step/π·exp(−2π²·σ²/step²), with a sign that depends on where between two steps it lies (B. Widrow and I. Kollár,
Quantization Noise, 2008). What is smaller cannot be known, so that relevance thresholds grow by it.
"""

import numpy as np

from gyrodrift.arrays import Floats, Mask
from gyrodrift.diagnose.features.block_means import LEAST_DPS
from gyrodrift.diagnose.features.feature import Measured
from gyrodrift.diagnose.features.vector import FEATURES, IS_LOG, STATIC

STATIC_SHARE = 0.3
"""Of the length of errors that are all alike: what goes to one regressor of errors that differ from rate to rate."""

OF_BIAS = ("wander", "walk", "step", "two_levels", "swing", "ripple", "scatter", "line", "noise_uneven")
"""How the names of features begin that go by how the rate scatters."""

OF_STEPS = ("noise_", "tails_", "equal_", "zero_share")
"""How the names of features begin that go by which steps come."""

STEPS_SHARE = {True: 2.0, False: 0.5}
"""What such a feature may be off by where all noise hides in a step: logarithms of variances, roots of shares."""

BY_BIAS: Mask = np.array([feature.name.startswith(OF_BIAS) for feature in FEATURES])


BY_STEPS: Mask = np.array([feature.name.startswith(OF_STEPS) for feature in FEATURES])
STEPS_MOST: Floats = np.where(IS_LOG, STEPS_SHARE[True], STEPS_SHARE[False])[BY_STEPS]


def hidden_dps(step_dps: float, sigma_dps: float) -> float:
    """By how much a mean may be off, deg/s, of rates in steps with noise of a standard deviation by sample."""
    return float(step_dps / np.pi * np.exp(-2.0 * (np.pi * sigma_dps / step_dps) ** 2))


def with_hidden(measured: Measured, hidden: float, step_dps: float, scatter_dps: float, blocks: int) -> Measured:
    """Thresholds that know what steps hide.

    scatter_dps
        Of block residuals, beside which it counts.
    """
    if hidden <= LEAST_DPS:
        return measured
    thresholds: Floats = measured.thresholds.copy()
    more = np.log1p((hidden / max(scatter_dps, LEAST_DPS)) ** 2)
    thresholds[BY_BIAS] = np.hypot(thresholds[BY_BIAS], more)
    thresholds[:STATIC] = np.hypot(thresholds[:STATIC], STATIC_SHARE * hidden * np.sqrt(blocks))
    thresholds[BY_STEPS] = np.hypot(thresholds[BY_STEPS], STEPS_MOST * np.pi * hidden / step_dps)
    return measured._replace(thresholds=thresholds)
