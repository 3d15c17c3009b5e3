"""Spectra of parts of a recording, by bands: windows that lie within some samples, and their usual power."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from gyrodrift.arrays import Floats, Integers, Mask

Lines = npt.NDArray[np.complex128]

WINDOW_S = 1.0
"""Length of a window."""

LOWEST_HZ, BANDS_PER_OCTAVE = 2.0, 3
"""Lower end of the first band, two lines of a window, and the width of bands above."""

FEW_WINDOWS = 8
"""With fewer windows a spectrum is not known: its standard error would be half of it."""


@dataclass(frozen=True, slots=True)
class Bands:
    """Windows of a recording, and bands of their frequencies.

    first, points, period_s
        First sample of each window, shape (windows,), samples in it, and their distance.
    edges
        First line of each band, and the end of the last, shape (bands + 1,).
    """

    first: Integers
    points: int
    period_s: float
    edges: Integers

    @property
    def is_known(self) -> bool:
        """Whether there are enough windows for a spectrum, and enough samples in a window for a band."""
        return len(self.first) >= FEW_WINDOWS and int(self.edges[-1]) <= self.points // 2 + 1

    @property
    def centers_hz(self) -> Floats:
        """Middle of each band, (bands,)."""
        middle: Floats = (self.edges[1:] + self.edges[:-1] - 1.0) / np.float64(2.0 * self.points * self.period_s)
        return middle

    @property
    def middles(self) -> Floats:
        """Sample in the middle of each window, (windows,)."""
        middle: Floats = self.first + np.float64(0.5 * self.points)
        return middle

    @property
    def window_power(self) -> float:
        """Power by band of white noise whose samples have the variance 1."""
        return float(np.square(np.hanning(self.points)).sum())

    @property
    def freedoms(self) -> Floats:
        """Degrees of freedom of a band in one window, (bands,): neighboring lines of a Hann window are correlated."""
        return np.diff(self.edges).astype(np.float64) + 1.0

    @property
    def relative_error(self) -> Floats:
        """Standard error of `usual_power`, divided by it, (bands,).

        Windows overlap by half, and the median has 2/π of the efficiency of the mean.
        """
        error: Floats = np.sqrt(2.0 / self.freedoms * (np.pi / 2.0) / (0.6 * max(1, len(self.first))))
        return error

    def lines(self, values: Floats) -> Lines:
        """Lines of all windows, (windows, lines)."""
        parts = values[self.first[:, None] + np.arange(self.points)]
        lines: Lines = np.fft.rfft((parts - parts.mean(axis=1, keepdims=True)) * np.hanning(self.points), axis=1)
        return lines

    def mean_power(self, products: Floats) -> Floats:
        """Mean over the lines of each band, (windows, bands), of products of lines."""
        sums = np.add.reduceat(products[:, : self.edges[-1]], self.edges[:-1], axis=1)
        means: Floats = sums / np.diff(self.edges)
        return means

    def usual_power(self, products: Floats) -> Floats:
        """Power by band, (bands,), of products of lines; few windows with a sharp corner do not count.

        The median over windows, divided by that of a chi-square distribution (E. B. Wilson and M. M. Hilferty, 1931).
        """
        power: Floats = np.median(self.mean_power(products), axis=0) / (1.0 - 2.0 / (9.0 * self.freedoms)) ** 3
        return power


def bands_of(inside: Mask, period_s: float) -> Bands:
    """Half-overlapping windows within the samples, (n,), and bands from LOWEST_HZ to half the sample rate."""
    points = round(WINDOW_S / period_s)
    first = np.arange(0, len(inside) - points + 1, max(1, points // 2))
    total = np.concatenate([[0], np.cumsum(inside)])
    first = first[total[first + points] - total[first] == points]
    edges = [round(LOWEST_HZ * WINDOW_S)]
    end = max(points // 2, edges[0] + 1)
    while edges[-1] < end:
        edges.append(max(edges[-1] + 1, round(edges[-1] * 2.0 ** (1.0 / BANDS_PER_OCTAVE))))
    edges[-1] = end
    if len(edges) > 2 and edges[-1] - edges[-2] < edges[-2] - edges[-3]:
        del edges[-2]
    return Bands(first, points, period_s, np.array(edges))
