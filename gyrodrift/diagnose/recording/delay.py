"""Delay of the gyro against the encoder, by the correlation of their smoothed rates."""

from typing import NamedTuple

import numpy as np
from scipy.fft import next_fast_len

from gyrodrift.diagnose.recording.smoothing import gaussian
from gyrodrift.values.arrays import Floats

SMOOTH_S, SMOOTH_MOST_S, COUNTS = 0.1, 1.0, 3.0
"""Least and largest standard deviation of the Gaussian that smooths both rates, s. Between them it is the time in which
the encoder passes so many counts at the usual rate. Chosen: a few counts smooth the steps of the encoder."""

LAG_MOST_S = 5.0
"""Largest delay that is tried, either way, s. Chosen: twenty times LAG_S of the checks, for files that were joined
wrongly."""

STEADY_SHARE = 0.03
"""Standard deviation of the rate as a share of its mean, below which the motion is a steady spin. Chosen: so small a
change of the rate shows no delay."""


class SmoothedRates(NamedTuple):
    """Smoothed rates of gyro and encoder minus their means, shape (n,), and these means, deg/s."""

    gyro_dps: Floats
    encoder_dps: Floats
    gyro_mean_dps: float
    encoder_mean_dps: float

    @property
    def is_steady(self) -> bool:
        """Whether the motion is a steady spin by the encoder."""
        return float(np.std(self.encoder_dps)) < STEADY_SHARE * abs(self.encoder_mean_dps)

    def with_gyro_times(self, factor: float) -> "SmoothedRates":
        """Rates with that of the gyro multiplied by a factor."""
        return self._replace(gyro_dps=self.gyro_dps * factor, gyro_mean_dps=self.gyro_mean_dps * factor)

    @property
    def gain(self) -> float:
        """Gain of the gyro against the encoder, by least squares.

        In a steady spin it is the ratio of the means, which includes the bias.
        """
        if self.is_steady:
            return self.gyro_mean_dps / self.encoder_mean_dps
        return float(self.gyro_dps @ self.encoder_dps / (self.encoder_dps @ self.encoder_dps))


class Lag(NamedTuple):
    """Delay of the gyro against the encoder.

    samples
        Delay in whole samples.
    delay
        Delay in samples, to a fraction.
    correlation
        Correlation of the rates at `samples`, -1 to 1.
    """

    samples: int
    delay: float
    correlation: float


def smoothed_rates(rate_dps: Floats, encoder_deg: Floats, count_deg: float, period_s: float) -> SmoothedRates:
    """Smoothed rates of gyro and encoder.

    rate_dps, encoder_deg
        (n,) rates and angles without gaps.
    count_deg
        Step of the encoder.
    """
    usual_dps = float(np.std(rate_dps))
    longest = COUNTS * count_deg / usual_dps if usual_dps > 0.0 else SMOOTH_S
    samples = float(np.clip(longest, SMOOTH_S, SMOOTH_MOST_S)) / period_s
    gyro_dps, encoder_dps = (gaussian(values, samples) for values in (rate_dps, np.gradient(encoder_deg, period_s)))
    means_dps = float(gyro_dps.mean()), float(encoder_dps.mean())
    return SmoothedRates(gyro_dps - means_dps[0], encoder_dps - means_dps[1], *means_dps)


def best_lag(rates: SmoothedRates, period_s: float) -> Lag:
    """Delay at which the correlation of the rates has its largest absolute value.

    It is 0 in a steady spin, and if one of the rates is constant.
    """
    gyro_dps, encoder_dps, *_ = rates
    most = min(round(LAG_MOST_S / period_s), len(gyro_dps) // 4)
    norm = float(np.linalg.norm(gyro_dps) * np.linalg.norm(encoder_dps))
    if norm == 0.0 or most < 1:
        return Lag(0, 0.0, 0.0)
    if rates.is_steady:
        return Lag(0, 0.0, float(np.sign(rates.gain)))
    # A transform of this size wraps products around to lags beyond `most` only.
    size = next_fast_len(len(gyro_dps) + most, real=True)
    product = np.fft.irfft(np.fft.rfft(gyro_dps, size) * np.conj(np.fft.rfft(encoder_dps, size)), size)
    lags = np.arange(-most, most + 1)
    by_lag = product[lags] / norm
    best = int(np.argmax(np.abs(by_lag)))
    samples = int(lags[best])
    return Lag(samples, samples + _fraction(rates, samples), float(by_lag[best]))


def _fraction(rates: SmoothedRates, samples: int) -> float:
    """Delay beyond a whole number of samples, -1 to 1, by linear regression over the samples that both rates have.

    The regressors are the rate of the encoder and its slope. The peak of the correlation is not interpolated: the
    rates are unknown beyond their ends, which moves the peak towards 0.
    """
    later, earlier = max(samples, 0), max(-samples, 0)
    gyro_dps = rates.gyro_dps[later : len(rates.gyro_dps) - earlier]
    encoder_dps = rates.encoder_dps[earlier : len(rates.encoder_dps) - later]
    columns = np.column_stack([encoder_dps, np.gradient(encoder_dps), np.ones(len(encoder_dps))])
    gain, change, _ = np.linalg.lstsq(columns.T @ columns, columns.T @ gyro_dps)[0]
    return 0.0 if gain == 0.0 else float(np.clip(-change / gain, -1.0, 1.0))
