"""Outside the catalogue: gains that change with time, rate or power-on, codes that never come, and other noise."""

import numpy as np
from scipy.signal import lfilter

from gyrogap.physics.dice import Rng
from gyrogap.physics.motion import Floats
from gyrogap.physics.scene import TableScene

COGS = 36.0
"""Ripples of the motor's torque in one turn of the table."""


def ageing_gain(values: Floats, scene: TableScene, rng: Rng, *, percent: float) -> Floats:
    """The gain drifts from the beginning of a session to its end."""
    return values + percent / 100.0 * (scene.t_s / float(scene.t_s[-1]) - 0.5) * scene.rate_dps


def turn_on_gain(values: Floats, scene: TableScene, rng: Rng, *, percent: float) -> Floats:
    """Every power-on has a gain of its own."""
    return values + percent / 100.0 * float(rng.uniform(-1.7, 1.7)) * scene.rate_dps


def gain_switch(values: Floats, scene: TableScene, rng: Rng, *, percent: float, above_dps: float) -> Floats:
    """The amplifier changes its range, and the ranges do not agree."""
    return values + percent / 100.0 * np.where(np.abs(scene.rate_dps) > above_dps, scene.rate_dps, 0.0)


def missing_codes(values: Floats, scene: TableScene, rng: Rng, *, gap_dps: float, every_dps: float) -> Floats:
    """A converter that skips: of every stretch the last part reads as what comes before it."""
    start = np.floor(values / every_dps) * every_dps
    codes: Floats = start + np.minimum(values - start, every_dps - gap_dps)
    return codes


def rate_noise(values: Floats, scene: TableScene, rng: Rng, *, dps_per_dps: float) -> Floats:
    """Noise that grows with the rate."""
    return values + dps_per_dps * np.abs(scene.rate_dps) * rng.standard_normal(len(values))


def noise_bursts(
    values: Floats, scene: TableScene, rng: Rng, *, sigma_dps: float, burst_s: float, every_s: float
) -> Floats:
    """A radio nearby talks now and then."""
    count = int(scene.t_s[-1] / every_s * 2.0) + 4
    starts_s = np.cumsum(rng.gamma(2.0, every_s / 2.0, count))
    since_s = scene.t_s - np.concatenate([[-1e9], starts_s])[np.searchsorted(starts_s, scene.t_s)]
    burst: Floats = np.where(since_s < burst_s, sigma_dps, 0.0)
    return values + burst * rng.standard_normal(len(values))


def correlated_noise(values: Floats, scene: TableScene, rng: Rng, *, sigma_dps: float, memory_s: float) -> Floats:
    """Noise that remembers for tenths of a second, as of a badly blocked supply."""
    pole = np.exp(-1.0 / (memory_s * scene.sample_hz))
    drive = sigma_dps * np.sqrt(1.0 - pole**2) * rng.standard_normal(len(values))
    colored: Floats = lfilter([1.0], [1.0, -pole], drive)
    return values + colored


def gliding_tones(values: Floats, scene: TableScene, rng: Rng, *, amplitude_dps: float) -> Floats:
    """The cogs of the motor and their double: two tones that follow its speed, and are silent with it."""
    turn = np.radians(COGS * scene.angle_deg)
    tones = np.sin(turn + rng.uniform(0.0, 6.28)) + 0.6 * np.sin(2.0 * turn + rng.uniform(0.0, 6.28))
    return values + amplitude_dps * scene.motor_on * tones
