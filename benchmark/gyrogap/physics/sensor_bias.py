"""Sensor: a bias that has a life of its own, and one that knows where down is."""

import numpy as np

from gyrogap.physics.dice import Rng
from gyrogap.physics.motion import Floats
from gyrogap.physics.scene import TableScene

LONGER = 6
"""Noise is drawn for a record this many times as long, of which the session is a piece: slower parts are in it too."""


def bias_instability(values: Floats, scene: TableScene, rng: Rng, *, floor_dph: float) -> Floats:
    """1/f noise of the two-sided density B²/(2πf), by shaping a white spectrum."""
    count = len(values)
    points = LONGER * count
    f_hz = np.fft.rfftfreq(points, 1.0 / scene.sample_hz)
    density = np.zeros(len(f_hz))
    density[1:] = (floor_dph / 3600.0) ** 2 / (2.0 * np.pi * f_hz[1:])
    white = rng.standard_normal(len(f_hz)) + 1j * rng.standard_normal(len(f_hz))
    pink = np.fft.irfft(white * np.sqrt(density * points * scene.sample_hz / 2.0), points)
    start = int(rng.integers(0, points - count))
    return values + pink[start : start + count]


def rate_random_walk(values: Floats, scene: TableScene, rng: Rng, *, density_dps_rts: float) -> Floats:
    """A step of the walk with every sample."""
    return values + np.cumsum(rng.normal(0.0, density_dps_rts / np.sqrt(scene.sample_hz), len(values)))


def popcorn(
    values: Floats, scene: TableScene, rng: Rng, *, step_dps: float, dwell_s: float, dwell_shape: float
) -> Floats:
    """Two levels; how long it stays is gamma-distributed: shape 1 forgets, a larger one keeps time."""
    seconds = scene.t_s[-1]
    stays_s = rng.gamma(dwell_shape, dwell_s / dwell_shape, 20 + int(4.0 * seconds / dwell_s))
    jumps_s = np.cumsum(stays_s) - rng.uniform(0.0, dwell_s)
    level = np.searchsorted(jumps_s, scene.t_s) + int(rng.integers(0, 2))
    return values + step_dps * (level % 2 - 0.5)


def g_sensitivity(values: Floats, scene: TableScene, rng: Rng, *, amplitude_dps: float, phase_deg: float) -> Floats:
    """A tilted table carries the sensor through gravity once per turn."""
    return values + amplitude_dps * np.sin(np.radians(scene.angle_deg + phase_deg))
