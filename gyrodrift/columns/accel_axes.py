"""Axes of an accelerometer against those of the gyro: a turn of the sensor turns gravity in its frame.

In the frame of the sensor the direction of gravity changes by −∫ω × u. Swapped axes or signs of the accelerometer break
this.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import permutations, product
from math import degrees, hypot, radians, sqrt
from statistics import median
from typing import Any

from gyrodrift.values.sample import Sample
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


TILTS = 24
"""Tilts that are judged: three times those that `doctor` needs, because nobody asked. Chosen."""

HINTS = {
    "csv": "read it with --columns 't_us, gx, gy, gz, {spec}'",
    "text": "in --columns, name the three columns of the acceleration, in the frame of the gyro: {spec}",
}
FIRMWARE_HINT = "in the firmware, send the accelerations in the frame of the gyro; ax, ay, az now are {spec}"


class AccelerationAxesCheck:
    """Compares gravity in windows with the turn between them, until there are enough tilts to judge."""

    def __init__(self, protocol: str) -> None:
        self.is_over = False
        self._hint = HINTS.get(protocol, FIRMWARE_HINT)
        self._turn_rad = (0.0, 0.0, 0.0)
        self._t_s = 0.0
        self._sums = [0.0] * 6
        self._count = 0
        self._index = 0
        self._last: tuple[int, Vector, Vector] | None = None
        self._motions: list[Tilting] = []

    def take(self, samples: list[Sample]) -> dict[str, Any] | None:
        """Fields of the event about other axes, once; None while there is nothing to tell."""
        for sample in samples:
            if sample.inertial is not None and hypot(*sample.inertial[3:]) > 0.0:
                self._add(sample.t_device_s, sample.inertial[:3], sample.inertial[3:])
        if self.is_over or len(self._motions) < TILTS:
            return None
        self.is_over = True
        axes = agreement_of(self._motions)
        return self._fields(axes) if axes.residual > AGREES >= axes.best_residual else None

    def _fields(self, axes: Agreement) -> dict[str, Any]:
        reason = f"gravity turns another way than the gyro says; it fits if {axes.named}"
        return {"reason": reason, "hint": self._hint.format(spec=axes.spec)}

    def _add(self, t_s: float, gyro_dps: Vector, accel_mps2: Vector) -> None:
        index = int(t_s / WINDOW_S)
        if index != self._index:
            self._end_window()
            self._index = index
        dt_s, self._t_s = min(max(t_s - self._t_s, 0.0), WINDOW_S), t_s
        x, y, z = (turn + radians(rate) * dt_s for turn, rate in zip(self._turn_rad, gyro_dps, strict=True))
        self._turn_rad = (x, y, z)
        self._sums = [total + value for total, value in zip(self._sums, (*accel_mps2, x, y, z), strict=True)]
        self._count += 1

    def _end_window(self) -> None:
        """Compare a finished window with the one before."""
        size = hypot(*self._sums[:3])
        if self._count and size > 0.0:
            ux, uy, uz, tx, ty, tz = (
                value / size if i < 3 else value / self._count for i, value in enumerate(self._sums)
            )
            window = (self._index, (ux, uy, uz), (tx, ty, tz))
            if self._last is not None and self._last[0] == self._index - 1:
                self._compare(*self._last[1:], *window[1:])
            self._last = window
        self._sums, self._count = [0.0] * 6, 0

    def _compare(self, before: Vector, turn_before: Vector, up: Vector, turn: Vector) -> None:
        change = _difference(up, before)
        if degrees(hypot(*change)) > TURN_MIN_DEG:
            x, y, z = (0.5 * (a + b) for a, b in zip(up, before, strict=True))
            self._motions.append(Tilting(change, _difference(turn, turn_before), (x, y, z)))


AXIS_TURN_DEG = 45.0
"""Turn about another axis that is told, deg: a hand tilts a device less."""

AXIS_REST_SHARE = 0.1
"""Largest share of this turn about z that is a tilt of the sensor."""


class TurningAxisCheck:
    """Finds an axis that turns while z does not, in three rates without accelerations."""

    def __init__(self) -> None:
        self.is_over = False
        self._windows: list[tuple[float, Vector]] = []
        self._samples: list[Sample] = []

    def take(self, samples: list[Sample]) -> dict[str, Any] | None:
        """Fields of the event about the axis that turns, once; None while there is nothing to tell."""
        for sample in samples:
            if sample.inertial is None:
                continue
            if hypot(*sample.inertial[3:]) > 0.0:  # gravity shows the vertical axis
                self.is_over = True
                return None
            self._samples.append(sample)
            if sample.t_device_s - self._samples[0].t_device_s >= WINDOW_S:
                self._end_window()
                if (fields := self._fields()) is not None or self.is_over:
                    return fields
        return None

    def _fields(self) -> dict[str, Any] | None:
        turns = [self._turn_deg(axis) for axis in range(3)]
        if turns[2] > AXIS_TURN_DEG:
            self.is_over = True
        axis = max(range(3), key=lambda index: turns[index])
        if self.is_over or turns[axis] < AXIS_TURN_DEG or turns[2] > AXIS_REST_SHARE * turns[axis]:
            return None
        self.is_over = True
        name = "xyz"[axis]
        reason = f"the sensor turned by {turns[axis]:.0f} deg about {name}, and by {turns[2]:.0f} deg about z"
        return {"axis": name, "reason": reason, "hint": AXIS_HINT.format(axis=name)}

    def _end_window(self) -> None:
        size = len(self._samples)
        rates = zip(*(sample.inertial[:3] for sample in self._samples if sample.inertial), strict=True)
        x, y, z = (sum(axis) / size for axis in rates)
        self._windows.append((self._samples[-1].t_device_s - self._samples[0].t_device_s, (x, y, z)))
        del self._windows[:-WINDOWS_MAX], self._samples[:-1]

    def _turn_deg(self, axis: int) -> float:
        """Longest turn about an axis, without its bias."""
        bias = median(rates[axis] for _, rates in self._windows)
        total = highest = lowest = 0.0
        for seconds, rates in self._windows:
            total += seconds * (rates[axis] - bias)
            highest, lowest = max(highest, total), min(lowest, total)
        return highest - lowest


WINDOWS_MAX = 60
"""Windows in which a turn is looked for: half a minute, in which a bias hardly changes."""

AXIS_HINT = (
    "if the device turned about its vertical axis, the sensor stands on its side: name that column as the rate, g{axis}"
    " instead of gz, with :- if yaw has the wrong sign"
)


def _difference(after: Vector, before: Vector) -> Vector:
    x, y, z = (a - b for a, b in zip(after, before, strict=True))
    return x, y, z
