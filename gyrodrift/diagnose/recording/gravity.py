"""Direction of gravity in the frame of a sensor on a table: a constant part, and a part that repeats once per turn.

The constant part comes from the tilt of the sensor on its table, or from the bias of the accelerometer. The part that
repeats once per turn comes from the tilt of the table. A sensor off the axis also measures a centripetal acceleration,
which is proportional to the square of the rate and is fitted separately.
"""

from math import hypot
from typing import NamedTuple

import numpy as np

from gyrodrift.diagnose.recording.recording import Recording
from gyrodrift.facts.arrays import blocks_of
from gyrodrift.values.arrays import Floats, Mask

LEAST_TURN_DEG = 270.0
"""Least range of the angle that separates the part once per turn from the constant. Chosen: three quarters."""

LEAST_SHARE = 0.5
"""Least share of samples with an acceleration. Chosen."""

STEP_S = 0.2
"""Length of the means that are fitted, s. Chosen: short compared with a turn."""


class Lean(NamedTuple):
    """Tilt of a direction against the yaw axis: x and y of its unit vector in the frame of the sensor."""

    x: float
    y: float

    @property
    def sine(self) -> float:
        """Sine of the angle to the yaw axis."""
        return hypot(self.x, self.y)


NO_LEAN = Lean(0.0, 0.0)


class Gravity(NamedTuple):
    """Constant lean of gravity, and sine of the lean that repeats once per turn (NaN if the table does not turn)."""

    fixed: Lean
    turning: float


def fixed_lean(recording: Recording, angle_deg: Floats, rate_dps: Floats) -> Lean:
    """Constant lean of gravity; no lean without an accelerometer."""
    gravity = gravity_of(recording, angle_deg, rate_dps)
    return NO_LEAN if gravity is None else gravity.fixed


def shows_gravity(recording: Recording) -> bool:
    """Whether at least LEAST_SHARE of the samples have an acceleration."""
    force = recording.accel_mps2
    return force is not None and bool(np.isfinite(force).all(axis=1).mean() >= LEAST_SHARE)


def gravity_of(recording: Recording, angle_deg: Floats, rate_dps: Floats) -> Gravity | None:
    """Constant and turning lean of gravity, by least squares over means of STEP_S; None without an accelerometer.

    angle_deg, rate_dps
        (n,) motion of the table.
    """
    force = recording.accel_mps2
    if force is None or not shows_gravity(recording):
        return None
    block = max(1, round(STEP_S / recording.period_s))
    turns = bool(np.ptp(angle_deg) > LEAST_TURN_DEG)
    force_means, has_force = _force_means(force, block)
    regressors = [_means(column, block)[has_force] for column in _columns(angle_deg, rate_dps, turns=turns)]
    parts = np.linalg.lstsq(np.column_stack(regressors), force_means, rcond=None)[0]
    size = float(np.linalg.norm(parts[0]))
    if size == 0.0:
        return None
    x, y, _ = (parts[0] / size).tolist()
    # Gravity of a tilted table turns in the frame of the sensor, so its amplitudes along x and y are equal.
    turning = float(np.sqrt(0.5 * np.square(parts[1:3, :2]).sum()) / size) if turns else float("nan")
    return Gravity(Lean(x, y), turning)


def _columns(angle_deg: Floats, rate_dps: Floats, *, turns: bool) -> list[Floats]:
    """Regressors of the force, each (n,): a constant, cosine and sine of the angle, and the squared rate, (rad/s)²."""
    turn = np.deg2rad(angle_deg)
    constant: Floats = np.ones(len(turn))
    return [constant, np.cos(turn), np.sin(turn), np.square(np.deg2rad(rate_dps))] if turns else [constant]


def _force_means(force: Floats, block: int) -> tuple[Floats, Mask]:
    """Mean force of every block that has an acceleration, (m, 3), and whether a block has one, (blocks,)."""
    is_known: Mask = np.isfinite(force.sum(axis=1))
    shares = _means(is_known.astype(np.float64), block)
    has_force: Mask = shares > 0.0
    zero_filled: Floats = np.where(is_known[:, None], force, 0.0)
    sums = np.column_stack([_means(zero_filled[:, axis], block) for axis in range(3)])
    return sums[has_force] / shares[has_force, None], has_force


def _means(values: Floats, block: int) -> Floats:
    """(blocks,) means over blocks of so many samples."""
    means: Floats = blocks_of(values, block).mean(axis=1)
    return means
