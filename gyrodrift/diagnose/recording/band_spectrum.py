"""Power spectrum of some samples of a recording in frequency bands, as a median over windows."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from gyrodrift.values.arrays import Floats, Integers, Mask

Lines = npt.NDArray[np.complex128]

WINDOW_S = 1.0
"""Length of a window."""

LOWEST_HZ, BANDS_PER_OCTAVE = 2.0, 3
"""Lower end of the first band, line 2 of the spectrum of a window, and number of bands per octave."""

FEW_WINDOWS = 8
"""Least number of windows of a spectrum. With fewer, its standard error would be half of it."""


@dataclass(frozen=True, slots=True)
class Bands:
    """Windows of a recording, and frequency bands.

    first
        (windows,) first sample of every window.
    length
        Samples in a window.
    edges
        (bands + 1,) first spectral line of every band, and the end of the last band.
    """

    first: Integers
    length: int
    period_s: float
    edges: Integers

    @property
    def is_known(self) -> bool:
        """Whether there are enough windows for a spectrum, and enough samples in a window for a band."""
        return len(self.first) >= FEW_WINDOWS and int(self.edges[-1]) <= self.length // 2 + 1

    @property
    def centers_hz(self) -> Floats:
        """Middle of each band, (bands,)."""
        middle: Floats = (self.edges[1:] + self.edges[:-1] - 1.0) / np.float64(2.0 * self.length * self.period_s)
        return middle

    @property
    def middles(self) -> Floats:
        """Sample in the middle of each window, (windows,)."""
        middle: Floats = self.first + np.float64(0.5 * self.length)
        return middle

    @property
    def window_power(self) -> float:
        """Power of white noise with variance 1 in a band: the sum of the squared window."""
        return float(np.square(np.hanning(self.length)).sum())

    @property
    def freedoms(self) -> Floats:
        """Degrees of freedom of a band in one window, (bands,): neighboring lines of a Hann window are correlated."""
        return np.diff(self.edges).astype(np.float64) + 1.0

    @property
    def relative_error(self) -> Floats:
        """Standard error of `median_power`, divided by it, (bands,).

        Windows overlap by half, and the median has 2/π of the efficiency of the mean.
        """
        error: Floats = np.sqrt(2.0 / self.freedoms * (np.pi / 2.0) / (0.6 * max(1, len(self.first))))
        return error

    def lines(self, values: Floats) -> Lines:
        """(windows, lines) spectral lines of all windows, by a Hann window and a Fourier transform."""
        parts = values[self.first[:, None] + np.arange(self.length)]
        lines: Lines = np.fft.rfft((parts - parts.mean(axis=1, keepdims=True)) * np.hanning(self.length), axis=1)
        return lines

    def mean_power(self, products: Floats) -> Floats:
        """(windows, bands) mean over the lines of a band.

        products
            (windows, lines) products of spectral lines, such as their squares.
        """
        sums = np.add.reduceat(products[:, : self.edges[-1]], self.edges[:-1], axis=1)
        means: Floats = sums / np.diff(self.edges)
        return means

    def median_power(self, products: Floats) -> Floats:
        """(bands,) power of a band, by a median over windows, which a few windows with a sharp corner do not move.

        The median is divided by that of a chi-square distribution (E. B. Wilson and M. M. Hilferty, 1931).

        products
            (windows, lines) products of spectral lines, such as their squares.
        """
        power: Floats = np.median(self.mean_power(products), axis=0) / (1.0 - 2.0 / (9.0 * self.freedoms)) ** 3
        return power


def bands_of(inside: Mask, period_s: float) -> Bands:
    """Windows that overlap by half, and bands from LOWEST_HZ to half the sample rate.

    inside
        (n,) samples that a window may contain.
    """
    length = round(WINDOW_S / period_s)
    first = np.arange(0, len(inside) - length + 1, max(1, length // 2))
    total = np.concatenate([[0], np.cumsum(inside)])
    first = first[total[first + length] - total[first] == length]
    edges = [round(LOWEST_HZ * WINDOW_S)]
    end = max(length // 2, edges[0] + 1)
    while edges[-1] < end:
        edges.append(max(edges[-1] + 1, round(edges[-1] * 2.0 ** (1.0 / BANDS_PER_OCTAVE))))
    edges[-1] = end
    if len(edges) > 2 and edges[-1] - edges[-2] < edges[-2] - edges[-3]:
        del edges[-2]
    return Bands(first, length, period_s, np.array(edges))
