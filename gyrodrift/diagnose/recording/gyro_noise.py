"""White noise of a gyro, estimated from its rates at rest or in motion, and the model of a gyro that a rig states."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from gyrodrift.diagnose.recording.order_statistics import quantiles
from gyrodrift.facts.arrays import blocks_of, samples_in
from gyrodrift.values.arrays import Floats

NOISE_GAIN = 6.0
"""Variance of a second difference of white noise, divided by the variance of the noise. Derived: 1 + 4 + 1."""

NOISE_MEAN_S, CALM_QUANTILE, CALM_SIGMAS = 0.1, 0.4, 0.5244
"""Time over which rates are averaged, s; the quantile of their absolute second differences that gives the noise; and
this quantile of absolute normal numbers, in standard deviations. Chosen: most motion is above the quantile. Derived:
CALM_SIGMAS is Φ⁻¹(0.7)."""

CALMEST_SAMPLES, CALMEST_QUANTILE, CALMEST_GAIN = 40, 0.1, 12.1
"""Samples in a stretch; the quantile of the mean squared third differences over stretches that gives the noise; and
this quantile of white noise, in variances. Computed: 24 million normal numbers give 12.13 ± 0.01. Chosen: the lowest
tenth has the least motion."""

BANDS, FOLDS = 512, 20
"""Number of frequencies up to half the sample rate, and number of multiples of the sample rate on either side, whose
power folds down. Chosen: beyond them, a first-order low-pass at a tenth of the sample rate passes 0.1 %."""

MIDDLE_QUANTILE, MIDDLE_SIGMAS = 0.7, 1.036
"""Quantile of absolute values, and its value for a normal distribution, in standard deviations. Chosen: outliers hardly
move it. Derived: MIDDLE_SIGMAS is Φ⁻¹(0.85)."""


class LowPass(Protocol):
    """Low-pass that the noise of a gyro has passed."""

    def power_passed(self, frequency_hz: Floats) -> Floats:
        """Share of the power that passes, in the shape of the frequencies."""
        ...


@dataclass(frozen=True, slots=True)
class GyroModel:
    """Properties of a gyro that the rig states.

    count_dps
        Step of its rates, deg/s.
    delay_s
        Delay against the encoder, s.
    hides_rest
        Whether the gyro has a dead band: rates of 0 do not show its noise.
    low_passes
        Low-passes that its noise has passed.
    unrestored_low_passes
        Low-passes whose effect on the motion has not been removed from the rates.
    stated_noise_dps
        White noise of a sample before the low-passes, for recordings that do not determine it.
    """

    count_dps: float
    delay_s: float = 0.0
    hides_rest: bool = False
    low_passes: tuple[LowPass, ...] = ()
    unrestored_low_passes: tuple[LowPass, ...] = ()
    stated_noise_dps: float = 0.0

    def motion_gain(self, frequencies_hz: Floats) -> Floats:
        """Amplitude of a motion in the rates, divided by its true amplitude, in the shape of the frequencies."""
        power = [low_pass.power_passed(frequencies_hz) for low_pass in self.unrestored_low_passes]
        gain: Floats = np.sqrt(np.prod(power, axis=0)) * np.ones_like(frequencies_hz)
        return gain

    def power_passed(self, frequencies_hz: Floats, sample_rate_hz: float) -> Floats:
        """Power density of white noise of density 1 after the low-passes, in the shape of the frequencies.

        It includes the power that sampling folds down.
        """
        if not self.low_passes:
            return np.ones_like(frequencies_hz)
        folded_hz = frequencies_hz + sample_rate_hz * np.arange(-FOLDS, FOLDS + 1)[:, None]
        passed: Floats = np.prod([own.power_passed(folded_hz) for own in self.low_passes], axis=0).sum(axis=0)
        return passed


def noise_dps(rate_dps: Floats, period_s: float, gyro: GyroModel) -> float:
    """Standard deviation of the white noise of a sample: the smaller of two estimates.

    The estimate from means is insensitive to tones, the estimate from calm stretches to motion that never ends. With
    low-passes, the result is that of white noise with the density of the lowest frequency, folded power included.
    """
    of_means, of_calmest = _noise_of_means_dps(rate_dps, period_s), _noise_of_calmest_dps(rate_dps)
    if not gyro.low_passes:
        return min(of_means, of_calmest)
    cycles = (np.arange(BANDS) + 0.5) / (2 * BANDS)  # per sample
    passed, half = gyro.power_passed(cycles / period_s, 1.0 / period_s), np.pi * cycles
    samples = samples_in(NOISE_MEAN_S, period_s)
    mean, between = np.sin(samples * half) / np.sin(half), np.sin(samples * half)
    power_gains = np.square(mean) * between**4, np.sin(half) ** 6  # of both estimates, not normalized
    shares = [float((gains * passed).sum() / (gains.sum() * passed[0])) for gains in power_gains]
    return min(of_means / float(np.sqrt(shares[0])), of_calmest / float(np.sqrt(shares[1])))


def _noise_of_means_dps(rate_dps: Floats, period_s: float) -> float:
    """White noise of a sample, from the smaller second differences of means. A quick tone averages out in means."""
    samples = samples_in(NOISE_MEAN_S, period_s)
    bends = np.abs(np.diff(blocks_of(rate_dps, samples).mean(axis=1), 2))
    if not len(bends):
        return 0.0
    bend_sigma_dps = float(quantiles(bends, CALM_QUANTILE)) / CALM_SIGMAS
    return bend_sigma_dps * float(np.sqrt(samples / NOISE_GAIN))


def _noise_of_calmest_dps(rate_dps: Floats) -> float:
    """White noise of a sample, from third differences of samples in the calmest stretches.

    Over four successive samples, even a motion that never ends is nearly a parabola, which has no third difference.
    """
    stretches = blocks_of(np.square(np.diff(rate_dps, 3)), CALMEST_SAMPLES).mean(axis=1)
    if not len(stretches):
        return float("inf")
    return float(np.sqrt(quantiles(stretches, CALMEST_QUANTILE) / CALMEST_GAIN))


def middle_sigma(values: Floats) -> float:
    """Standard deviation of normal values, from a quantile of their absolute values that outliers do not move."""
    return float(quantiles(np.abs(values), MIDDLE_QUANTILE)) / MIDDLE_SIGMAS
