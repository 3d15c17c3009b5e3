"""Outliers out of the rate, jumps out of the angle; each is kept as a finding, and all else sees past it."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.ndimage import maximum_filter1d, median_filter

from gyrodrift.arrays import Floats, Mask
from gyrodrift.diagnose.recording.among_neighbours import off_cubic, stands_alone, steepest_beside
from gyrodrift.diagnose.recording.delay import best_lag, smoothed_rates
from gyrodrift.diagnose.recording.motion import rough_rate_dps
from gyrodrift.diagnose.recording.order_statistics import distinct
from gyrodrift.diagnose.recording.recording import Recording, filled
from gyrodrift.diagnose.recording.rests import stretches

SPIKE_SIGMAS = 10.0
"""An outlier of the rate is this far off, beside the encoder or among its neighbours."""

SPIKE_OWN = 0.5
"""A jump of the angle looks like an outlier of the rate beside it; an outlier is one among its own neighbours too, by
this share of what it is beside the angle."""

MOVED_SIGMAS = 3.0
"""Where an outlier among its neighbours is less than SPIKE_OWN beside the encoder, by so much, something did move."""

IN_A_ROW = 2
"""Outliers that hide each other: the second shows once the first is taken out."""

END_SAMPLES = 2
"""Neighbours on one side only do not tell a wild value from a motion that is under way."""

NEARLY_ALL, ROUNDED = 0.995, 1.05
"""Where so many samples are off by no more than so many steps, rounding is all that they are off by: it never makes a
jump of more, and its spread says nothing of jumps."""

MIDDLE_SHARE, MIDDLE_SIGMAS = 0.9, 1.645
"""Nine tenths of normal numbers lie within so many standard deviations; a tenth may be outliers, or quick motion."""

LEAST_POINTS = 8
"""Samples, at least, whose spread counts as that of a second."""

FEW_STEPS, WHOLE = 16.0, 0.1
"""Where the larger of these are a few times the smallest, to this part of it, that one is the step itself: a motion
that comes by the same values again and again may show it once."""

NEXT_LEVEL = 1.6
"""LevelSteps of a step and a half of what they are written in come as one and as two, 0.02 and 0.03."""

LIMIT_RUN, LIMIT_DPS = 5, 10.0
"""So many samples in a row at the largest or the least rate of all, beyond LIMIT_DPS, stand at the gyro's limit."""


class LevelSteps(NamedTuple):
    """The steps that values come in.

    mean
        From one level to the next.
    uneven
        Standard deviation of a level about where it would be in even steps: counts that were rounded to others.
    """

    mean: float
    uneven: float


@dataclass(frozen=True, slots=True)
class Cleaned:
    """A recording without holes, outliers and jumps, and what they were.

    rate_dps, encoder_deg
        Shape (n,).
    step_deg
        The step that the angles come in.
    spikes_dps, slips_deg
        One entry for each outlier of the rate and each jump of the angle, signed.
    late_s
        How much later the gyro speaks than the encoder; 0 if nothing moves.
    """

    recording: Recording
    rate_dps: Floats
    encoder_deg: Floats
    step_deg: float
    spikes_dps: Floats
    slips_deg: Floats
    late_s: float


def cleaned(recording: Recording) -> Cleaned:
    """Find outliers and jumps by what their neighbours are."""
    rate_dps, encoder_deg = filled(recording.rate_dps), filled(recording.encoder_deg)
    rate_dps, spikes_dps = _without_outliers(recording, rate_dps, encoder_deg)
    step_deg = granularity(recording.encoder_deg)
    late = _late_samples(recording, rate_dps, encoder_deg, step_deg)
    at_angles_dps = _earlier(rate_dps, late) if abs(late) > 1.0 else rate_dps
    jumps_deg = _jumps_deg(recording, at_angles_dps, encoder_deg, step_deg)
    slips_deg = jumps_deg[jumps_deg != 0.0]
    if len(slips_deg):
        encoder_deg = encoder_deg - np.cumsum(jumps_deg)
    return Cleaned(recording, rate_dps, encoder_deg, step_deg, spikes_dps, slips_deg, late * recording.period_s)


