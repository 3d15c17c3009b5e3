"""Remove outliers from the rate and jumps from the angle.

Their sizes are kept, because effects of the catalog cause them.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from gyrodrift.diagnose.recording.delay import best_lag, smoothed_rates
from gyrodrift.diagnose.recording.motion import rough_rate_dps
from gyrodrift.diagnose.recording.order_statistics import (
    distinct,
    median,
    median_of_five,
    median_of_nine,
    quantiles,
    running_maximum,
)
from gyrodrift.diagnose.recording.recording import Recording, filled
from gyrodrift.facts.arrays import true_runs
from gyrodrift.values.arrays import Floats, Integers, Mask


def cubic_residual(values: Floats) -> Floats:
    """(n,) difference of every value from the cubic through the two values before it and the two after it.

    The cubic follows quick motion. Beside an outlier the residual is two thirds of the outlier.
    """
    padded = np.pad(values, 2, mode="edge")
    residual: Floats = values - (4.0 * (padded[1:-3] + padded[3:-1]) - (padded[:-4] + padded[4:])) / 6.0
    return residual


def steepest_neighbor_step(values: Floats, index: Integers) -> Floats:
    """(k,) largest step between two successive values near a value, without the steps to and from the value."""
    near = values[np.clip(index[:, None] + np.arange(-3, 4), 0, len(values) - 1)]
    steps = np.abs(np.diff(near, axis=1))
    steepest: Floats = steps[:, (0, 1, 4, 5)].max(axis=1)
    return steepest


def is_isolated(residuals: Floats) -> Mask:
    """(k,) whether the cubic residual of a value is 1.25 times larger than those of both neighbors.

    Beside an outlier the residual is two thirds of it. At an edge of the rate both sides have the same residual.

    residuals
        (k, 3) residuals of the neighbor before, the value and the neighbor after.
    """
    size = np.abs(residuals)
    isolated: Mask = size[:, 1] > 1.25 * np.maximum(size[:, 0], size[:, 2])
    return isolated


SPIKE_SIGMAS = 10.0
"""Least residual of an outlier of the rate, in standard deviations: against the encoder, or against its neighbors.
Chosen: normal noise does not reach it."""

SPIKE_OWN = 0.5
"""Least deviation of an outlier from the median of its neighbors, as a share of its size. Chosen: a jump of the angle
is an outlier against the encoder only."""

MOVED_SIGMAS = 3.0
"""Standard deviations below SPIKE_OWN times its size at which an outlier among its neighbors counts as motion, because
the encoder shows it, too. Chosen: noise of the encoder is rarely larger."""

IN_A_ROW = 2
"""Number of passes. Chosen: the second outlier of a pair shows only after the first has been removed."""

END_SAMPLES = 2
"""Samples at either end that are never outliers: neighbors on a single side do not tell an outlier from motion.
Derived: the cubic takes two on either side."""

NEARLY_ALL, ROUNDED = 0.995, 1.05
"""Share of the samples, and number of encoder steps within which they lie if the angle errs by rounding only. Then the
threshold of a jump does not depend on the standard deviation, because rounding makes no larger jump. Chosen: jumps are
rarer than one in 200 samples."""

MIDDLE_SHARE, MIDDLE_SIGMAS = 0.9, 1.645
"""Share of a normal distribution within so many standard deviations. Chosen: a tenth of the samples may be outliers or
quick motion. Derived: MIDDLE_SIGMAS is Φ⁻¹(0.95)."""

LEAST_SAMPLES = 8
"""Least number of samples from which the standard deviation within a second is taken. Chosen: fewer hardly show
MIDDLE_SHARE."""

FEW_STEPS, WHOLE = 16.0, 0.1
"""Largest multiple of the smallest gap, and its tolerance, at which the smallest gap is the step itself. Chosen: a
motion that repeats the same values may show that gap only once."""

NEXT_LEVEL = 1.6
"""Gaps below so many times the smallest gap are a single step. Derived: 3/2, and some margin. Steps of two and a half
units of the last decimal are written as two and as three units, such as 0.02 and 0.03."""

LIMIT_RUN, LIMIT_DPS = 5, 10.0
"""Least number of successive samples at the largest rate, and least size of this rate, of a gyro at its limit. Chosen:
noise rarely repeats a rate so often, and ranges of gyros are larger."""


class LevelSteps(NamedTuple):
    """Steps between the levels of some values.

    mean
        Mean step.
    scatter
        Standard deviation of the levels about an even grid. It is large if counts were rounded to a finer grid.
    """

    mean: float
    scatter: float


@dataclass(frozen=True, slots=True)
class Cleaned:
    """A recording without gaps, outliers and jumps.

    rate_dps, encoder_deg
        Corrected rate and angle, shape (n,).
    step_deg
        Smallest step of the angles; see `granularity`.
    spikes_dps, slips_deg
        Signed sizes of the removed outliers of the rate and jumps of the angle.
    delay_s
        Delay of the gyro against the encoder; 0 without motion.
    """

    recording: Recording
    rate_dps: Floats
    encoder_deg: Floats
    step_deg: float
    spikes_dps: Floats
    slips_deg: Floats
    delay_s: float


def clean(recording: Recording) -> Cleaned:
    """Interpolate the gaps of a recording, then remove its outliers and jumps."""
    rate_dps, encoder_deg = filled(recording.rate_dps), filled(recording.encoder_deg)
    rate_dps, spikes_dps = _without_outliers(recording, rate_dps, encoder_deg)
    step_deg = granularity(recording.encoder_deg)
    delay = _delay_samples(recording, rate_dps, encoder_deg, step_deg)
    at_angles_dps = _advanced(rate_dps, delay) if abs(delay) > 1.0 else rate_dps
    jumps_deg = _jumps_deg(recording, at_angles_dps, encoder_deg, step_deg)
    slips_deg = jumps_deg[jumps_deg != 0.0]
    if len(slips_deg):
        encoder_deg = encoder_deg - np.cumsum(jumps_deg)
    return Cleaned(recording, rate_dps, encoder_deg, step_deg, spikes_dps, slips_deg, delay * recording.period_s)


def is_at_limit(rate_dps: Floats, angle_deg: Floats, period_s: float) -> Mask:
    """(n,) whether a sample is at the limit of the gyro, so that the true rate is larger.

    Steady motion at the largest rate also repeats this rate if its noise is less than a step. But then the encoder does
    not turn faster than the gyro. If the noise is larger, many samples are a step below.
    """
    at_limit: Mask = np.zeros(len(rate_dps), bool)
    for sign in (1.0, -1.0):
        largest_dps = float((sign * rate_dps).max())
        runs = _long_runs(sign * rate_dps == largest_dps)
        if largest_dps <= LIMIT_DPS or not runs:
            continue
        encoder_turn_deg = sum(sign * (angle_deg[end - 1] - angle_deg[first]) for first, end in runs)
        gyro_turn_deg = largest_dps * period_s * sum(end - first - 1 for first, end in runs)
        if encoder_turn_deg > 1.03 * gyro_turn_deg and not _has_many_below(sign * rate_dps, largest_dps):
            for first, end in runs:
                at_limit[first:end] = True
    return at_limit


def _long_runs(extreme: Mask) -> list[tuple[int, int]]:
    """First and end sample of every run of at least LIMIT_RUN samples."""
    return [(first, end) for first, end in true_runs(extreme) if end - first >= LIMIT_RUN]


def _has_many_below(rate_dps: Floats, largest_dps: float) -> bool:
    """Whether more than a fifth as many samples are a step below the largest rate as are at it."""
    below_dps = rate_dps[rate_dps < largest_dps]
    near = np.count_nonzero(below_dps > largest_dps - NEXT_LEVEL * granularity(rate_dps))
    return bool(5.0 * near > len(rate_dps) - len(below_dps))


def granularity(values: Floats) -> float:
    """Smallest gap between distinct values, without those that are smaller by chance; 0 for a single value."""
    return _smallest_gap(np.diff(distinct(values)))


def step_of(values: Floats) -> float:
    """Mean step between distinct values; 0 for a single value."""
    return steps_of(values).mean


def steps_of(values: Floats) -> LevelSteps:
    """Mean and scatter of the steps between distinct values, by the gaps below NEXT_LEVEL times the smallest."""
    gaps = np.diff(distinct(values))
    grain = _smallest_gap(gaps)
    near = gaps[gaps < NEXT_LEVEL * grain]
    return LevelSteps(float(near.mean()), float(near.std() / np.sqrt(2.0))) if grain else LevelSteps(0.0, 0.0)


def _smallest_gap(gaps: Floats) -> float:
    """Fifth smallest gap, or the smallest if the others are multiples of it; 0 without gaps.

    A few gaps are smaller by chance. With few gaps, as in quick motion, fewer are skipped.
    """
    if not len(gaps):
        return 0.0
    last = min(4, int(0.15 * len(gaps)))
    lowest = np.sort(np.partition(gaps, last)[: last + 1])
    times = lowest / lowest[0]
    is_step = times[-1] < FEW_STEPS and np.abs(times - np.rint(times)).max() < WHOLE
    return float(lowest[0] if is_step else lowest[-1])


def _without_outliers(recording: Recording, rate_dps: Floats, encoder_deg: Floats) -> tuple[Floats, Floats]:
    """(n,) rate with linear interpolation across its outliers, and (outliers,) their signed sizes."""
    is_spike, without_dps = np.zeros(len(rate_dps), np.bool_), rate_dps
    rough_dps = rough_rate_dps(recording, encoder_deg)
    for _ in range(IN_A_ROW):
        is_outlier = _is_outlier(recording, without_dps, rough_dps)
        if not is_outlier.any():
            break
        is_spike |= is_outlier
        without_dps = filled(np.where(is_spike, np.nan, rate_dps))
    return without_dps, (rate_dps - without_dps)[is_spike]


def _is_outlier(recording: Recording, rate_dps: Floats, rough_dps: Floats) -> Mask:
    """(n,) whether a sample is an outlier of the rate.

    An outlier has a large residual against the encoder, or against its neighbors if counts are too coarse to show it.
    Its size is the residual that is larger in standard deviations. An outlier against its neighbors is motion if the
    encoder shows it, too.

    rough_dps
        Rate of the encoder, shape (n,).
    """
    difference_dps = rate_dps - rough_dps
    encoder_dps, cubic_dps = difference_dps - median_of_five(difference_dps), cubic_residual(rate_dps)
    by_encoder, by_cubic = np.abs(encoder_dps), np.abs(cubic_dps)
    by_median = np.abs(rate_dps - median_of_five(rate_dps))
    encoder_sigma = _sigma(by_encoder, recording)
    # The median has no residual beside an outlier, so the smaller of both residuals is free of it.
    cubic_sigma = _sigma(np.minimum(by_cubic, by_median), recording)
    is_spike: Mask = (by_encoder > SPIKE_SIGMAS * encoder_sigma) | (by_cubic > SPIKE_SIGMAS * cubic_sigma)
    is_spike[:END_SAMPLES] = is_spike[-END_SAMPLES:] = False
    index = np.flatnonzero(is_spike & np.isfinite(recording.rate_dps))
    if not len(index):
        return np.zeros_like(is_spike)
    around = index[:, None] + (-1, 0, 1)
    is_by_cubic = by_cubic[around] * encoder_sigma[around] > by_encoder[around] * cubic_sigma[around]
    sizes_dps = np.where(is_by_cubic, by_cubic[around], by_encoder[around])
    size_dps, by_cubic, by_median, is_by_cubic = sizes_dps[:, 1], by_cubic[index], by_median[index], is_by_cubic[:, 1]
    # Smaller than this, it may be part of a motion.
    is_steep = size_dps < 0.6 * steepest_neighbor_step(rate_dps, index)
    along_dps = encoder_dps[index] * np.sign(np.where(is_by_cubic, cubic_dps[index], encoder_dps[index]))
    is_motion = is_steep | (along_dps < SPIKE_OWN * size_dps - MOVED_SIGMAS * encoder_sigma[index])
    # On a slope the median is the sample itself, so its residual is 0 and the cubic decides. A sample that repeats the
    # sample before is excluded: its cubic residual is as large as that of an outlier.
    on_slope = is_isolated(cubic_dps[around]) & ~is_steep & (rate_dps[index] != rate_dps[index - 1])
    is_own = np.maximum(by_median, np.where(on_slope, by_cubic, 0.0)) > SPIKE_OWN * size_dps
    # If the noise is less than a step, residuals of a few steps are no outliers.
    is_outlier = (size_dps > 4.0 * granularity(recording.rate_dps)) & is_own & ~(is_by_cubic & is_motion)
    # If the rate changes quickly, the neighbors of an outlier exceed the threshold, too. The largest is the outlier.
    is_outlier &= size_dps == sizes_dps.max(axis=1)
    is_spike[:] = False
    is_spike[index[is_outlier]] = True
    return is_spike


def _jumps_deg(recording: Recording, rate_dps: Floats, encoder_deg: Floats, step_deg: float) -> Floats:
    """(n,) signed jump of the angle before every sample; 0 without a jump."""
    gyro_turn_deg = 0.5 * (rate_dps[1:] + rate_dps[:-1]) * recording.period_s
    excess_deg = np.diff(encoder_deg) - gyro_turn_deg
    residual_deg = np.concatenate([[0.0], excess_deg - median_of_nine(excess_deg)])
    # The interval before a sample touches the bends at both ends.
    bends_dps = running_maximum(np.abs(np.diff(rate_dps, 2, prepend=rate_dps[0], append=rate_dps[-1])), 3)
    # A rate that bends within a sample, or is late by a sample, moves the angle by half of the bend.
    # A jump is larger than the rounding of a coarse encoder.
    least_deg = 2.5 * step_deg + 0.5 * recording.period_s * bends_dps
    is_rounded = quantiles(np.abs(residual_deg), NEARLY_ALL) < ROUNDED * step_deg
    noise_deg = 0.0 if is_rounded else 7.0 * _sigma(np.abs(residual_deg), recording)
    is_slip: Mask = np.abs(residual_deg) > np.maximum(noise_deg, least_deg)
    jumps_deg: Floats = np.where(is_slip, residual_deg, 0.0)
    return jumps_deg


def _delay_samples(recording: Recording, rate_dps: Floats, encoder_deg: Floats, step_deg: float) -> float:
    """Delay of the gyro against the encoder, in samples; 0 without motion."""
    if not recording.has_motion:
        return 0.0
    return best_lag(smoothed_rates(rate_dps, encoder_deg, step_deg, recording.period_s), recording.period_s).delay


def _advanced(rate_dps: Floats, delay: float) -> Floats:
    """(n,) rates of a delayed gyro at the times of the angles, by linear interpolation; the delay is in samples."""
    index = np.arange(len(rate_dps))
    advanced_dps: Floats = np.interp(index + delay, index, rate_dps)
    return advanced_dps


def _sigma(absolute: Floats, recording: Recording) -> Floats:
    """(n,) standard deviation of residuals near every sample, from their absolute values.

    It is the largest of the second of the sample and the seconds before and after, and at least the median over the
    recording.
    """
    length = max(LEAST_SAMPLES, round(1.0 / recording.period_s))
    seconds = max(1, len(absolute) // length)
    sigma = quantiles(absolute[: seconds * length].reshape(seconds, -1), MIDDLE_SHARE) / MIDDLE_SIGMAS
    sigma = np.maximum(sigma, max(median(sigma), median(absolute) / MIDDLE_SIGMAS))
    padded = np.concatenate([sigma[:1], sigma, sigma[-1:]])
    wide = np.maximum(np.maximum(padded[:-2], padded[1:-1]), padded[2:])
    second = np.minimum(np.arange(len(absolute)) // length, seconds - 1)
    widest: Floats = wide[second]
    return widest
