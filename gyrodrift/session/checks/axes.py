"""Axes of the accelerometer against those of the gyro: a turn of the sensor turns gravity in its frame.

In the frame of the sensor gravity changes by da/dt = −ω × a. Swapped axes or signs of the accelerometer break this.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import permutations, product

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.session.checks.finding import SessionFinding
from gyrodrift.session.session import Session

STEP_S = 0.25
"""Time over which a change is compared: long against vibration, short against the bias of a gyro."""

LEAST_STEPS = 20
LEAST_TILT = 2.0
"""Sum of the changes of direction, rad, from which the axes are judged."""

DISAGREES, AGREES = 0.7, 0.2
"""Share of the changes that the gyro fails to explain: above the first the axes are wrong, below the second right."""

NAMES = ("ax", "ay", "az")


@dataclass(frozen=True, slots=True)
class SignedAxes:
    """Order and signs of the axes of an accelerometer: axis i of the gyro is `signs[i]` times column `order[i]`."""

    order: tuple[int, ...]
    signs: tuple[float, ...]

    def of(self, vectors: Floats) -> Floats:
        """Vectors in the order of the gyro, shape (n, 3)."""
        swapped: Floats = vectors[:, self.order] * np.array(self.signs)
        return swapped

    @property
    def changes(self) -> int:
        """Number of columns that are renamed or inverted."""
        return sum(self.order[axis] != axis or self.signs[axis] < 0.0 for axis in range(3))

    def __str__(self) -> str:
        columns = ("-" * (sign < 0.0) + NAMES[column] for column, sign in zip(self.order, self.signs, strict=True))
        return ", ".join(columns)


ALL_AXES = [SignedAxes(order, signs) for order in permutations(range(3)) for signs in product((1.0, -1.0), repeat=3)]
"""All 48 orders and signs."""


def axis_findings(session: Session) -> Iterator[SessionFinding]:
    """Finding about swapped or inverted axes of the accelerometer, if another order explains the tilt far better."""
    steps = _steps(session)
    if steps is None:
        return
    residuals = [(_unexplained(axes, *steps), axes.changes, index) for index, axes in enumerate(ALL_AXES)]
    as_is = next(share for share, changes, _ in residuals if changes == 0)
    best = min(share for share, _, _ in residuals)
    if as_is < DISAGREES or best > AGREES:
        return
    *_, index = min((changes, share, index) for share, changes, index in residuals if share < 2.0 * best)
    says = f"the rates explain {1.0 - as_is:.0%} of the tilt of the accelerations, and {1.0 - best:.0%} if x, y, z are"
    yield SessionFinding("accel_axes", f"{says} {ALL_AXES[index]}", "name and invert ax, ay and az so with --columns")


def _steps(session: Session) -> tuple[Floats, Floats, Floats] | None:
    """Changes of the direction of gravity, its mean, and the angles of the gyro in rad, shape (n, 3); None if few."""
    if session.accel_mps2 is None or session.gyro_dps is None:
        return None
    is_whole = np.isfinite(session.accel_mps2).all(axis=1) & np.isfinite(session.gyro_dps).all(axis=1)
    t_s = session.t_device_s[is_whole]
    if len(t_s) < 2 or not (np.diff(t_s) > 0.0).all():
        return None
    length = float(np.median(np.linalg.norm(session.accel_mps2[is_whole], axis=1)))
    size = max(1, round(STEP_S / float(np.median(np.diff(t_s)))))
    count = len(t_s) // size
    if count < LEAST_STEPS or not length:
        return None
    directions = _blocks(session.accel_mps2[is_whole], size) / length
    rates_rads = np.radians(_blocks(session.gyro_dps[is_whole], size))
    step_s = np.diff(t_s[: count * size].reshape(count, size).mean(axis=1))
    changes, means = np.diff(directions, axis=0), 0.5 * (directions[1:] + directions[:-1])
    angles = 0.5 * (rates_rads[1:] + rates_rads[:-1]) * step_s[:, None]
    tilt = float(np.linalg.norm(changes, axis=1).sum())
    return (changes, means, angles) if tilt >= LEAST_TILT else None


def _blocks(values: Floats, size: int) -> Floats:
    """Means of blocks of samples, shape (blocks, 3)."""
    count = len(values) // size
    blocks: Floats = values[: count * size].reshape(count, size, 3).mean(axis=1)
    return blocks


def _unexplained(axes: SignedAxes, changes: Floats, means: Floats, angles: Floats) -> float:
    """Share of the squared changes that the gyro does not explain."""
    rest = axes.of(changes) + np.cross(angles, axes.of(means))
    return float((rest**2).sum() / (changes**2).sum())
