"""The spectrum of a rate at rest: a line that stands out of the noise, and the level of the white part of it."""

from typing import NamedTuple

import numpy as np
from scipy.ndimage import median_filter

from gyrodrift.arrays import Floats, Mask
from gyrodrift.diagnose.features.design_matrix import DesignMatrix
from gyrodrift.diagnose.features.spreads import MOVING_POINTS, REST_POINTS, spreads_of
from gyrodrift.diagnose.recording.outliers import Cleaned

WINDOW = 256
"""Samples of a spectrum."""

FEW_WINDOWS = 8
"""With fewer at rest, a line is looked for in motion too, and white noise in differences."""

LINE_POINTS = 31
"""Neighbouring frequencies whose median a line stands out of."""

LOWEST = 3
"""The first frequency at which a line is looked for; below is what the window leaks of slow changes."""

WHITE_BAND = (0.02, 0.12)
"""Shares of the sample rate: above what 1/f noise adds at rest, below what most filters take away."""

LEAST_POWER = 1e-6
"""Of a window whose samples scatter by 1e-4 deg/s: below it there is no noise for a line to stand out of."""

WHITE_POINTS = (4, 8)
"""Samples in the means whose scatter stands for white noise where the spectrum does not show it."""


class SpectralLine(NamedTuple):
    """Logarithm of one more than its height over its neighbours', frequency in Hz, amplitude in deg/s."""

    log_height: float
    frequency_hz: float
    amplitude_dps: float


def spectral_line(cleaned: Cleaned, design: DesignMatrix) -> SpectralLine:
    """The strongest line at rest; all 0 where nothing is long enough."""
    windows = windows_within(cleaned.rate_dps, design.regimes.at_rest)
    if len(windows) < FEW_WINDOWS:
        windows = windows_within(cleaned.rate_dps - design.motion.rate_dps, np.ones(design.samples, bool))
    if not len(windows):
        return SpectralLine(0.0, 0.0, 0.0)
    power = np.median(_spectra(windows), axis=0)[LOWEST:]
    around = median_filter(power, LINE_POINTS, mode="nearest") + LEAST_POWER
    best = int(np.argmax(power / around))
    amplitude = 2.0 * np.sqrt(max(power[best] - around[best], 0.0)) / np.hanning(WINDOW).sum()
    frequency_hz = (best + LOWEST) / (WINDOW * design.period_s)
    return SpectralLine(float(np.log(power[best] / around[best] + 1.0)), frequency_hz, float(amplitude))


def white_dps(cleaned: Cleaned, design: DesignMatrix, dps_per_lsb: float) -> float:
    """Standard deviation of the white part of a sample, deg/s: of slow noise at rest, past any line in it.

    Where steps hide it at rest it is that of slow motion, which scatters, too, but no more than what they hide.
    """
    spreads = spreads_of(cleaned.rate_dps, design.difference_indices)
    windows = windows_within(cleaned.rate_dps, design.regimes.at_rest)
    if len(windows) >= FEW_WINDOWS:
        first, last = (round(share * WINDOW) for share in WHITE_BAND)
        level = float(np.median(_spectra(windows)[:, first:last]) / np.log(2.0))  # an exponential's median to its mean
        at_rest = float(np.sqrt(level / np.sum(np.hanning(WINDOW) ** 2)))
    else:
        rest = [spreads.rest[REST_POINTS.index(points)] for points in WHITE_POINTS]
        at_rest = float(np.sqrt(max(sum(rest) / len(rest), 0.0)))
    hidden_dps = 0.3 * dps_per_lsb  # noise below this share of a count does not show at rest
    if at_rest > hidden_dps:
        return at_rest
    slow = float(np.sqrt(spreads.slow[MOVING_POINTS.index(WHITE_POINTS[0])]))
    # Some of so many samples would differ, were there more noise.
    return min(slow, hidden_dps) if np.count_nonzero(design.regimes.at_rest) >= 32 else slow


def windows_within(values: Floats, allowed: Mask) -> Floats:
    """Half-overlapping windows that lie within the allowed samples, shape (windows, WINDOW)."""
    starts = np.arange(0, len(values) - WINDOW + 1, WINDOW // 2)
    total = np.concatenate([[0], np.cumsum(allowed)])
    inside = starts[total[starts + WINDOW] - total[starts] == WINDOW]
    windows: Floats = values[inside[:, None] + np.arange(WINDOW)]
    return windows


def _spectra(windows: Floats) -> Floats:
    """Power of each, shape (windows, frequencies)."""
    level = windows - windows.mean(axis=1, keepdims=True)
    power: Floats = np.abs(np.fft.rfft(level * np.hanning(WINDOW))) ** 2
    return power
