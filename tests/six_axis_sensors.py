"""Measurements of a device with three gyro axes and an accelerometer, from its true motion.

The physics is that of scipy rotations on a grid of 1 ms: rates are differences of rotations, accelerations second
differences of positions. No equation of the filter is used.
"""

from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from gyrodrift.values.arrays import Floats

GRID_HZ = 1000
Random = np.random.Generator


class TrueMotion(NamedTuple):
    """Attitude and position of the sensor on the grid, and vibration beside them."""

    attitude: Rotation
    position_m: Floats
    shake_dps: float = 0.0
    shake_mps2: float = 0.0


class Recorded(NamedTuple):
    """A recording: time (n), rates (n, 3), accelerations (n, 3), and the true attitude."""

    t_s: Floats
    gyro_dps: Floats
    accel_mps2: Floats
    attitude: Rotation
    bias_dps: Floats


class SensorErrors(NamedTuple):
    """Errors of a part; scale and misalignment are one matrix for each sensor."""

    rate_hz: int
    bias_dps: Floats
    noise_dps_rthz: float
    gyro_matrix: Floats
    g_sensitivity_dps: Floats
    accel_bias_mps2: Floats
    accel_noise: float
    accel_matrix: Floats
    gyro_lsb_dps: float
    accel_lsb_mps2: float
    gravity_mps2: float
    walk_dps_rts: float


def random_errors(rng: Random) -> SensorErrors:
    """A part out of the range of cheap ones, at one of six sample rates."""
    cross = 0.003 * rng.normal(size=(3, 3))
    return SensorErrors(
        rate_hz=int(rng.choice((50, 100, 100, 125, 200, 500))),
        bias_dps=rng.normal(size=3) * np.exp(rng.uniform(np.log(0.1), np.log(1.5))),
        noise_dps_rthz=float(np.exp(rng.uniform(np.log(0.004), np.log(0.02)))),
        gyro_matrix=np.eye(3) + cross + np.diag(0.007 * rng.normal(size=3)),
        g_sensitivity_dps=rng.normal(size=(3, 3)) * 0.03,
        accel_bias_mps2=rng.normal(size=3) * np.exp(rng.uniform(np.log(0.05), np.log(0.25))),
        accel_noise=float(np.exp(rng.uniform(np.log(0.001), np.log(0.004)))),
        accel_matrix=np.eye(3) + 0.003 * rng.normal(size=(3, 3)),
        gyro_lsb_dps=float(rng.choice((0.0076, 0.0305, 0.061))),
        accel_lsb_mps2=float(rng.choice((0.0006, 0.0024, 0.0048))),
        gravity_mps2=float(rng.uniform(9.78, 9.83)),
        walk_dps_rts=float(np.exp(rng.uniform(np.log(0.0002), np.log(0.002)))),
    )


def perfect(rate_hz: int, bias_dps: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> SensorErrors:
    """A part with a bias alone."""
    zero, eye = np.zeros(3), np.eye(3)
    return SensorErrors(rate_hz, np.array(bias_dps), 0.0, eye, np.zeros((3, 3)), zero, 0.0, eye, 1e-9, 1e-9, 9.81, 0.0)


def measure(motion: TrueMotion, e: SensorErrors, rng: Random) -> Recorded:
    """Measurements of sensors with these errors."""
    rotations, dt = motion.attitude, 1.0 / GRID_HZ
    rates = (rotations[:-1].inv() * rotations[1:]).as_rotvec(degrees=True) / dt
    accel = np.gradient(np.gradient(motion.position_m, dt, axis=0), dt, axis=0)
    force = rotations.inv().apply(accel + np.array((0.0, 0.0, e.gravity_mps2)))
    index = np.arange(GRID_HZ // e.rate_hz, len(rates) - 1, GRID_HZ // e.rate_hz)
    rate, force = 0.5 * (rates[index - 1] + rates[index]), force[index]
    n = len(index)
    rate = rate + motion.shake_dps * shake(n, e.rate_hz, rng)
    force = force + motion.shake_mps2 * shake(n, e.rate_hz, rng)
    bias = e.bias_dps + np.cumsum(rng.normal(size=(n, 3)), axis=0) * e.walk_dps_rts / np.sqrt(e.rate_hz)
    noise = rng.normal(size=(n, 3)) * e.noise_dps_rthz * np.sqrt(0.5 * e.rate_hz) * np.sqrt(2.0)
    gyro = rate @ e.gyro_matrix.T + bias + force / 9.81 @ e.g_sensitivity_dps.T + noise
    accel_noise = rng.normal(size=(n, 3)) * e.accel_noise * np.sqrt(e.rate_hz)
    measured = force @ e.accel_matrix.T + e.accel_bias_mps2 + accel_noise
    return Recorded(
        t_s=np.asarray(index * dt, dtype=np.float64),
        gyro_dps=np.round(gyro / e.gyro_lsb_dps) * e.gyro_lsb_dps,
        accel_mps2=np.round(measured / e.accel_lsb_mps2) * e.accel_lsb_mps2,
        attitude=rotations[index],
        bias_dps=bias,
    )


def shake(n: int, rate_hz: int, rng: Random) -> Floats:
    """Vibration (n, 3) of standard deviation 1: two lines that alias, and noise without slow parts."""
    t = np.arange(n) / rate_hz
    first, second = (np.sin(2.0 * np.pi * rng.uniform(40.0, 160.0) * t + rng.uniform(0.0, 6.0)) for _ in range(2))
    lines = first + second
    noise = np.diff(rng.normal(size=(n + 1, 3)), axis=0) / np.sqrt(2.0)
    share = rng.uniform(0.3, 0.8, size=3)
    return np.asarray(share * lines[:, None] + np.sqrt(1.0 - share**2) * noise)
