"""The white noise of a gyro by its rates alone, moved or not, and what a rig says of how it sees the motion."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.recording.rests import samples_in

NOISE_GAIN = 6.0
"""Variance of a second difference of white noise, in variances of that."""

NOISE_MEAN_S, CALM_QUANTILE, CALM_SIGMAS = 0.1, 0.4, 0.5244
"""Over so long rates are averaged where noise is looked for; two fifths of normal numbers are within so many standard
deviations, and most motion is beyond."""

CALMEST_POINTS, CALMEST_QUANTILE, CALMEST_GAIN = 40, 0.1, 12.3
"""A tenth of such stretches are the calmest; the largest mean square of third differences among these is 0.614 of 20
times the variance, where all is white noise."""

BANDS, FOLDS = 512, 20
"""Frequencies up to half the sample rate at which a low-pass is looked at, and multiples of that rate, on either side,
that fold down."""

MIDDLE_QUANTILE, MIDDLE_SIGMAS = 0.7, 1.036
"""Seven tenths of the absolute values of normal numbers are within so many standard deviations."""


class LowPass(Protocol):
    """What the noise of a gyro went through."""

    def power_passed(self, frequency_hz: Floats) -> Floats:
        """What is left of the power at frequencies, of their shape."""
        ...


@dataclass(frozen=True, slots=True)
class GyroModel:
    """What the rig says of how the gyro sees the motion.

    count_dps
        Step that its rates come in, deg/s.
    delay_s
        How much later than the encoder, s.
    hides_rest
        Whether it may read zero though it would scatter: no zero says how much.
    low_passes
        What its noise went through.
    weakens_motion
        Those of them that take from the motion what the rates given are not restored from.
    stated_noise_dps
        White noise of a sample before low-passes, where no recording tells it.
    """

    count_dps: float
    delay_s: float = 0.0
    hides_rest: bool = False
    low_passes: tuple[LowPass, ...] = ()
    weakens_motion: tuple[LowPass, ...] = ()
    stated_noise_dps: float = 0.0

    def motion_gain(self, frequencies_hz: Floats) -> Floats:
        """Amplitude of a motion in the gyro, divided by its own, at frequencies, of their shape."""
        power = [low_pass.power_passed(frequencies_hz) for low_pass in self.weakens_motion]
        gain: Floats = np.sqrt(np.prod(power, axis=0)) * np.ones_like(frequencies_hz)
        return gain

    def power_passed(self, frequencies_hz: Floats, sample_rate_hz: float) -> Floats:
        """Of white noise, at frequencies of the samples, of their shape: what low-passes leave, and what folds down."""
        if not self.low_passes:
            return np.ones_like(frequencies_hz)
        folded_hz = frequencies_hz + sample_rate_hz * np.arange(-FOLDS, FOLDS + 1)[:, None]
        left: Floats = np.prod([one.power_passed(folded_hz) for one in self.low_passes], axis=0).sum(axis=0)
        return left


def noise_dps(rate_dps: Floats, period_s: float, gyro: GyroModel) -> float:
    """Standard deviation of the white noise of a sample: motion widens the one estimate less, a tone the other.

    Behind low-passes it is that of noise as dense as theirs is at the samples, folds and all, where they let it
    through: what they took is no sign of a calm gyro, and what they let through no motion.
    """
    of_means, of_calmest = _noise_of_means_dps(rate_dps, period_s), _noise_of_calmest_dps(rate_dps)
    if not gyro.low_passes:
        return min(of_means, of_calmest)
    turns = (np.arange(BANDS) + 0.5) / (2 * BANDS)  # of a sample
    passed, half = gyro.power_passed(turns / period_s, 1.0 / period_s), np.pi * turns
    points = samples_in(NOISE_MEAN_S, period_s)
    mean, between = np.sin(points * half) / np.sin(half), np.sin(points * half)
    seen_by = np.square(mean) * between**4, np.sin(half) ** 6
    shares = [float((weights * passed).sum() / (weights.sum() * passed[0])) for weights in seen_by]
    return min(of_means / float(np.sqrt(shares[0])), of_calmest / float(np.sqrt(shares[1])))


def _noise_of_means_dps(rate_dps: Floats, period_s: float) -> float:
    """By the calmer part of means: a tone is no noise of what is slower."""
    points = samples_in(NOISE_MEAN_S, period_s)
    count = len(rate_dps) // points
    bends = np.abs(np.diff(rate_dps[: count * points].reshape(count, points).mean(axis=1), 2))
    if not len(bends):
        return 0.0
    found = float(np.quantile(bends, CALM_QUANTILE)) / CALM_SIGMAS
    return found * float(np.sqrt(points / NOISE_GAIN))


def _noise_of_calmest_dps(rate_dps: Floats) -> float:
    """By single samples of the calmest stretches: a motion that never ends is hardly noise within so few of them."""
    squares = np.square(np.diff(rate_dps, 3))
    count = len(squares) // CALMEST_POINTS
    if not count:
        return float("inf")
    stretches = squares[: count * CALMEST_POINTS].reshape(count, CALMEST_POINTS).mean(axis=1)
    return float(np.sqrt(np.quantile(stretches, CALMEST_QUANTILE) / CALMEST_GAIN))


def middle_sigma(values: Floats) -> float:
    """Standard deviation by the middle of normal numbers."""
    return float(np.quantile(np.abs(values), MIDDLE_QUANTILE)) / MIDDLE_SIGMAS
