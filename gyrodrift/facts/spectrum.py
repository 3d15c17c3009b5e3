"""Spectrum of the rate at rest: a tone above the local noise floor, and whether a low-pass acts."""

from dataclasses import dataclass
from math import sqrt

import numpy as np

from gyrodrift.facts.arrays import median_slope
from gyrodrift.values.arrays import Floats

SEGMENT = 256
SEGMENTS_MIN = 4
BIN_MIN = 3
"""Bins below hold slow changes of the bias and the main lobe of the window around 0 Hz."""

TONE_SIGMAS = 12.0
"""A tone exceeds the local floor by the factor 1 + TONE_SIGMAS/√segments.

The relative standard deviation of an averaged bin is 1/√segments (Welch 1967). The margin covers its skewed
distribution, 125 bins and the error of the floor.
"""

LOBE_BINS = 3
"""Half width of a line. The main lobe of the Hann window ends 2 bins from its center, which may lie between bins."""

NARROW = 0.25
"""Beyond the lobe, a line has fallen below this share of its peak on both sides. The side lobes are below 0.001."""

NEIGHBOR_BINS = 16
"""Bins on each side that give the local floor."""

MIDDLE, UPPER = (0.1, 0.4), 0.85
"""Shares of half the sample rate: the band of the sensor's own noise, and the band where a low-pass would act."""


@dataclass(frozen=True, slots=True)
class RestSpectrum:
    """A tone, and the flatness of the noise.

    tone_hz, tone_dps
        Frequency and amplitude of the strongest tone; None without a tone.
    upper_share
        Power density next to half the sample rate over the density in the middle: near 1 without a low-pass.
    """

    tone_hz: float | None
    tone_dps: float | None
    upper_share: float


def spectrum_of(rate_dps: Floats, rate_hz: float) -> RestSpectrum | None:
    """Spectrum of evenly spaced samples, shape (n,), deg/s; None if there are too few.

    Welch's method (1967) with Hann windows and half overlap; the trend of every segment is removed.
    """
    segments = (len(rate_dps) - SEGMENT) // (SEGMENT // 2) + 1
    if segments < SEGMENTS_MIN:
        return None
    density = _density(rate_dps, rate_hz, segments)
    bins = np.arange(len(density)) / (len(density) - 1)
    middle = float(np.median(density[(bins > MIDDLE[0]) & (bins < MIDDLE[1])]))
    if not middle > 0.0:
        return None
    upper_share = float(np.median(density[bins > UPPER][:-1])) / middle
    peak = _tone_bin(density, 1.0 + TONE_SIGMAS / sqrt(segments))
    if peak is None:
        return RestSpectrum(None, None, upper_share)
    lobe = slice(max(peak - LOBE_BINS, 0), peak + LOBE_BINS + 1)
    bin_hz, weights = rate_hz / SEGMENT, density[lobe]
    power = float((weights - _floor_at(density, peak)).sum()) * bin_hz
    tone_hz = float((weights @ np.arange(len(density))[lobe]) / weights.sum()) * bin_hz
    return RestSpectrum(tone_hz, sqrt(max(2.0 * power, 0.0)), upper_share)


def _density(rate_dps: Floats, rate_hz: float, segments: int) -> Floats:
    """One-sided power density, (deg/s)²/Hz, shape (SEGMENT/2 + 1,)."""
    window = np.hanning(SEGMENT + 1)[:-1]
    starts = np.arange(segments) * (SEGMENT // 2)
    pieces = rate_dps[starts[:, None] + np.arange(SEGMENT)]
    ramp = np.arange(SEGMENT) - 0.5 * (SEGMENT - 1)
    slopes = pieces @ ramp / (ramp @ ramp)
    pieces = (pieces - pieces.mean(axis=1, keepdims=True) - slopes[:, None] * ramp) * window
    power: Floats = (np.abs(np.fft.rfft(pieces, axis=1)) ** 2).mean(axis=0)
    return power * 2.0 / (rate_hz * (window @ window))


def _tone_bin(density: Floats, factor: float) -> int | None:
    """Bin of the strongest narrow line that exceeds the local floor by `factor`; None without a line."""
    ratios = {index: density[index] / _floor_at(density, index) for index in range(BIN_MIN, len(density) - 1)}
    lines = [index for index, ratio in ratios.items() if ratio > factor and _is_narrow(density, index)]
    return max(lines, key=ratios.__getitem__, default=None)


def _is_narrow(density: Floats, peak: int) -> bool:
    """Whether a bin is the top of its lobe and the density falls on both sides of the lobe, down to BIN_MIN."""
    below, above = peak - LOBE_BINS, min(peak + LOBE_BINS, len(density) - 1)
    if below < BIN_MIN or density[peak] < density[below : above + 1].max():
        return False
    is_last = peak + LOBE_BINS >= len(density)  # the lobe is folded at half the sample rate
    return density[below] < NARROW * density[peak] and (is_last or density[above] < NARROW * density[peak])


def _floor_at(density: Floats, index: int) -> float:
    """Noise floor at a bin, from its neighbors on both sides without the lobe.

    A line through log density over log frequency, by the median slope: it follows 1/f noise and a low-pass, and ignores
    other tones.
    """
    bins = np.arange(max(BIN_MIN, index - NEIGHBOR_BINS), min(len(density) - 1, index + NEIGHBOR_BINS + 1))
    bins = bins[np.abs(bins - index) > LOBE_BINS]
    x, y = np.log(bins), np.log(np.maximum(density[bins], np.finfo(float).tiny))
    slope = median_slope(x, y)
    return float(np.exp(np.median(y - slope * x) + slope * np.log(index)))
