"""Features of single values: repeats, zeros, steps and range of the rate; steps, scatter and jumps of the angle."""

from dataclasses import dataclass

import numpy as np

from gyrodrift.diagnose.features.design_matrix import DesignMatrix
from gyrodrift.diagnose.features.feature import (
    AMPLITUDE_DEG,
    COUNTS,
    OVER_ENCODER,
    PERCENT_OF_SAMPLES,
    ResponseLaw,
    Statistic,
)
from gyrodrift.diagnose.features.noise import root_share
from gyrodrift.diagnose.features.spreads import turning_spread
from gyrodrift.diagnose.recording.outliers import Cleaned, granularity
from gyrodrift.values.arrays import Floats, Mask

NEAR_ZERO_DPS = 3.0
"""Rates below this limit, deg/s, show their steps. Chosen: near 0 they are dense enough."""

LEAK = 3
"""Rank of the rate that counts as the smallest. Chosen: two smaller ones may be chance."""

LEAST_SLIP_DEG = 0.2
"""Negligible jump of the angle per minute, deg. Chosen: a little less than NEGLIGIBLE_DEG of yaw."""

REACH_DPS = 1.0
"""Added to the largest rates of gyro and encoder, deg/s, so that their ratio is 1 in a recording with little motion.
Chosen: far above the noise of rest, far below the range of a gyro."""


@dataclass(frozen=True, slots=True)
class RateValues:
    """Recorded values of a rate in counts, without interpolated samples.

    counts, is_there
        Counts, shape (n,), and which of these samples were recorded.
    is_equal, has_both
        Pairs of successive samples, shape (n − 1,): recorded with equal counts, and both recorded.
    near
        Counts of rates below NEAR_ZERO_DPS.
    step
        Step of `near`, counts; 1 without such rates.
    """

    cleaned: Cleaned
    design: DesignMatrix
    dps_per_lsb: float
    counts: Floats
    is_there: Mask
    is_equal: Mask
    has_both: Mask
    near: Floats
    step: float


def rate_values_of(cleaned: Cleaned, design: DesignMatrix, dps_per_lsb: float) -> RateValues:
    """Compute the statistics of the recorded rates."""
    rate_dps = cleaned.recording.rate_dps
    is_there = np.isfinite(rate_dps)
    counts = np.rint(np.where(is_there, rate_dps, 0.0) / dps_per_lsb)
    has_both = is_there[1:] & is_there[:-1]
    is_equal = (counts[1:] == counts[:-1]) & has_both
    near = counts[is_there & (np.abs(rate_dps) < NEAR_ZERO_DPS)]
    step = max(granularity(near), 1.0) if len(near) else 1.0
    return RateValues(cleaned, design, dps_per_lsb, counts, is_there, is_equal, has_both, near, step)


def smallest(sizes: Floats) -> float:
    """The LEAK-th smallest of positive numbers, or the smallest if there are fewer."""
    return float(np.partition(sizes, LEAK - 1)[LEAK - 1]) if len(sizes) >= LEAK else float(sizes.min())


def _equal_share(values: RateValues, regime: Mask) -> float:
    equal = int(np.count_nonzero(values.is_equal & regime[1:]))
    return root_share(equal, int(np.count_nonzero(values.has_both & regime[1:])))


def _excess_of_zeros(values: RateValues) -> float:
    """Root of the share of zeros near zero, less the root of the mean share of the levels one step above and below.

    A rate that passes zero takes these three levels equally often. A dead band takes only zero.
    """
    zeros, neighbors = (int(np.count_nonzero(np.abs(values.near) == size)) for size in (0.0, values.step))
    return root_share(zeros, len(values.near)) - root_share(neighbors, 2 * len(values.near))


def _log2_least(values: RateValues) -> float:
    """Binary logarithm of the smallest rate, in counts; at least 1 count and at least 0.08 deg/s."""
    sizes = np.abs(values.near)
    nonzero = sizes[sizes > 0.0]
    # A rate that only passes through zero may miss smaller values by chance.
    least = max(1.0, 0.08 / values.dps_per_lsb)
    return float(np.log2(max(smallest(nonzero) if len(nonzero) else 1.0, least)))


def _log_reach(values: RateValues) -> float:
    """Logarithm of the gyro's largest rate over that of the encoder."""
    top = float((np.abs(values.cleaned.rate_dps) / values.dps_per_lsb).max(initial=1.0))
    fastest_dps = float(np.abs(values.design.regimes.speed_dps).max())
    return float(np.log((top * values.dps_per_lsb + REACH_DPS) / (fastest_dps + REACH_DPS)))


