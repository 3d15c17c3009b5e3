"""Features that two sets of recordings both determine; other sample rates or steps leave fewer features in common."""

from collections.abc import Sequence

import numpy as np
from scipy.stats import norm as normal

from gyrodrift.diagnose.features.vector import FEATURES, NOT_OF_STEPS, SLOW
from gyrodrift.diagnose.recording.levels import LEAST_GAPS, levels_of
from gyrodrift.diagnose.recording.recording import Recording
from gyrodrift.values.arrays import Mask

SAME_RATE = 0.1
"""Largest relative difference of the sample rates, and of the measured steps, of a device from day to day. A PLL is
good to 1 %, but a radio that loses some samples is not."""

SLOW_ONLY = "single samples are not compared, only rate errors second by second"

CALM = 0.75
"""Share of the second differences that count as noise."""

ALL = np.ones(len(FEATURES), bool)
"""(F,) all features."""


def compared_of(first: Sequence[Recording], second: Sequence[Recording]) -> tuple[Mask, list[str]]:
    """(F,) features that both sets determine, and remarks on the remaining features."""
    compared, remarks = _of_rates(first, second)
    by_steps, of_steps = _of_steps(first, second)
    return compared & by_steps, [*remarks, *of_steps]


def _of_rates(first: Sequence[Recording], second: Sequence[Recording]) -> tuple[Mask, list[str]]:
    """(F,) features that both sample rates determine, and remarks."""
    if is_same_rate(first, second):
        return ALL, []
    before, now = (f"{round(rate_hz, 1):g}" for rate_hz in _rates_hz(first, second))
    return SLOW, [f"the baseline has {before} samples a second, these recordings {now}: {SLOW_ONLY}"]


def is_same_rate(first: Sequence[Recording], second: Sequence[Recording]) -> bool:
    """Whether the median sample rates of two sets agree within SAME_RATE."""
    before_hz, after_hz = _rates_hz(first, second)
    return abs(before_hz / after_hz - 1.0) <= SAME_RATE


def _rates_hz(*sets: Sequence[Recording]) -> list[float]:
    """Median sample rate of each set, Hz."""
    return [1.0 / float(np.median([recording.period_s for recording in recordings])) for recordings in sets]


def _of_steps(first: Sequence[Recording], second: Sequence[Recording]) -> tuple[Mask, list[str]]:
    """(F,) features that the steps of both sets determine, and remarks.

    Coarser steps may be an effect. Steps that are coarser by a power of two are not: the ranges of a gyro double.
    """
    before, now = (_steps_dps(recordings) for recordings in (first, second))
    if before is None or now is None or before == now or (not before and _hide_noise(second, now)):
        return ALL, []
    if not before or not now:
        have, have_not = ("the baseline", "these recordings") if before else ("these recordings", "the baseline")
        words = f"the rates of {have} come in steps of {before or now:.4g} deg/s, those of {have_not} in none"
        return NOT_OF_STEPS, [f"{words}: what depends on steps is not compared"]
    octaves = float(np.log2(now / before))
    if abs(octaves) <= np.log2(1.0 + SAME_RATE):
        return ALL, []
    if octaves > 0.0 and abs(octaves - round(octaves)) > 0.03:  # ranges of one gyro double
        return ALL, []
    words = f"rates come in steps of {before:.4g} deg/s, in these recordings in steps of {now:.4g}"
    return SLOW, [f"{words}: is it the same device with the same range? {SLOW_ONLY}"]


def _hide_noise(recordings: Sequence[Recording], step_dps: float) -> bool:
    """Whether steps round the noise away, because it is less than half a step: a mean of many samples is biased then.

    Finer steps add white noise (B. Widrow, Statistical analysis of amplitude-quantized sampled-data systems, 1961).
    Noise of half a step and rounding have a standard deviation of 1/√3 of a step together.
    """
    return bool(np.median([_scatter_dps(recording) for recording in recordings]) < step_dps / np.sqrt(3.0))


def _scatter_dps(recording: Recording) -> float:
    """Standard deviation of the noise of a sample, from second differences without the quarter with the most motion."""
    bends_dps = np.abs(np.diff(recording.rate_dps[np.isfinite(recording.rate_dps)], 2)) / np.sqrt(6.0)
    kept = np.sort(bends_dps)[: max(1, int(CALM * len(bends_dps)))]
    limit = normal.ppf(0.5 + 0.5 * CALM)
    return float(np.sqrt(np.mean(np.square(kept)) / (1.0 - 2.0 * limit * normal.pdf(limit) / CALM)))


def _steps_dps(recordings: Sequence[Recording]) -> float | None:
    """Median step of the rates; 0 if they have no steps, None if there are too few different rates."""
    levels_of_each = [
        levels
        for levels in (levels_of(recording.rate_dps) for recording in recordings)
        if len(levels.values) > LEAST_GAPS
    ]
    steps = [levels.step for levels in levels_of_each if levels.step is not None]
    if not levels_of_each:
        return None
    return float(np.median(steps)) if 2 * len(steps) > len(levels_of_each) else 0.0
