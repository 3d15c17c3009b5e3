"""The spectrum of the rate at rest: a tone that stands out, and whether anything filters below half the rate."""

from dataclasses import dataclass
from math import sqrt

import numpy as np

from gyrodrift.arrays import Floats

SEGMENT = 256
SEGMENTS_LEAST = 4
LOWEST = 3
"""Bins next to zero hold what the bias does, and the skirt of the window."""

LOUD = 12.0
"""A bin is a tone where it stands above the median by 1 + LOUD/√segments: noise alone gets there once in 10^5 rests."""

SKIRT = 3
BESIDE = 16
"""Bins to either side that a tone stands out from."""

MIDDLE, UPPER = (0.1, 0.4), 0.85
"""Shares of half the sample rate: where the noise is that of the sensor, and where a low-pass would be felt."""


@dataclass(frozen=True, slots=True)
class RestSpectrum:
    """What it shows.

    tone_hz, tone_dps
        Frequency and amplitude of the loudest tone; None where none stands out.
    upper_share
        Power density next to half the sample rate over that in the middle: near 1, nothing filters.
    """

    tone_hz: float | None
    tone_dps: float | None
    upper_share: float


def spectrum_of(rate_dps: Floats, rate_hz: float) -> RestSpectrum | None:
    """Of a stretch of even samples; None where it is too short. Welch's method, Hann window, half overlap."""
    segments = (len(rate_dps) - SEGMENT) // (SEGMENT // 2) + 1
    if segments < SEGMENTS_LEAST:
        return None
    window = np.hanning(SEGMENT + 1)[:-1]
    starts = np.arange(segments) * (SEGMENT // 2)
    pieces = rate_dps[starts[:, None] + np.arange(SEGMENT)]
    ramp = np.arange(SEGMENT) - 0.5 * (SEGMENT - 1)
    slopes = pieces @ ramp / (ramp @ ramp)
    pieces = (pieces - pieces.mean(axis=1, keepdims=True) - slopes[:, None] * ramp) * window
    density = (np.abs(np.fft.rfft(pieces, axis=1)) ** 2).mean(axis=0) * 2.0 / (rate_hz * (window @ window))
    bins = np.arange(len(density)) / (len(density) - 1)
    middle = float(np.median(density[(bins > MIDDLE[0]) & (bins < MIDDLE[1])]))
    if not middle > 0.0:
        return None
    upper = float(np.median(density[bins > UPPER][:-1]))
    peak = LOWEST + int((density[LOWEST:-1] / _beside(density)[LOWEST:-1]).argmax())
    if density[peak] < (1.0 + LOUD / sqrt(segments)) * _beside(density)[peak]:
        return RestSpectrum(None, None, upper / middle)
    around = slice(max(peak - SKIRT, 0), peak + SKIRT + 1)
    power = float((density[around] - middle).sum()) * rate_hz / SEGMENT
    weights = density[around]
    frequency_hz = float((weights @ np.arange(len(density))[around]) / weights.sum()) * rate_hz / SEGMENT
    return RestSpectrum(frequency_hz, sqrt(max(2.0 * power, 0.0)), upper / middle)


def _beside(density: Floats) -> Floats:
    """Median of the bins around each, shape of the density."""
    padded = np.pad(density[LOWEST:], (LOWEST + BESIDE, BESIDE), mode="reflect")
    medians: Floats = np.median(np.lib.stride_tricks.sliding_window_view(padded, 2 * BESIDE + 1), axis=1)
    return medians
