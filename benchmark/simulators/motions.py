"""Yaw rates that a turntable or a robot is told to drive, drawn from a seed."""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

STEPS_DPS = (10.0, 30.0, 90.0, 170.0)
TONES_HZ = (0.3, 7.0)
"""Rates of the steps, and the slowest and the fastest tone of the multisine."""


def commanded_dps(seconds: float, rate_hz: float, seed: int, ramp_s: float) -> Floats:
    """Rates at the samples, deg/s, shape (n,): rest, steps of both signs, rest, multisine, slow ramp, rest.

    Shares of the time are fixed; amplitudes (within a fifth), order and phases depend on the seed.
    """
    rng = np.random.default_rng([seed, 77])
    count = round(seconds * rate_hz)
    ends = (np.array([0.1, 0.6, 0.7, 0.87, 0.95, 1.0]) * count).astype(int)
    rates_dps = np.zeros(count)
    rates_dps[ends[0] : ends[1]] = _steps(ends[1] - ends[0], rng)
    rates_dps[ends[2] : ends[3]] = _multisine(ends[3] - ends[2], rate_hz, rng)
    rates_dps[ends[3] : ends[4]] = np.linspace(-3.0, 3.0, ends[4] - ends[3])
    ramp = np.hanning(round(ramp_s * rate_hz) + 2)
    return np.convolve(rates_dps, ramp / ramp.sum(), "same")


def _steps(count: int, rng: np.random.Generator) -> Floats:
    sizes = np.array([sign * size for size in STEPS_DPS for sign in (1.0, -1.0)]) * rng.uniform(0.8, 1.2)
    return np.repeat(rng.permutation(sizes), -(-count // len(sizes)))[:count]


def _multisine(count: int, rate_hz: float, rng: np.random.Generator) -> Floats:
    t_s = np.arange(count) / rate_hz
    tones_hz = np.geomspace(*TONES_HZ, 16)
    phases = rng.uniform(0.0, 2.0 * np.pi, len(tones_hz))
    total = np.sin(2.0 * np.pi * tones_hz * t_s[:, None] + phases).sum(axis=1)
    envelope = np.sin(np.pi * np.arange(count) / count) ** 0.25
    scaled: Floats = 35.0 * rng.uniform(0.8, 1.2) * envelope * total / total.std()
    return scaled
