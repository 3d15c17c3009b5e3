"""Sensor: gain and its faults, the ends of the range, the steps of the output."""

import numpy as np

from gyrogap.physics.dice import Rng
from gyrogap.physics.motion import Floats
from gyrogap.physics.scene import TableScene

FULL_SCALE_DPS = 250.0
BEND = 1.2
"""How far the bent path of the output stage is driven at full scale: more than a little, so that it is no cubic."""


def scale_factor(values: Floats, scene: TableScene, rng: Rng, *, error_percent: float) -> Floats:
    """Gain."""
    return values + error_percent / 100.0 * scene.rate_dps


def scale_asymmetry(values: Floats, scene: TableScene, rng: Rng, *, error_percent: float) -> Floats:
    """Two gains, one for each direction."""
    gains = np.where(scene.rate_dps > 0.0, error_percent, -error_percent) / 100.0
    return values + gains * scene.rate_dps


def nonlinearity(values: Floats, scene: TableScene, rng: Rng, *, error_percent_fs: float) -> Floats:
    """Difference between a straight path and one that ends in a tanh; its error at full scale is stated."""
    share = BEND * scene.rate_dps / FULL_SCALE_DPS
    bent: Floats = (share - np.tanh(share)) / (BEND - np.tanh(BEND))
    return values + error_percent_fs / 100.0 * FULL_SCALE_DPS * bent


def vibration_rectification(values: Floats, scene: TableScene, rng: Rng, *, bias_dps_at_100_dps: float) -> Floats:
    """Bias by the square of the rate."""
    return values + bias_dps_at_100_dps * np.square(scene.rate_dps / 100.0)


def deadband(values: Floats, scene: TableScene, rng: Rng, *, width_dps: float) -> Floats:
    """Small outputs are zero."""
    return values * (np.abs(values) >= width_dps)


def saturation(values: Floats, scene: TableScene, rng: Rng, *, limit_dps: float) -> Floats:
    """The output goes no further."""
    return np.minimum(np.maximum(values, -limit_dps), limit_dps)


def quantization(values: Floats, scene: TableScene, rng: Rng, *, step_dps: float) -> Floats:
    """Steps of the converter, rounded half up."""
    steps: Floats = np.floor(values / step_dps + 0.5) * step_dps
    return steps


def spikes(values: Floats, scene: TableScene, rng: Rng, *, height_dps: float, share_percent: float) -> Floats:
    """Single outliers, up or down, of heights that scatter a little."""
    count = rng.binomial(len(values), share_percent / 100.0)
    places = rng.choice(len(values), count, replace=False)
    disturbed = values.copy()
    disturbed[places] += height_dps * rng.choice([-1.0, 1.0], count) * rng.uniform(0.8, 1.2, count)
    return disturbed


def stale_hold(values: Floats, scene: TableScene, rng: Rng, *, share_percent: float) -> Floats:
    """The reader was faster than the sensor: the register still holds the value before."""
    is_stale = rng.random(len(values)) < share_percent / 100.0
    is_stale[0] = False
    fresh = np.flatnonzero(~is_stale)
    repeated: Floats = values[fresh[np.cumsum(~is_stale) - 1]]
    return repeated
