"""Gravity in the frame of a sensor on a table: a part that stays, and a part that comes once per turn.

The part that stays is the tilt of the sensor on its table, or the bias of the accelerometer. The part that comes once
per turn is the tilt of the table. Neither is the centripetal acceleration of a sensor off the axis, which is
proportional to the square of the rate.
"""

from math import hypot
from typing import NamedTuple

import numpy as np

from gyrodrift.arrays import Floats, Mask
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
    turns = bool(np.ptp(angle_deg) > LEAST_TURN_DEG)
    force_means, has_force = _force_means(force, points)
    regressors = [_means(column, points)[has_force] for column in _columns(angle_deg, rate_dps, turns=turns)]
    parts = np.linalg.lstsq(np.column_stack(regressors), force_means, rcond=None)[0]
    size = float(np.linalg.norm(parts[0]))
    if size == 0.0:
        return None
    x, y, _ = (parts[0] / size).tolist()
    # A vector that turns against the table has equal amplitudes along x and y.
    turning = float(np.sqrt(0.5 * np.square(parts[1:3, :2]).sum()) / size) if turns else float("nan")
    return Gravity(Lean(x, y), turning)


def _columns(angle_deg: Floats, rate_dps: Floats, *, turns: bool) -> list[Floats]:
    """Parts of the force, (n,) each: a constant, cosine and sine of the angle, and the centripetal acceleration."""
    turn = np.deg2rad(angle_deg)
    constant: Floats = np.ones(len(turn))
    return [constant, np.cos(turn), np.sin(turn), np.square(np.deg2rad(rate_dps))] if turns else [constant]


def _force_means(force: Floats, points: int) -> tuple[Floats, Mask]:
    """(some, 3) means of the samples with an acceleration, and (blocks,) whether a block has any."""
    is_known: Mask = np.isfinite(force.sum(axis=1))
    shares = _means(is_known.astype(np.float64), points)
    has_force: Mask = shares > 0.0
    zero_filled: Floats = np.where(is_known[:, None], force, 0.0)
    sums = np.column_stack([_means(zero_filled[:, axis], points) for axis in range(3)])
    return sums[has_force] / shares[has_force, None], has_force


def _means(values: Floats, points: int) -> Floats:
    count = len(values) // points
    means: Floats = values[: count * points].reshape(count, points).mean(axis=1)
    return means
