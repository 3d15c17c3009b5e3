"""Environment: temperature and the time since power-on."""

import numpy as np

from gyrogap.physics.dice import Rng
from gyrogap.physics.motion import Floats
from gyrogap.physics.scene import TableScene

CALIBRATED_C = 25.0
"""Temperature at which data sheets state gain and bias."""


def temp_bias(
    values: Floats, scene: TableScene, rng: Rng, *, slope_dps_per_c: float, curve_dps_per_c2: float
) -> Floats:
    """A parabola."""
    over_c = scene.temp_c - CALIBRATED_C
    return values + slope_dps_per_c * over_c + curve_dps_per_c2 * np.square(over_c)


def temp_scale(values: Floats, scene: TableScene, rng: Rng, *, slope_percent_per_c: float) -> Floats:
    """Gain by temperature."""
    return values + slope_percent_per_c / 100.0 * (scene.temp_c - CALIBRATED_C) * scene.rate_dps


def warmup(
    values: Floats,
    scene: TableScene,
    rng: Rng,
    *,
    amplitude_dps: float,
    fast_s: float,
    slow_s: float,
    fast_share: float,
) -> Floats:
    """Die and package settle one after the other: two exponentials."""
    fast = fast_share * np.exp(-scene.powered_s / fast_s)
    slow = (1.0 - fast_share) * np.exp(-scene.powered_s / slow_s)
    return values + amplitude_dps * (fast + slow)
