"""Outside the catalogue: a bias that depends on what the motion was, on the time, or on where temperature came from."""

import numpy as np
from scipy.signal import lfilter

from gyrogap.physics.dice import Rng
from gyrogap.physics.motion import Floats
from gyrogap.physics.scene import TableScene

TURNING_DPS = 1.0
SHARP_DPSS = 350.0


def last_direction(scene: TableScene) -> Floats:
    """Sign of the last motion faster than TURNING_DPS; 0 before the first."""
    is_turning = np.abs(scene.rate_dps) > TURNING_DPS
    latest = np.maximum.accumulate(np.where(is_turning, np.arange(len(is_turning)), -1))
    ways: Floats = np.where(latest < 0, 0.0, np.sign(scene.rate_dps[latest]))
    return ways


def motor_bias(values: Floats, scene: TableScene, rng: Rng, *, step_dps: float) -> Floats:
    """The supply sags while the motor runs."""
    return values + step_dps * scene.motor_on


def direction_memory(values: Floats, scene: TableScene, rng: Rng, *, step_dps: float) -> Floats:
    """The bias stays where the last motion pushed it."""
    return values + step_dps * last_direction(scene)


def stress_bias(values: Floats, scene: TableScene, rng: Rng, *, jump_dps: float, relax_s: float) -> Floats:
    """Sharp reversals strain the board; it relaxes over seconds."""
    reversals = np.diff(last_direction(scene), prepend=0.0) / 2.0
    sharp = np.where(np.abs(scene.acceleration_dpss) > SHARP_DPSS, reversals, 0.0)
    relaxed: Floats = lfilter([jump_dps], [1.0, -np.exp(-1.0 / (relax_s * scene.sample_hz))], sharp)
    return values + relaxed


def slow_cycle(values: Floats, scene: TableScene, rng: Rng, *, amplitude_dps: float, period_s: float) -> Floats:
    """A regulator that hunts, an air conditioner that cycles."""
    return values + amplitude_dps * np.sin(2.0 * np.pi * scene.t_s / period_s + rng.uniform(0.0, 6.28))


def cable_twist(values: Floats, scene: TableScene, rng: Rng, *, dps_per_turn: float) -> Floats:
    """The cable winds up and pulls."""
    return values + dps_per_turn * scene.angle_deg / 360.0


def shake_bias(values: Floats, scene: TableScene, rng: Rng, *, dps_per_dpss: float) -> Floats:
    """Any acceleration, either way, is rectified into bias."""
    smooth = np.exp(-1.0 / (0.1 * scene.sample_hz))
    shaken: Floats = lfilter([1.0 - smooth], [1.0, -smooth], np.abs(scene.acceleration_dpss))
    return values + dps_per_dpss * shaken


def temp_hysteresis(values: Floats, scene: TableScene, rng: Rng, *, dps_per_c: float, width_c: float) -> Floats:
    """The bias lags behind the temperature by a play: another one when it warms than when it cools."""
    every = max(1, round(scene.sample_hz))
    lagging, held_c = [], float(scene.temp_c[0])
    for temp_c in scene.temp_c[::every].tolist():
        held_c = min(max(held_c, temp_c - width_c / 2.0), temp_c + width_c / 2.0)
        lagging.append(held_c - temp_c)
    late_c: Floats = np.interp(scene.t_s, scene.t_s[::every], lagging)
    return values + dps_per_c * late_c


def ripple(
    values: Floats, scene: TableScene, rng: Rng, *, amplitude_dps: float, order: float, phase_deg: float
) -> Floats:
    """The rate that the sensor adds comes back several times per turn."""
    return values + amplitude_dps * np.sin(np.radians(order * scene.angle_deg + phase_deg))
