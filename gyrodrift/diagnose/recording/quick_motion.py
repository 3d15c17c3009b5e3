"""Quick motion that a smooth path lacks: the gyro's power above its noise, as on a robot that trembles or in a hand.

A path driven by white jerk, and smoothed by cubics, holds the motion of turntables. Other motion falls less steeply
with frequency, and such a path takes its tail for noise of the gyro. The spectrum of the gyro in motion tells the power
of the motion. Wiener's filter (N. Wiener, 1949) gives the part of it that the gyro shows; the remainder is drawn.

Two rules tell motion from noise, since no encoder is fine enough for it:

- The spectrum at rest is noise, tones included.
- Motion has inertia, so that its power falls with frequency. White noise that is louder in motion stays noise.
"""

from dataclasses import dataclass, field, replace

import numpy as np
from scipy.fft import next_fast_len
from scipy.optimize import nnls
from scipy.special import expit

from gyrodrift.arrays import Floats, Mask
from gyrodrift.diagnose.recording.band_spectrum import LOWEST_HZ, Bands, bands_of
from gyrodrift.diagnose.recording.gyro_noise import FOLDS, GyroModel

LEAST_POWER, LEAST_SHARE = 1e-12, 1e-9
"""Lower bounds of the power of a band, and of the share of noise in it, against division by zero."""

EXCEEDS_SIGMAS, RISES_SIGMAS = 3.0, 2.0
"""Standard errors by which the power of motion exceeds noise, and by which it may exceed that of slower motion."""

FALLS = (2.0, 4.0, 8.0)
"""Powers of the frequency with which parts of a spectrum fall: motion behind one, two and four poles."""

GAIN_ERROR = 0.04
"""Share by which the path may be weaker than the gyro and lack nothing: a scale factor that is wrong by 2 % and more
bends no motion (`BIAS_SHARE` of the motion model, twice)."""


@dataclass(frozen=True, slots=True)
class QuickMotion:
    """Spectra of a recording in motion, by band, in units of its windows.

    trembles
        Probability that a sample is part of such motion, (n,); 0 at rest.
    gyro, motion
        Power of the gyro, and of the motion in it, (bands,).
    gain
        Amplitude of a motion in the gyro, divided by its own, (bands,).
    white_dps
        Standard deviation of the noise of a sample; None where too little moves.
    knows_rest
        Whether the device rests long enough for a spectrum.
    """

    trembles: Floats = field(repr=False)
    bands: Bands = field(repr=False)
    gyro: Floats
    motion: Floats
    gain: Floats
    white_dps: float | None
    knows_rest: bool

    def completed(self, path: Floats, rate_dps: Floats) -> tuple[Floats, Floats]:
        """The path with the motion that the gyro shows beside it, and the power by band that is still lacking.

        path
            Angles and rates, (n, 2).
        rate_dps
            Rates of the gyro, (n,).
        """
        if not self.motion.any():
            return path, np.zeros_like(self.motion)
        path_lines = self.bands.lines(path[:, 1])
        cross = self.bands.usual_power((self.bands.lines(rate_dps) * path_lines.conj()).real)
        path_power = self.bands.usual_power(np.square(np.abs(path_lines)))
        share = self._residual_share(cross)
        residual_power = self.gyro - 2.0 * cross + path_power
        power = path_power + 2.0 * share * (cross - path_power) + np.square(share) * residual_power
        path = path + self._filtered(self.trembles * (rate_dps - path[:, 1]), share)
        weakened = np.where(self.motion > 0.0, 1.0 / self.gain - 1.0, 0.0)
        return path + self._filtered(self.trembles * path[:, 1], weakened), self._lacking(power)

    def drawn(self, rng: np.random.Generator, lacking: Floats) -> Floats:
        """Random angles and rates, (n, 2), with a power by band."""
        white = np.sqrt(self.trembles) * rng.standard_normal(len(self.trembles))
        if not lacking.any():  # few samples a second make a window without power
            return np.zeros((len(white), 2))
        return self._filtered(white, np.sqrt(lacking / self.bands.window_power))

    def _residual_share(self, cross: Floats) -> Floats:
        """Gain of the residual by band, so that path and residual together have the gain of Wiener's filter."""
        wiener = self.motion / self.gyro
        path_gain = np.maximum(cross / self.gyro, 0.0) / (1.0 - GAIN_ERROR)
        lacks = path_gain < wiener
        share: Floats = np.where(lacks, wiener - path_gain, 0.0) / np.where(lacks, 1.0 - path_gain, 1.0)
        return share

    def _lacking(self, power: Floats) -> Floats:
        """Power of the motion beyond that of the path; at most the variance of Wiener's estimate."""
        variance = self.motion * (1.0 - self.motion / self.gyro)
        lacking: Floats = np.clip(self.motion - power / (1.0 - GAIN_ERROR) ** 2, 0.0, variance) / np.square(self.gain)
        return lacking

    def _filtered(self, values_dps: Floats, gains: Floats) -> Floats:
        """Rates through gains by band, and their angles, (n, 2)."""
        size = next_fast_len(len(values_dps), real=True)
        frequency_hz = np.fft.rfftfreq(size, self.bands.period_s)
        centers_hz = np.concatenate([[0.5 * LOWEST_HZ], self.bands.centers_hz])
        rate_lines = np.fft.rfft(values_dps, size) * np.interp(frequency_hz, centers_hz, np.concatenate([[0.0], gains]))
        angle_lines = rate_lines / (2j * np.pi * np.maximum(frequency_hz, 0.5 * LOWEST_HZ))
        return np.column_stack([np.fft.irfft(lines, size)[: len(values_dps)] for lines in (angle_lines, rate_lines)])