def at_limit(rate_dps: Floats, angle_deg: Floats, period_s: float) -> Mask:
    """Which samples say no more than that it turned faster than the gyro goes, shape (n,).

    A steady motion at the largest rate of all looks alike where noise is less than a step; but then its encoder does
    not turn by more than that rate, and with more noise many samples stand a step below.
    """
    found: Mask = np.zeros(len(rate_dps), bool)
    for way in (1.0, -1.0):
        largest_dps = float((way * rate_dps).max())
        runs = _runs_of(way * rate_dps == largest_dps)
        if largest_dps <= LIMIT_DPS or not runs:
            continue
        turned_deg = sum(way * (angle_deg[end - 1] - angle_deg[first]) for first, end in runs)
        read_deg = largest_dps * period_s * sum(end - first - 1 for first, end in runs)
        if turned_deg > 1.03 * read_deg and not _stands_below(way * rate_dps, largest_dps):
            for first, end in runs:
                found[first:end] = True
    return found


def _runs_of(extreme: Mask) -> list[tuple[int, int]]:
    """First sample, and the one after the last, of each run of LIMIT_RUN and more."""
    return [(first, end) for first, end in stretches(extreme) if end - first >= LIMIT_RUN]


def _stands_below(rate_dps: Floats, largest_dps: float) -> bool:
    """Whether many samples stand a step below the largest rate."""
    below_dps = rate_dps[rate_dps < largest_dps]
    near = np.count_nonzero(below_dps > largest_dps - NEXT_LEVEL * granularity(rate_dps))
    return bool(5.0 * near > len(rate_dps) - len(below_dps))


def granularity(values: Floats) -> float:
    """Distance of neighbouring values where they lie densest; 0 where there is one value only."""
    return _closest(np.diff(distinct(values)))


def step_of(values: Floats) -> float:
    """The step that values come in, from how many of them span their range; 0 where there is one value only."""
    return steps_of(values).mean


def steps_of(values: Floats) -> LevelSteps:
    """The same with how even the steps are."""
    gaps = np.diff(distinct(values))
    grain = _closest(gaps)
    near = gaps[gaps < NEXT_LEVEL * grain]
    return LevelSteps(float(near.mean()), float(near.std() / np.sqrt(2.0))) if grain else LevelSteps(0.0, 0.0)


def _closest(gaps: Floats) -> float:
    if not len(gaps):
        return 0.0
    last = min(4, int(0.15 * len(gaps)))  # a few pairs are closer by chance; a quick motion visits few values
    lowest = np.sort(np.partition(gaps, last)[: last + 1])
    times = lowest / lowest[0]
    is_step = times[-1] < FEW_STEPS and np.abs(times - np.rint(times)).max() < WHOLE
    return float(lowest[0] if is_step else lowest[-1])


def _without_outliers(recording: Recording, rate_dps: Floats, encoder_deg: Floats) -> tuple[Floats, Floats]:
    """The rate with straight lines across its outliers, shape (n,), and by how much each is off those."""
    is_spike, without_dps = np.zeros(len(rate_dps), np.bool_), rate_dps
    rough_dps = rough_rate_dps(recording, encoder_deg)
    for _ in range(IN_A_ROW):
        found = _outliers(recording, without_dps, rough_dps)
        if not found.any():
            break
        is_spike |= found
        without_dps = filled(np.where(is_spike, np.nan, rate_dps))
    return without_dps, (rate_dps - without_dps)[is_spike]


