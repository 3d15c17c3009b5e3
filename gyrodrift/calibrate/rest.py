"""What a gyro says at rest: bias, noise, smallest step; and whether it rested at all."""

from dataclasses import dataclass
from math import isnan, nan, sqrt

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.describe.arrays import blocks_of, smallest_step
from gyrodrift.errors import CalibrationError
from gyrodrift.sample import Sample

LEAST_SAMPLES = 20
BLOCK_S = 0.5
LEAST_PER_BLOCK = 5

MOVED_DPS = 0.2
SCATTERS = 8.0
"""A block whose mean is off the middle one by more than the larger of both moved: so much wanders no bias in a rest,
and so many standard errors no white noise goes."""

SHAKEN = 4.0
"""A block that scatters by so many times the usual was touched."""

BIAS_MOST_DPS = 30.0
"""More than any data sheet allows at zero rate (MPU-6050: 20 deg/s): the device turns, or the unit is another."""


@dataclass(frozen=True, slots=True)
class RestMeasurement:
    """A rest, as measured.

    bias_dps, bias_se_dps
        Mean rate and its standard error from the scatter of the blocks, deg/s.
    noise_dps
        Standard deviation of the white noise of one sample, deg/s.
    noise_dps_rthz
        The same as a density, deg/s/√Hz (IEEE Std 952): the deviation over the root of the rate.
    dps_per_lsb
        Smallest step of the rate, deg/s; None where all samples are equal.
    period_s
        Distance of two samples, s.
    temp_c
        Mean temperature in °C; NaN without one.
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
        Where there are too few samples, or the device moved.
    """
    if len(samples) < LEAST_SAMPLES:
        raise CalibrationError(f"{len(samples)} samples came in the rest, at least {LEAST_SAMPLES} are needed")
    t_s = np.array([sample.t_device_s for sample in samples])
    rate_dps = np.array([sample.rate_dps for sample in samples])
    temp_c = np.array([sample.temp_c for sample in samples])
    period_s = float(np.median(np.diff(t_s)))
    size = max(LEAST_PER_BLOCK, round(BLOCK_S / period_s))
    blocks_dps = blocks_of(rate_dps, size)
    if len(blocks_dps) < 2:
        raise CalibrationError(f"the rest of {t_s[-1] - t_s[0]:.1f} s is too short at {1.0 / period_s:.3g} samples a s")
    noise_dps = float(np.std(np.diff(rate_dps))) / sqrt(2.0)
    step_dps = smallest_step(rate_dps)
    _check(blocks_dps, noise_dps, step_dps or 0.0, size * period_s)
    known_c = temp_c[~np.isnan(temp_c)]
    return RestMeasurement(
        bias_dps=float(rate_dps.mean()),
        bias_se_dps=float(blocks_dps.mean(axis=1).std(ddof=1)) / sqrt(len(blocks_dps)),
        noise_dps=noise_dps,
        noise_dps_rthz=noise_dps * sqrt(period_s),
        dps_per_lsb=step_dps,
        period_s=period_s,
        temp_c=float(known_c.mean()) if len(known_c) else nan,
    )


def _check(blocks_dps: Floats, noise_dps: float, step_dps: float, block_s: float) -> None:
    means_dps, scatters_dps = blocks_dps.mean(axis=1), blocks_dps.std(axis=1)
    off_dps = np.abs(means_dps - np.median(means_dps))
    most_dps = max(MOVED_DPS, SCATTERS * noise_dps / sqrt(blocks_dps.shape[1]))
    worst = int(off_dps.argmax())
    if off_dps[worst] > most_dps:
        raise CalibrationError(
            f"the device moved at rest: {worst * block_s:.1f} s into it its rate was {off_dps[worst]:.2f} deg/s off; "
            "leave it alone on a firm table"
        )
    shaken = int(scatters_dps.argmax())
    if scatters_dps[shaken] > SHAKEN * float(np.median(scatters_dps)) + 2.0 * step_dps:
        raise CalibrationError(
            f"the device was shaken at rest, {shaken * block_s:.1f} s into it; leave it alone on a firm table"
        )
    bias_dps = float(means_dps.mean())
    if abs(bias_dps) > BIAS_MOST_DPS or isnan(bias_dps):
        raise CalibrationError(
            f"the rate at rest is {bias_dps:.1f} deg/s, more than any gyro's bias: does the device turn, or is its "
            "rate in another unit?"
        )