def quick_motion_of(rate_dps: Floats, at_rest: Mask, moves: Mask, period_s: float, gyro: GyroModel) -> QuickMotion:
    """Spectrum of the motion in the rates of a gyro, (n,).

    at_rest, moves
        Samples, (n,), that rest, and that move and are known.
    """
    bands, resting = bands_of(moves, period_s), bands_of(at_rest, period_s)
    passed, gain = gyro.power_passed(bands.centers_hz, 1.0 / period_s), gyro.motion_gain(bands.centers_hz)
    nothing = QuickMotion(np.zeros(len(moves)), bands, np.ones_like(gain), 0.0 * gain, gain, None, resting.is_known)
    if not bands.is_known:
        return nothing
    powers = np.square(np.abs(bands.lines(rate_dps)))
    power = np.maximum(bands.usual_power(powers), LEAST_POWER)
    noise, error = passed * _white_power(bands, power, passed, gyro), bands.relative_error * power
    if resting.is_known:
        at_rest_power = resting.usual_power(np.square(np.abs(resting.lines(rate_dps))))
        noise, error = np.maximum(noise, at_rest_power), np.hypot(error, resting.relative_error * at_rest_power)
    motion = _falling(power - np.maximum(noise, LEAST_SHARE * power), error)
    window_trembles = _tremble_probability(bands, powers, power - motion, power)
    trembles = np.where(moves, np.interp(np.arange(len(moves)), bands.middles, window_trembles), 0.0)
    white_dps = float(np.sqrt(np.median(noise / passed) * passed[0] / bands.window_power))
    return replace(nothing, trembles=trembles, gyro=power, motion=motion, white_dps=white_dps)


def _falling(power: Floats, error: Floats) -> Floats:
    """Power by band where it is significant, and no more than that of slower bands."""
    significant = np.where(power > EXCEEDS_SIGMAS * error, power, 0.0)
    falling: Floats = np.minimum(significant, np.minimum.accumulate(significant + RISES_SIGMAS * error))
    return falling


def _tremble_probability(bands: Bands, powers: Floats, calm: Floats, trembling: Floats) -> Floats:
    """Probability, (windows,), that powers, (windows, lines), have the one of two spectra, (bands,), that trembles."""
    log_ratios = bands.mean_power(powers) * (1.0 / calm - 1.0 / trembling) - np.log(trembling / calm)
    probability: Floats = expit(log_ratios @ (0.5 * bands.freedoms))
    return probability


def _white_power(bands: Bands, power: Floats, passed: Floats, gyro: GyroModel) -> float:
    """Power of the noise before low-passes: the part of a spectrum that does not fall, by non-negative least squares.

    Falling parts are folded at half the sample rate. Where all of the spectrum may fall, the noise is that of the rig.
    """
    centers_hz = bands.centers_hz
    top = centers_hz >= centers_hz[-1] / 4.0  # two octaves
    folded = 2.0 * np.abs(centers_hz[top] * bands.period_s + np.arange(-FOLDS, FOLDS + 1)[:, None])
    columns = np.column_stack([passed[top], *(np.power(folded, -fall).sum(axis=0) for fall in FALLS)])
    weights = 1.0 / bands.relative_error[top]
    parts, _ = nnls(columns * (weights / power[top])[:, None], weights)
    stated, rounding = (np.square([gyro.stated_noise_dps, gyro.count_dps / 12.0**0.5]) * bands.window_power).tolist()
    return float(max(rounding, min(max(stated + rounding, parts[0]), (power / passed).min())))