def _outliers(recording: Recording, rate_dps: Floats, rough_dps: Floats) -> Mask:
    """Which samples are outliers of the rate, shape (n,).

    One is off beside the encoder, or among its neighbours where counts are too coarse to show it: by how much says the
    one that shows it more clearly. What is off among its neighbours alone was moved where the encoder saw it, too.

    rough_dps
        Rate of the encoder, shape (n,).
    """
    away_dps = rate_dps - rough_dps
    beside_dps, among_dps = away_dps - median_filter(away_dps, 5), off_cubic(rate_dps)
    beside, among, own_dps = np.abs(beside_dps), np.abs(among_dps), np.abs(rate_dps - median_filter(rate_dps, 5))
    beside_sigma = _sigma(beside, recording)
    among_sigma = _sigma(np.minimum(among, own_dps), recording)  # an outlier has no echoes there
    is_spike: Mask = (beside > SPIKE_SIGMAS * beside_sigma) | (among > SPIKE_SIGMAS * among_sigma)
    if not is_spike.any():
        return is_spike
    by_neighbours = among * beside_sigma > beside * among_sigma
    size_dps = np.where(by_neighbours, among, beside)
    is_steep = size_dps < 0.6 * steepest_beside(rate_dps)  # less than this share of the steps beside it may be motion
    along_dps = beside_dps * np.sign(np.where(by_neighbours, among_dps, beside_dps))
    was_moved = is_steep | (along_dps < SPIKE_OWN * size_dps - MOVED_SIGMAS * beside_sigma)
    # On a slope the median is none: there a sample that repeats the one before is as far off as an outlier.
    on_slope = stands_alone(among_dps) & ~is_steep & (np.diff(rate_dps, prepend=np.nan) != 0.0)
    is_own = np.maximum(own_dps, np.where(on_slope, among, 0.0)) > SPIKE_OWN * size_dps
    # Less is no outlier where the noise hides within a step.
    is_spike &= (size_dps > 4.0 * granularity(recording.rate_dps)) & is_own & ~(by_neighbours & was_moved)
    # Neighbours of an outlier exceed the limit too where the rate changes quickly.
    is_spike &= (size_dps == maximum_filter1d(size_dps, 3)) & np.isfinite(recording.rate_dps)
    is_spike[:END_SAMPLES] = is_spike[-END_SAMPLES:] = False
    return is_spike


def _jumps_deg(recording: Recording, rate_dps: Floats, encoder_deg: Floats, step_deg: float) -> Floats:
    """By how much the angle jumps at each sample, 0 where it does not; shape (n,)."""
    turned_deg = 0.5 * (rate_dps[1:] + rate_dps[:-1]) * recording.period_s
    over_deg = np.diff(encoder_deg) - turned_deg
    out_deg = np.concatenate([[0.0], over_deg - median_filter(over_deg, 9)])
    # The interval before a sample touches the bends at both ends.
    bends_dps = maximum_filter1d(np.abs(np.diff(rate_dps, 2, prepend=rate_dps[0], append=rate_dps[-1])), 3)
    # A rate that bends within a sample, or comes late by a sample, moves the angle by half of the bend.
    # A jump is more than the steps of a coarse encoder.
    least_deg = 2.5 * step_deg + 0.5 * recording.period_s * bends_dps
    is_rounded = np.quantile(np.abs(out_deg), NEARLY_ALL) < ROUNDED * step_deg
    noise_deg = 0.0 if is_rounded else 7.0 * _sigma(np.abs(out_deg), recording)
    is_slip: Mask = np.abs(out_deg) > np.maximum(noise_deg, least_deg)
    jumps_deg: Floats = np.where(is_slip, out_deg, 0.0)
    return jumps_deg


def _late_samples(recording: Recording, rate_dps: Floats, encoder_deg: Floats, step_deg: float) -> float:
    if not recording.has_motion:
        return 0.0
    return best_lag(smoothed_rates(rate_dps, encoder_deg, step_deg, recording.period_s), recording.period_s).fine


def _earlier(rate_dps: Floats, samples: float) -> Floats:
    """Rates of a gyro that is late by so many samples, at the times of the angles."""
    numbers = np.arange(len(rate_dps))
    earlier_dps: Floats = np.interp(numbers + samples, numbers, rate_dps)
    return earlier_dps


def _sigma(absolute: Floats, recording: Recording) -> Floats:
    """Spread about each sample: of its second or the neighbouring ones, and no less than of all; shape (n,)."""
    points = max(LEAST_POINTS, round(1.0 / recording.period_s))
    seconds = max(1, len(absolute) // points)
    spread = np.quantile(absolute[: seconds * points].reshape(seconds, -1), MIDDLE_SHARE, axis=1) / MIDDLE_SIGMAS
    spread = np.maximum(spread, max(np.median(spread), np.quantile(absolute, 0.5) / MIDDLE_SIGMAS))
    padded = np.concatenate([spread[:1], spread, spread[-1:]])
    wide = np.maximum(np.maximum(padded[:-2], padded[1:-1]), padded[2:])
    last = np.minimum(np.arange(len(absolute)) // points, seconds - 1)
    widest: Floats = wide[last]
    return widest