# fmt: off
RATE_VALUES: tuple[Statistic[RateValues], ...] = (
    Statistic(
        "equal_rest", "sensor", "rest", "neighboring samples at rest are equal too often", 0.02,
        "four samples in 10,000", reading=PERCENT_OF_SAMPLES, response=ResponseLaw.ROOT_SHARE,
        compute=lambda values: _equal_share(values, values.design.regimes.at_rest),
    ),
    Statistic(
        "equal_moving", "link", "moving", "neighboring samples in motion are equal too often", 0.01,
        "one sample in 10,000", reading=PERCENT_OF_SAMPLES, response=ResponseLaw.ROOT_SHARE,
        compute=lambda values: _equal_share(values, values.design.regimes.is_turning),
    ),
    Statistic(
        "equal_quick", "link", "accelerating", "samples repeat while the rate is changing", 0.035,
        "twelve samples in 10,000", reading=PERCENT_OF_SAMPLES, response=ResponseLaw.ROOT_SHARE,
        compute=lambda values: _equal_share(values, values.design.regimes.is_quick),
    ),
    Statistic(
        "zero_share", "sensor", "slow", "the rate reads exactly zero too often", 0.01,
        "one sample in 10,000", reading=PERCENT_OF_SAMPLES, compute=_excess_of_zeros,
    ),
    Statistic(
        "least_rate", "sensor", "slow", "small rates do not occur", 0.5, "half a doubling: less than one count",
        reading=COUNTS, compute=_log2_least,
    ),
    Statistic(
        "rate_step", "sensor", "always", "the rate comes in coarser steps than the rig says", 0.15,
        "0.15 of a doubling: a ninth of the step", reading=COUNTS, compute=lambda values: float(np.log2(values.step)),
    ),
    Statistic(
        "reach", "sensor", "fast", "the largest rates differ from those of the encoder", 0.005,
        "0.5 % of the largest rate", reading=OVER_ENCODER, compute=_log_reach,
    ),
)
# fmt: on


@dataclass(frozen=True, slots=True)
class AngleValues:
    """Angles of a recording and its motion; `count_deg` is the step of the encoder that the rig states."""

    cleaned: Cleaned
    design: DesignMatrix
    count_deg: float


def _log2_step(angle: AngleValues) -> float:
    ratio = angle.cleaned.step_deg / angle.count_deg
    return float(np.log2(ratio)) if ratio > 1.0 and _shows_counts(angle.cleaned) else 0.0


def _shows_counts(cleaned: Cleaned) -> bool:
    """Whether the motion is varied enough to show counts between two steps, if there are any.

    A steady speed of a whole number of counts per sample hits the same counts in every turn.
    """
    moved = np.abs(np.diff(cleaned.recording.encoder_deg)) / cleaned.step_deg
    steps = np.rint(moved[np.isfinite(moved)])
    # 40 are more than chance, or the rounding of a steady ramp, produce.
    return bool(np.count_nonzero(steps == 1.0) + len(np.unique(steps[steps > 1.0])) >= 40)


def _log_scatter(angle: AngleValues) -> float:
    """Logarithm of the variance of the angle's noise, including the variance of rounding to counts."""
    spread = turning_spread(angle.cleaned.encoder_deg, angle.design.difference_indices)
    return float(np.log(spread + angle.count_deg**2 / 12.0))


def _slip_power(angle: AngleValues) -> float:
    """Logarithm of the sum of squares of the jumps per minute."""
    minutes = angle.design.samples * angle.design.period_s / 60.0
    return float(np.log(np.square(angle.cleaned.slips_deg).sum() / minutes + LEAST_SLIP_DEG**2))


# fmt: off
ANGLE_VALUES: tuple[Statistic[AngleValues], ...] = (
    Statistic(
        "angle_step", "encoder", "always", "the angle comes in coarser steps than the rig says", 0.15,
        "0.15 of a doubling: a ninth of the step", reading=COUNTS, compute=_log2_step,
    ),
    Statistic(
        "angle_noise", "encoder", "moving", "the angle scatters from sample to sample", 0.2,
        "0.2 in ln of a variance: a tenth of the amplitude", reading=AMPLITUDE_DEG, response=ResponseLaw.LOG_VARIANCE,
        compute=_log_scatter,
    ),
    Statistic(
        "slip_power", "encoder", "always", "the angle jumps", 0.5,
        "0.5 in ln of a variance: a quarter of the amplitude", reading=AMPLITUDE_DEG, response=ResponseLaw.LOG_VARIANCE,
        compute=_slip_power,
    ),
)
# fmt: on
