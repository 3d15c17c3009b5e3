"""Gravity in the frame of a sensor on a table: a part that stays, and a part that comes once per turn.

The part that stays is the tilt of the sensor on its table, or the bias of the accelerometer. The part that comes once
per turn is the tilt of the table. Neither is the centripetal acceleration of a sensor off the axis, which is
proportional to the square of the rate.
"""

from math import hypot
from typing import NamedTuple

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.recording.recording import Recording

LEAST_TURN_DEG = 270.0
"""Range of the angle from which on a part once per turn is known apart from a constant. Chosen: three quarters."""

LEAST_SHARE = 0.5
"""Share of samples with an acceleration from which on gravity is known. Chosen."""

STEP_S = 0.2
"""Length of the means that are fitted, s: short beside a turn."""


class Lean(NamedTuple):
    """Components of a direction along x and y of the sensor."""

    x: float
    y: float

    @property
    def sine(self) -> float:
        """Sine of the angle to the yaw axis."""
        return hypot(self.x, self.y)


NO_LEAN = Lean(0.0, 0.0)


class Gravity(NamedTuple):
    """Lean of gravity that stays, and sine of the lean that comes once per turn (NaN if the table does not turn)."""

    fixed: Lean
    turning: float


def fixed_lean(recording: Recording, angle_deg: Floats, rate_dps: Floats) -> Lean:
    """Lean of gravity that stays in all directions of the table; none without an accelerometer."""
    gravity = gravity_of(recording, angle_deg, rate_dps)
    return NO_LEAN if gravity is None else gravity.fixed


def shows_gravity(recording: Recording) -> bool:
    """Whether at least LEAST_SHARE of the samples have an acceleration."""
    force = recording.accel_mps2
    return force is not None and bool(np.isfinite(force).all(axis=1).mean() >= LEAST_SHARE)


def gravity_of(recording: Recording, angle_deg: Floats, rate_dps: Floats) -> Gravity | None:
    """Both parts, by least squares over means of STEP_S; None without an accelerometer.

    angle_deg, rate_dps
        (n,) motion of the table.
    """
    force = recording.accel_mps2
    if force is None or not shows_gravity(recording):
        return None
    points = max(1, round(STEP_S / recording.period_s))
    turn = np.deg2rad(angle_deg)
    turns = np.ptp(angle_deg) > LEAST_TURN_DEG
    columns: list[Floats] = [np.ones(len(turn))]
    if turns:
        columns += [np.cos(turn), np.sin(turn), np.square(np.deg2rad(rate_dps))]
    is_known = np.isfinite(force).all(axis=1)
    shares = _means(is_known.astype(np.float64), points)
    known = shares > 0.0
    means = np.column_stack([_means(column, points) for column in columns])[known]
    sums = np.column_stack([_means(np.where(is_known, axis, 0.0), points) for axis in force.T])[known]
    parts = np.linalg.lstsq(means, sums / shares[known, None], rcond=None)[0]
    size = float(np.linalg.norm(parts[0]))
    if size == 0.0:
        return None
    x, y, _ = (parts[0] / size).tolist()
    # A vector that turns against the table has equal amplitudes along x and y.
    turning = float(np.sqrt(0.5 * np.square(parts[1:3, :2]).sum()) / size) if turns else float("nan")
    return Gravity(Lean(x, y), turning)


def _means(values: Floats, points: int) -> Floats:
    count = len(values) // points
    means: Floats = values[: count * points].reshape(count, points).mean(axis=1)
    return means
