"""Check of the axes of the accelerometer in the first minutes of a stream, by its tilts."""

from math import degrees, hypot, radians
from typing import Any

from gyrodrift.columns.accel_axes import AGREES, TURN_MIN_DEG, WINDOW_S, Agreement, Tilting, agreement_of
from gyrodrift.values.sample import Sample
from gyrodrift.values.vectors import Vector

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


def _difference(after: Vector, before: Vector) -> Vector:
    x, y, z = (a - b for a, b in zip(after, before, strict=True))
    return x, y, z
