"""The truth of one session: what the table did on the fine grid, and what was the case at each sample."""

from dataclasses import dataclass
from math import ceil, floor

import numpy as np

from gyrogap.physics.dice import Path, plan_dice
from gyrogap.physics.driven import Mover, driven_motion
from gyrogap.physics.motion import Floats, Mask, session_motion
from gyrogap.physics.sessions import SessionPlan

PHYSICS_HZ = 800.0


@dataclass(frozen=True, slots=True)
class TableScene:
    """Arrays of the fine grid have the shape (n · fine,), all others (n,); a sample is every `fine`-th fine point.

    rate_dps
        The true rate at the samples, and once the gyro has looked, the rate that it saw.
    powered_s
        Since power-on, s, at the samples.
    """

    sample_hz: float
    fine: int
    fine_dps: Floats
    fine_deg: Floats
    t_s: Floats
    powered_s: Floats
    rate_dps: Floats
    angle_deg: Floats
    acceleration_dpss: Floats
    temp_c: Floats
    motor_on: Mask

    @property
    def fine_hz(self) -> float:
        """Points of the fine grid in a second."""
        return self.sample_hz * self.fine

    @property
    def fine_s(self) -> Floats:
        """Times of the fine grid."""
        return np.arange(len(self.fine_dps)) / self.fine_hz


def scene_of(
    plan: SessionPlan, sample_hz: float, path: Path, physics_hz: float = PHYSICS_HZ, mover: Mover | None = None
) -> TableScene:
    """Play a session's motion in its surroundings: that of a table, or of what moves the device instead."""
    fine = ceil(physics_hz / sample_hz)
    step_s = 1.0 / (sample_hz * fine)
    samples = floor(plan.seconds * sample_hz)
    dice, seconds = plan_dice((*path, "motion")), samples / sample_hz
    motion = (
        driven_motion(dice, step_s, seconds, mover)
        if mover
        else session_motion(dice, step_s, seconds, plan.still_factor)
    )
    fine_deg = plan.start_deg + _integral(motion.rate_dps, step_s)
    t_s = np.arange(samples) / sample_hz
    return TableScene(
        sample_hz=sample_hz,
        fine=fine,
        fine_dps=motion.rate_dps,
        fine_deg=fine_deg,
        t_s=t_s,
        powered_s=t_s + plan.powered_s,
        rate_dps=motion.rate_dps[::fine],
        angle_deg=fine_deg[::fine],
        acceleration_dpss=np.gradient(motion.rate_dps, step_s)[::fine],
        temp_c=plan.sensor_c(t_s),
        motor_on=motion.motor_on[::fine],
    )


def _integral(rate_dps: Floats, step_s: float) -> Floats:
    """Angle from 0, by the cubic through four neighboring rates: right to the fourth order of the step."""
    wide = np.concatenate([rate_dps[:1], rate_dps, rate_dps[-1:]])
    steps_deg = (-wide[:-3] + 13.0 * wide[1:-2] + 13.0 * wide[2:-1] - wide[3:]) * (step_s / 24.0)
    return np.concatenate([[0.0], np.cumsum(steps_deg)])


def later(values: Floats, points: float) -> Floats:
    """Values of a grid as they were so many points ago, a fraction of a point allowed: Lagrange through four."""
    whole = floor(points)
    u = 1.0 - (points - whole)
    weights = (
        -u * (u - 1.0) * (u - 2.0) / 6.0,
        (u + 1.0) * (u - 1.0) * (u - 2.0) / 2.0,
        -(u + 1.0) * u * (u - 2.0) / 2.0,
        (u + 1.0) * u * (u - 1.0) / 6.0,
    )
    count = len(values)
    padded = np.concatenate([np.full(whole + 2, values[0]), values, values[-1:]])
    out: Floats = sum((w * padded[k : k + count] for k, w in enumerate(weights)), np.zeros(count))
    return out
