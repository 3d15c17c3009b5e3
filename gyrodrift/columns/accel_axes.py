"""Axes of an accelerometer against those of the gyro: a turn of the sensor turns gravity in its frame.

In the frame of the sensor the direction of gravity changes by −∫ω × u. Swapped axes or signs of the accelerometer break
this.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import permutations, product
from math import sqrt
from statistics import median

from gyrodrift.values.vectors import Vector

WINDOW_S = 0.5
"""Length of the windows over which gravity and gyro are compared, s: chosen; hands turn slowly within it."""

TURN_MIN_DEG = 3.0
"""Tilt of a window from which it counts, deg: well above the noise of an accelerometer, about 0.3 deg."""

AGREES = 0.5
"""Residual of the gyro, as a share of the tilt of gravity, below which both agree; without a relation it is above 1."""

Frame = tuple[tuple[int, ...], tuple[float, ...]]
"""Order and signs in which the axes of an acceleration are taken."""


@dataclass(frozen=True, slots=True)
class Agreement:
    """Whether gravity turns as the gyro says.

    residual
        Difference as a share of the tilt, for the axes as they are.
    best
        Axes of the acceleration that fit best, such as `('+x', '+y', '-z')`.
    best_residual
        Their difference.
    """

    residual: float
    best: tuple[str, ...]
    best_residual: float

    @property
    def named(self) -> str:
        """Best axes in words, without those that stay: `ax is ay, ay is −ax`."""
        return ", ".join(
            f"a{axis} is {'−' if best[0] == '-' else ''}a{best[1]}"
            for axis, best in zip("xyz", self.best, strict=True)
            if best != f"+{axis}"
        )

    @property
    def spec(self) -> str:
        """Names in a SPEC for the columns that are ax, ay and az now: `ay:-, ax, az`."""
        names = {
            best[1]: f"a{axis}{':-' if best[0] == '-' else ''}" for axis, best in zip("xyz", self.best, strict=True)
        }
        return ", ".join(names[axis] for axis in "xyz")


@dataclass(frozen=True, slots=True)
class Tilting:
    """Motion from one window to the next, all in the frame of the sensor.

    change
        Change of the direction of gravity.
    rotation
        Rotation by the gyro, rad.
    middle
        Direction of gravity between both windows.
    """

    change: Vector
    rotation: Vector
    middle: Vector

    def residual(self, order: Sequence[int], signs: Sequence[float]) -> float:
        """Value of |change + rotation × middle| / |change| with these axes of the acceleration."""
        (cx, cy, cz), (x, y, z) = (_taken(vector, order, signs) for vector in (self.change, self.middle))
        rx, ry, rz = self.rotation
        dx, dy, dz = cx + ry * z - rz * y, cy + rz * x - rx * z, cz + rx * y - ry * x
        return sqrt((dx * dx + dy * dy + dz * dz) / (cx * cx + cy * cy + cz * cz))


def frames() -> dict[tuple[str, ...], Frame]:
    """Ways to exchange and reverse axes by their names; of a way and its reverse, the one with fewer reversed axes.

    A reversal of all axes at once changes no residual and cannot be found.
    """
    ways = [(order, signs) for order in permutations(range(3)) for signs in product((1.0, -1.0), repeat=3)]
    return {
        tuple(f"{'+' if sign > 0 else '-'}{'xyz'[axis]}" for axis, sign in zip(order, signs, strict=True)): (
            order,
            signs,
        )
        for order, signs in ways
        if sum(signs) > 0.0
    }


def agreement_of(motions: Sequence[Tilting]) -> Agreement:
    """Compare the turn of gravity with the gyro, by the median over the windows."""
    residuals = {
        axes: median(motion.residual(order, signs) for motion in motions) for axes, (order, signs) in frames().items()
    }
    best = min(residuals, key=lambda axes: residuals[axes])
    return Agreement(residuals["+x", "+y", "+z"], best, residuals[best])


def _taken(vector: Vector, order: Sequence[int], signs: Sequence[float]) -> Vector:
    x, y, z = (sign * vector[axis] for axis, sign in zip(order, signs, strict=True))
    return x, y, z
