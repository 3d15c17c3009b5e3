"""How much later the gyro speaks than the encoder, by the correlation of their smoothed rates."""

from typing import NamedTuple

import numpy as np
from scipy.fft import next_fast_len

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.recording.smoothing import gaussian

SMOOTH_S, SMOOTH_MOST_S, COUNTS = 0.1, 1.0, 3.0
"""Standard deviation of the Gaussian through which both rates are compared; up to the larger one, so that a coarse
encoder counts so often within it."""

LAG_MOST_S = 5.0
"""Lags are looked for up to this."""

EVEN = 0.03
"""Of its mean: a rate that changes by less, in standard deviations, is an even spin, alike at any lag."""


class SmoothedRates(NamedTuple):
    """Rates of gyro and encoder through one Gaussian, about their means, deg/s, shape (n,) each; and these."""

    gyro_dps: Floats
    encoder_dps: Floats
    gyro_mean_dps: float
    encoder_mean_dps: float

    @property
    def is_even(self) -> bool:
        """Whether the encoder shows an even spin."""
        return float(np.std(self.encoder_dps)) < EVEN * abs(self.encoder_mean_dps)

    def with_gyro_times(self, factor: float) -> "SmoothedRates":
        """The same with the rate of the gyro multiplied."""
        return self._replace(gyro_dps=self.gyro_dps * factor, gyro_mean_dps=self.gyro_mean_dps * factor)

    @property
    def gain(self) -> float:
        """Of the gyro over the encoder, by least squares; of an even spin by the means, bias in them."""
        if self.is_even:
            return self.gyro_mean_dps / self.encoder_mean_dps
        return float(self.gyro_dps @ self.encoder_dps / (self.encoder_dps @ self.encoder_dps))


class Lag(NamedTuple):
    """Samples by which the gyro comes later, whole and to a fraction, and the correlation there."""

    samples: int
    fine: float
    likeness: float


def smoothed_rates(rate_dps: Floats, encoder_deg: Floats, count_deg: float, period_s: float) -> SmoothedRates:
    """Of values without holes; `count_deg` is the step of the encoder."""
    usual_dps = float(np.std(rate_dps))
    longest = COUNTS * count_deg / usual_dps if usual_dps > 0.0 else SMOOTH_S
    samples = float(np.clip(longest, SMOOTH_S, SMOOTH_MOST_S)) / period_s
    gyro_dps, encoder_dps = (gaussian(each, samples) for each in (rate_dps, np.gradient(encoder_deg, period_s)))
    means_dps = float(gyro_dps.mean()), float(encoder_dps.mean())
    return SmoothedRates(gyro_dps - means_dps[0], encoder_dps - means_dps[1], *means_dps)


def best_lag(rates: SmoothedRates, period_s: float) -> Lag:
    """Where the rates are most alike, or most unlike; 0 where one of them never changes, and in an even spin."""
    gyro_dps, encoder_dps, *_ = rates
    most = min(round(LAG_MOST_S / period_s), len(gyro_dps) // 4)
    norm = float(np.linalg.norm(gyro_dps) * np.linalg.norm(encoder_dps))
    if norm == 0.0 or most < 1:
        return Lag(0, 0.0, 0.0)
    if rates.is_even:
        return Lag(0, 0.0, float(np.sign(rates.gain)))
    # What a transform of this size wraps round comes at lags that are not looked at.
    size = next_fast_len(len(gyro_dps) + most, real=True)
    product = np.fft.irfft(np.fft.rfft(gyro_dps, size) * np.conj(np.fft.rfft(encoder_dps, size)), size)
    lags = np.arange(-most, most + 1)
    by_lag = product[lags] / norm
    best = int(np.argmax(np.abs(by_lag)))
    samples = int(lags[best])
    return Lag(samples, samples + _further(rates, samples), float(by_lag[best]))


def _further(rates: SmoothedRates, samples: int) -> float:
    """By how much more than so many samples the gyro is late, of what both have: by its part in how the other changes.

    Beyond their ends the rates are unknown, so that the peak of the correlation lies too near to 0.
    """
    later, earlier = max(samples, 0), max(-samples, 0)
    gyro_dps = rates.gyro_dps[later : len(rates.gyro_dps) - earlier]
    encoder_dps = rates.encoder_dps[earlier : len(rates.encoder_dps) - later]
    columns = np.column_stack([encoder_dps, np.gradient(encoder_dps), np.ones(len(encoder_dps))])
    gain, change, _ = np.linalg.lstsq(columns.T @ columns, columns.T @ gyro_dps)[0]
    return 0.0 if gain == 0.0 else float(np.clip(-change / gain, -1.0, 1.0))
