"""The step of the attitude filter: samples into a block, and an update of all hypotheses at its end."""

from math import isfinite, nan

from gyrodrift.filters.attitude.block import add_sample, integrals
from gyrodrift.filters.attitude.gap import pass_gap
from gyrodrift.filters.attitude.model import AttitudeCoefficients, AttitudeState, coefficients
from gyrodrift.filters.attitude.spikes import mean_rate
from gyrodrift.filters.attitude.update import begin, end_block
from gyrodrift.filters.attitude.yaw import unwrapped_deg
from gyrodrift.filters.gaps import count_correction, longest_step_s
from gyrodrift.filters.limits import LEAST_STEP_S
from gyrodrift.filters.restlevel.model import COLDEST_C, WARMEST_C
from gyrodrift.values.quaternion import product
from gyrodrift.values.vectors import Vector

__all__ = ["coefficients", "step"]

FASTEST_DPS = 10000.0
"""Rates above this are no measurement, deg/s. Chosen: the widest range of MEMS gyros is 4000 deg/s."""

LARGEST_MPS2 = 4000.0
"""Accelerations above this are no measurement, m/s². Chosen: the widest range of common parts is 400 g."""

CLIPPED_MPS2 = 18.0
"""Equal accelerations in a row above this are the end of a range, m/s². Chosen: the smallest range is 2 g,
19.6 m/s²."""

HOLD_S = 0.1
"""Time for which an acceleration holds, s. Chosen: an accelerometer may be slower than the gyro."""


def step(
    c: AttitudeCoefficients,
    s: AttitudeState,
    t_s: float,
    gx: float,
    gy: float,
    gz: float,
    ax: float = nan,
    ay: float = nan,
    az: float = nan,
    still: float = nan,
    temp_c: float = nan,
) -> bool:
    """Take a sample: rates in deg/s, specific force in m/s² (NaN: missing); False if it is rejected.

    A sample is rejected if time does not increase, except after a restart, or if time or a rate is not finite or out of
    range. `still` is 1 at rest and 0 in motion by an external sensor. `temp_c` is the temperature of the sensor in °C.
    Both are NaN if unknown.
    """
    is_usable = isfinite(t_s) and -FASTEST_DPS < gx < FASTEST_DPS
    is_usable = is_usable and -FASTEST_DPS < gy < FASTEST_DPS and -FASTEST_DPS < gz < FASTEST_DPS
    dt = t_s - s.t_s
    if not is_usable or (s.samples > 0 and dt <= 0.0):
        if not is_usable or not s.watch.has_restarted:
            s.rejected += 1
            return False
        dt, s.accel_t_s = LEAST_STEP_S, t_s  # the clock has restarted too
    before = s.accel_mps2
    accel = usable_accel(s, t_s, ax, ay, az)
    s.correction_deg = 0.0
    if s.samples == 0:
        s.gyro_dps = (gx, gy, gz)
        begin(c, s, accel)
    elif dt > s.watch.longest_step_s:
        held_deg = s.yaw_deg
        pass_gap(c, s, dt, (gx, gy, gz))
        count_correction(s, s.yaw_deg - held_deg)
    else:
        _turn(s, dt, (gx, gy, gz), accel, before)
    s.samples += 1
    s.t_s = t_s
    if COLDEST_C < temp_c < WARMEST_C:
        s.temp_c = temp_c
    if still == still:  # noqa: PLR0124 - not NaN
        hear(s, still)
    if s.block.seconds >= c.block_s - 1e-9 and s.block.samples >= 2:
        before_deg = s.yaw_deg
        s.watch.longest_step_s = longest_step_s(s.block.seconds / s.block.samples)
        end_block(c, s, integrals(s.block))
        count_correction(s, s.yaw_deg - before_deg)
    return True


def usable_accel(s: AttitudeState, t_s: float, ax: float, ay: float, az: float) -> Vector:
    """Acceleration of a sample: the last one for a short time, then NaN. Three zeros are none: noise is missing."""
    size = ax * ax + ay * ay + az * az
    if 0.0 < size < LARGEST_MPS2 * LARGEST_MPS2:
        if size > CLIPPED_MPS2 * CLIPPED_MPS2 and _is_clipped((ax, ay, az), s.accel_mps2):
            s.block.is_clipped = True
        s.accel_mps2, s.accel_t_s = (ax, ay, az), t_s
        return ax, ay, az
    if t_s - s.accel_t_s <= HOLD_S:
        return s.accel_mps2
    s.accel_mps2 = (nan, nan, nan)
    return nan, nan, nan


def _is_clipped(accel: Vector, before: Vector) -> bool:
    return any(abs(a) > CLIPPED_MPS2 and a == b for a, b in zip(accel, before, strict=True))


def hear(s: AttitudeState, still: float) -> None:
    """Count the report of a rest sensor in the block."""
    if still == 1.0:
        s.block.still += 1
    else:
        s.block.moving += 1


def _turn(s: AttitudeState, dt: float, gyro: Vector, accel: Vector, accel_before: Vector) -> None:
    """Turn the block and the output by the mean of this sample and the one before."""
    x, y, z = mean_rate(s, dt, gyro)
    bx, by, bz = accel_before
    if bx != bx:  # noqa: PLR0124 - NaN
        bx, by, bz = accel
    ax, ay, az = accel
    add_sample(s.block, dt, x, y, z, 0.5 * (ax + bx), 0.5 * (ay + by), 0.5 * (az + bz))
    s.q = product(s.start_q, s.block.q)
    s.yaw_deg = unwrapped_deg(s.yaw_deg + (s.heading_rate_dps - s.bias_dps) * dt, s.q)
