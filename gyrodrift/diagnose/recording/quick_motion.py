"""Quick motion that a smooth path lacks, as of a robot that trembles, or of a hand: power of the gyro above its noise.

A path with white jerk that is smoothed by cubics describes the motion of turntables. The power of other motion falls
less steeply with frequency, and such a path counts its high frequencies as noise of the gyro. The power of the motion
is estimated from the spectrum of the gyro in motion. Wiener's filter (N. Wiener, 1949) gives the part of the motion
that the gyro determines; the remainder is drawn at random.

No encoder is fine enough to separate this motion from noise. Two rules do:

- The spectrum at rest is noise, including its tones.
- Motion has inertia, so that its power falls with frequency. White noise that is larger in motion stays noise.
"""

from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt
from scipy.fft import next_fast_len
from scipy.optimize import nnls
from scipy.special import expit

from gyrodrift.diagnose.recording.gyro_noise import FOLDS, GyroModel
from gyrodrift.diagnose.recording.order_statistics import median, medians
from gyrodrift.values.arrays import Floats, Integers, Mask

Lines = npt.NDArray[np.complex128]

WINDOW_S = 1.0
"""Length of a window, s. Chosen: its lines are 1 Hz apart."""

LOWEST_HZ, BANDS_PER_OCTAVE = 2.0, 3
"""Lower end of the first band, line 2 of the spectrum of a window, and number of bands per octave. Chosen: the smooth
path follows slower motion, and thirds of an octave are usual."""

FEW_WINDOWS = 8
"""Least number of windows of a spectrum. Chosen: with fewer, its standard error would be half of it."""


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
        power: Floats = medians(self.mean_power(products).T) / (1.0 - 2.0 / (9.0 * self.freedoms)) ** 3
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


LEAST_POWER, LEAST_SHARE = 1e-12, 1e-9
"""Lower bounds of the power of a band, and of the share of noise in it. Chosen: they prevent a division by zero."""

EXCEEDS_SIGMAS, RISES_SIGMAS = 3.0, 2.0
"""Standard errors by which the power of motion must exceed noise, and by which it may exceed that of slower motion.
Chosen: normal errors exceed them in one of 740 and one of 44 bands."""

FALLS = (2.0, 4.0, 8.0)
"""Exponents of the frequency with which the power of motion may fall. Derived: after one, two and four poles."""

GAIN_ERROR = 0.04
"""Share by which the path may be weaker than the gyro without a lack of motion.

Derived: the motion model attributes a scale error of 2 % (`BIAS_SHARE`) to the bias, and this is twice as much.
"""


@dataclass(frozen=True, slots=True)
class QuickMotion:
    """Spectra of a recording in motion, by frequency band. Powers are those of a window, as in `Bands.median_power`.

    tremble_probability
        (n,) probability that a sample is part of quick motion; 0 at rest.
    gyro, motion
        (bands,) power of the gyro, and of the motion in it.
    gain
        (bands,) amplitude of a motion in the gyro, divided by its true amplitude.
    white_dps
        Standard deviation of the white noise of a sample; None if the motion is too short for a spectrum.
    has_rest_spectrum
        Whether the rests are long enough for a spectrum.
    """

    tremble_probability: Floats = field(repr=False)
    bands: Bands = field(repr=False)
    gyro: Floats
    motion: Floats
    gain: Floats
    white_dps: float | None
    has_rest_spectrum: bool

    def completed(self, path: Floats, rate_dps: Floats) -> tuple[Floats, Floats]:
        """Add the motion that the gyro determines to a path; return the path and the power, (bands,), that it lacks.

        path
            (n, 2) angles and rates.
        rate_dps
            (n,) rates of the gyro.
        """
        if not self.motion.any():
            return path, np.zeros_like(self.motion)
        path_lines = self.bands.lines(path[:, 1])
        cross = self.bands.median_power((self.bands.lines(rate_dps) * path_lines.conj()).real)
        path_power = self.bands.median_power(np.square(np.abs(path_lines)))
        share = self._residual_share(cross)
        residual_power = self.gyro - 2.0 * cross + path_power
        power = path_power + 2.0 * share * (cross - path_power) + np.square(share) * residual_power
        path = path + self._filtered(self.tremble_probability * (rate_dps - path[:, 1]), share)
        weakened = np.where(self.motion > 0.0, 1.0 / self.gain - 1.0, 0.0)
        return path + self._filtered(self.tremble_probability * path[:, 1], weakened), self._lacking(power)

    def drawn(self, rng: np.random.Generator, lacking: Floats) -> Floats:
        """(n, 2) random angles and rates with a given power, (bands,)."""
        white = np.sqrt(self.tremble_probability) * rng.standard_normal(len(self.tremble_probability))
        if not lacking.any():  # at a few samples per second, the power of a window is 0
            return np.zeros((len(white), 2))
        return self._filtered(white, np.sqrt(lacking / self.bands.window_power))

    def _residual_share(self, cross: Floats) -> Floats:
        """(bands,) share of the residual to add, so that the sum with the path has the gain of Wiener's filter."""
        wiener = self.motion / self.gyro
        path_gain = np.maximum(cross / self.gyro, 0.0) / (1.0 - GAIN_ERROR)
        lacks = path_gain < wiener
        share: Floats = np.where(lacks, wiener - path_gain, 0.0) / np.where(lacks, 1.0 - path_gain, 1.0)
        return share

    def _lacking(self, power: Floats) -> Floats:
        """(bands,) power of the motion beyond that of the path; at most the variance of Wiener's estimate."""
        variance = self.motion * (1.0 - self.motion / self.gyro)
        lacking: Floats = np.clip(self.motion - power / (1.0 - GAIN_ERROR) ** 2, 0.0, variance) / np.square(self.gain)
        return lacking

    def _filtered(self, values_dps: Floats, gains: Floats) -> Floats:
        """(n, 2) angles and rates of the given rates after a filter with gains by band."""
        if not gains.any():
            return np.zeros((len(values_dps), 2))
        size = next_fast_len(len(values_dps), real=True)
        frequency_hz = np.fft.rfftfreq(size, self.bands.period_s)
        centers_hz = np.concatenate([[0.5 * LOWEST_HZ], self.bands.centers_hz])
        rate_lines = np.fft.rfft(values_dps, size) * np.interp(frequency_hz, centers_hz, np.concatenate([[0.0], gains]))
        angle_lines = rate_lines / (2j * np.pi * np.maximum(frequency_hz, 0.5 * LOWEST_HZ))
        return np.column_stack([np.fft.irfft(lines, size)[: len(values_dps)] for lines in (angle_lines, rate_lines)])


