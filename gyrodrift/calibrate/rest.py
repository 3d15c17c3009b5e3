"""Measurement at rest: bias, noise, smallest step, and a check that the device did not move."""

from dataclasses import dataclass
from math import isnan, nan, sqrt

import numpy as np

from gyrodrift.facts.arrays import blocks_of, smallest_step, white_noise
from gyrodrift.values.arrays import Floats
from gyrodrift.values.errors import CalibrationError
from gyrodrift.values.sample import Sample

SAMPLES_MIN = 20
BLOCK_S = 0.5
BLOCK_SAMPLES_MIN = 5

MOVED_DPS = 0.2
SCATTERS = 8.0
"""The device moved if the mean of a block differs from the median block by more than the larger of both.

The first exceeds the wander of a bias during a rest, the second counts standard errors of white noise.
"""

SHAKEN = 4.0
"""The device was touched if a block scatters by this multiple of the median scatter."""

BIAS_MAX_DPS = 30.0
"""Above the zero rate of all data sheets (MPU-6050: 20 deg/s): the device turns, or the rate has another unit."""


@dataclass(frozen=True, slots=True)
class RestMeasurement:
    """Result of a rest.

    bias_dps, bias_se_dps
        Mean rate and its standard error from the scatter of the blocks, deg/s.
    noise_dps
        Standard deviation of the white noise of one sample, deg/s.
    noise_dps_rthz
        Noise density, deg/s/√Hz (IEEE Std 952): standard deviation over the root of the sample rate.
    dps_per_lsb
        Smallest step of the rate, deg/s; None if all samples are equal.
    period_s
        Sample period, s.
    temp_c
        Mean temperature, °C; NaN without a sensor.
    """

    bias_dps: float
    bias_se_dps: float
    noise_dps: float
    noise_dps_rthz: float
    dps_per_lsb: float | None
    period_s: float
    temp_c: float


def rest_of(samples: list[Sample]) -> RestMeasurement:
    """Measure a rest.

    Raises
    ------
    CalibrationError
        There are too few samples, their time does not increase, or the device moved.
    """
    if len(samples) < SAMPLES_MIN:
        raise CalibrationError(f"{len(samples)} samples during the rest; at least {SAMPLES_MIN} are needed")
    t_s = np.array([sample.t_device_s for sample in samples])
    rate_dps = np.array([sample.rate_dps for sample in samples])
    temp_c = np.array([sample.temp_c for sample in samples])
    period_s = float(np.median(np.diff(t_s)))
    if period_s <= 0.0:
        raise CalibrationError("the time of the device stands still or goes back during the rest")
    size = max(BLOCK_SAMPLES_MIN, round(BLOCK_S / period_s))
    blocks_dps = blocks_of(rate_dps, size)
    if len(blocks_dps) < 2:
        raise CalibrationError(f"the rest of {t_s[-1] - t_s[0]:.1f} s is too short at {1.0 / period_s:.3g} Hz")
    noise_dps = white_noise(rate_dps)
    step_dps = smallest_step(rate_dps)
    _check(blocks_dps, noise_dps, step_dps or 0.0, size * period_s)
    valid_c = temp_c[~np.isnan(temp_c)]
    return RestMeasurement(
        bias_dps=float(rate_dps.mean()),
        bias_se_dps=float(blocks_dps.mean(axis=1).std(ddof=1)) / sqrt(len(blocks_dps)),
        noise_dps=noise_dps,
        noise_dps_rthz=noise_dps * sqrt(period_s),
        dps_per_lsb=step_dps,
        period_s=period_s,
        temp_c=float(valid_c.mean()) if len(valid_c) else nan,
    )


def _check(blocks_dps: Floats, noise_dps: float, step_dps: float, block_s: float) -> None:
    means_dps, scatters_dps = blocks_dps.mean(axis=1), blocks_dps.std(axis=1)
    off_dps = np.abs(means_dps - np.median(means_dps))
    limit_dps = max(MOVED_DPS, SCATTERS * noise_dps / sqrt(blocks_dps.shape[1]))
    worst = int(off_dps.argmax())
    if off_dps[worst] > limit_dps:
        raise CalibrationError(
            f"the device moved after {worst * block_s:.1f} s of rest, by {off_dps[worst]:.2f} deg/s; leave it alone on "
            "a firm table"
        )
    shaken = int(scatters_dps.argmax())
    if scatters_dps[shaken] > SHAKEN * float(np.median(scatters_dps)) + 2.0 * step_dps:
        raise CalibrationError(
            f"the device was shaken after {shaken * block_s:.1f} s of rest; leave it alone on a firm table"
        )
    bias_dps = float(means_dps.mean())
    if abs(bias_dps) > BIAS_MAX_DPS or isnan(bias_dps):
        raise CalibrationError(
            f"the rate at rest is {bias_dps:.1f} deg/s, more than the bias of any gyro: does the device turn, or is "
            "its rate in another unit?"
        )
