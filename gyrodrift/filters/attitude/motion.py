"""Properties of the motion that say how far its accelerations and tilts can be trusted."""

from dataclasses import dataclass, field

import numpy as np

from gyrodrift.values.arrays import Floats
from gyrodrift.values.vectors import Vector


@dataclass(slots=True)
class MotionMemory:
    """Averages over the last seconds.

    level_s
        Time with an acceleration so far, s, up to the end of levelling.
    level_force
        Integral of the specific force in that time, in the earth frame, m/s.
    mean_force
        Mean specific force in the earth frame, m/s².
    slow_velocity, speed_var
        Slow part (3) of the velocity, m/s, and its mean square, m²/s².
    mean_up
        Mean vertical (3) in the sensor.
    rest_up, moved_var
        Vertical (3) in the sensor at the last rest, and the largest squared distance from it since then.
    """

    level_s: float = 0.0
    level_force: Vector = (0.0, 0.0, 0.0)
    mean_force: Vector = (0.0, 0.0, 9.81)
    slow_velocity: Floats = field(default_factory=lambda: np.zeros(3))
    speed_var: float = 0.0
    mean_up: Floats = field(default_factory=lambda: np.zeros(3))
    rest_up: Floats = field(default_factory=lambda: np.zeros(3))
    moved_var: float = 0.0