def quick_motion_of(rate_dps: Floats, at_rest: Mask, moves: Mask, period_s: float, gyro: GyroModel) -> QuickMotion:
    """Spectrum of the motion in the rates of a gyro, (n,).

    at_rest, moves
        (n,) whether a sample is at rest, and whether it is in motion with a known rate.
    """
    bands, resting = bands_of(moves, period_s), bands_of(at_rest, period_s)
    passed, gain = gyro.power_passed(bands.centers_hz, 1.0 / period_s), gyro.motion_gain(bands.centers_hz)
    nothing = QuickMotion(np.zeros(len(moves)), bands, np.ones_like(gain), 0.0 * gain, gain, None, resting.is_known)
    if not bands.is_known:
        return nothing
    powers = np.square(np.abs(bands.lines(rate_dps)))
    power = np.maximum(bands.median_power(powers), LEAST_POWER)
    noise, error = passed * _white_power(bands, power, passed, gyro), bands.relative_error * power
    if resting.is_known:
        at_rest_power = resting.median_power(np.square(np.abs(resting.lines(rate_dps))))
        noise, error = np.maximum(noise, at_rest_power), np.hypot(error, resting.relative_error * at_rest_power)
    motion = _falling(power - np.maximum(noise, LEAST_SHARE * power), error)
    window_trembles = _tremble_probability(bands, powers, power - motion, power)
    tremble_probability = np.where(moves, np.interp(np.arange(len(moves)), bands.middles, window_trembles), 0.0)
    white_dps = float(np.sqrt(median(noise / passed) * passed[0] / bands.window_power))
    return replace(nothing, tremble_probability=tremble_probability, gyro=power, motion=motion, white_dps=white_dps)


def _falling(power: Floats, error: Floats) -> Floats:
    """(bands,) power if it is significant, limited to that of the slower bands."""
    significant = np.where(power > EXCEEDS_SIGMAS * error, power, 0.0)
    falling: Floats = np.minimum(significant, np.minimum.accumulate(significant + RISES_SIGMAS * error))
    return falling


def _tremble_probability(bands: Bands, powers: Floats, calm: Floats, trembling: Floats) -> Floats:
    """(windows,) probability that a window has the spectrum `trembling`, (bands,), and not `calm`, (bands,).

    powers
        (windows, lines) powers of the spectral lines.
    """
    log_ratios = bands.mean_power(powers) * (1.0 / calm - 1.0 / trembling) - np.log(trembling / calm)
    probability: Floats = expit(log_ratios @ (0.5 * bands.freedoms))
    return probability


def _white_power(bands: Bands, power: Floats, passed: Floats, gyro: GyroModel) -> float:
    """Power of the noise before low-passes: the part of a spectrum that does not fall, by non-negative least squares.

    Falling parts are folded at half the sample rate. If the whole spectrum may fall, the noise is that of the rig.
    """
    centers_hz = bands.centers_hz
    top = centers_hz >= centers_hz[-1] / 4.0  # two octaves
    folded = 2.0 * np.abs(centers_hz[top] * bands.period_s + np.arange(-FOLDS, FOLDS + 1)[:, None])
    columns = np.column_stack([passed[top], *(np.power(folded, -fall).sum(axis=0) for fall in FALLS)])
    weights = 1.0 / bands.relative_error[top]
    terms = columns * (weights / power[top])[:, None]
    sizes = np.linalg.norm(terms, axis=0)  # of one size, since the iteration may not end otherwise
    parts = nnls(terms / sizes, weights)[0] / sizes
    stated, rounding = (np.square([gyro.stated_noise_dps, gyro.count_dps / 12.0**0.5]) * bands.window_power).tolist()
    return float(max(rounding, min(max(stated + rounding, parts[0]), (power / passed).min())))
