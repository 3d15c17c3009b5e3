"""Spectrum of the rate at rest: the strongest line, and the level of the white noise."""

from typing import NamedTuple

import numpy as np
from scipy.ndimage import median_filter

from gyrodrift.diagnose.features.design_matrix import DesignMatrix
from gyrodrift.diagnose.features.spreads import MOVING_LENGTHS, REST_LENGTHS, spreads_of
from gyrodrift.diagnose.recording.order_statistics import medians
from gyrodrift.diagnose.recording.outliers import Cleaned
from gyrodrift.values.arrays import Floats, Mask

WINDOW = 256
"""Samples in the window of a spectrum. Chosen: a power of two that fits into rests of a few seconds."""

WINDOW_POWER = float(np.square(np.hanning(WINDOW)).sum())
"""Power of white noise with a variance of 1 in a window."""

FEW_WINDOWS = 8
"""Minimum number of windows at rest. With fewer, a line is also searched in motion, and differences give the noise.
Chosen: medians of fewer spectra scatter too much."""

LINE_NEIGHBORS = 31
"""Number of frequencies around a line whose median is the level of the noise. Chosen: a quarter of all frequencies, so
that a line does not move the median."""

LOWEST = 3
"""Index of the lowest frequency of a line. Lower frequencies contain the leakage of slow changes. Derived: the main
lobe of a Hann window reaches two frequencies."""

WHITE_BAND = (0.02, 0.12)
"""Band of the white noise, as shares of the sample rate. Chosen: above the 1/f noise, and below the cutoff of most
filters."""

LEAST_NOISE_DPS = 1e-4
"""Noise that is added to a level, deg/s, so that a ratio to zero noise stays finite. Chosen: far below the noise of a
gyro."""

WHITE_LENGTHS = (4, 8)
"""Lengths of the means whose scatter gives the white noise if there are too few windows at rest. Chosen: above the
memory of most filters, and below the 1/f noise."""


class SpectralLine(NamedTuple):
    """A spectral line.

    log_height
        log(1 + power / level of the neighboring frequencies).
    frequency_hz, amplitude_dps
        Frequency, Hz, and amplitude, deg/s.
    """

    log_height: float
    frequency_hz: float
    amplitude_dps: float


def spectral_line(cleaned: Cleaned, design: DesignMatrix) -> SpectralLine:
    """Strongest line at rest; in the difference to the motion if there is little rest; zeros without a window."""
    windows = windows_within(cleaned.rate_dps, design.regimes.at_rest)
    if len(windows) < FEW_WINDOWS:
        windows = windows_within(cleaned.rate_dps - design.motion.rate_dps, np.ones(design.samples, bool))
    if not len(windows):
        return SpectralLine(0.0, 0.0, 0.0)
    power = medians(power_spectra(windows).T)[LOWEST:]
    around = median_filter(power, LINE_NEIGHBORS, mode="nearest") + LEAST_NOISE_DPS**2 * WINDOW_POWER
    best = int(np.argmax(power / around))
    amplitude = 2.0 * np.sqrt(max(power[best] - around[best], 0.0)) / np.hanning(WINDOW).sum()
    frequency_hz = (best + LOWEST) / (WINDOW * design.period_s)
    return SpectralLine(float(np.log(power[best] / around[best] + 1.0)), frequency_hz, float(amplitude))


def white_dps(cleaned: Cleaned, design: DesignMatrix, dps_per_lsb: float) -> float:
    """Standard deviation of the white noise of a sample, deg/s, from the spectrum at rest.

    The median over frequencies ignores lines. If steps of the rate hide the noise at rest, slow motion gives it. Motion
    scatters, too, so the value is limited to what the steps can hide.
    """
    spreads = spreads_of(cleaned.rate_dps, design.difference_indices)
    windows = windows_within(cleaned.rate_dps, design.regimes.at_rest)
    if len(windows) >= FEW_WINDOWS:
        first, last = (round(share * WINDOW) for share in WHITE_BAND)
        # The median of an exponential distribution is ln 2 of its mean.
        level = float(np.median(power_spectra(windows)[:, first:last]) / np.log(2.0))
        at_rest = float(np.sqrt(level / WINDOW_POWER))
    else:
        rest = [spreads.rest[REST_LENGTHS.index(length)] for length in WHITE_LENGTHS]
        at_rest = float(np.sqrt(max(sum(rest) / len(rest), 0.0)))
    hidden_dps = 0.3 * dps_per_lsb  # noise below this share of a count does not show at rest
    if at_rest > hidden_dps:
        return at_rest
    slow = float(np.sqrt(spreads.slow[MOVING_LENGTHS.index(WHITE_LENGTHS[0])]))
    # With larger noise, some of 32 samples at rest would differ.
    return min(slow, hidden_dps) if np.count_nonzero(design.regimes.at_rest) >= 32 else slow


def windows_within(values: Floats, allowed: Mask) -> Floats:
    """Windows with an overlap of one half that contain allowed samples only, shape (windows, WINDOW)."""
    starts = np.arange(0, len(values) - WINDOW + 1, WINDOW // 2)
    total = np.concatenate([[0], np.cumsum(allowed)])
    inside = starts[total[starts + WINDOW] - total[starts] == WINDOW]
    windows: Floats = values[inside[:, None] + np.arange(WINDOW)]
    return windows


def power_spectra(windows: Floats) -> Floats:
    """Power spectra of windows, shape (windows, frequencies)."""
    centered = windows - windows.mean(axis=1, keepdims=True)
    power: Floats = np.abs(np.fft.rfft(centered * np.hanning(WINDOW))) ** 2
    return power
