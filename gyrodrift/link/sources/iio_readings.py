"""Readings of an IIO gyro from the counts of its channels, joined with the accelerations of its chip.

`(count + offset) * scale` is rad/s, m/s², or thousandths of °C (Documentation/ABI/testing/sysfs-bus-iio of the kernel).
Gyro and accelerometer may be two IIO devices, as with the LSM6DS family. The timestamps of the kernel join their scans.
"""

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass
from math import degrees, isfinite, nan

from gyrodrift.link.protocols.decoder import DeviceDescription
from gyrodrift.link.protocols.plausible import MAX_RATE_DPS, inertial_of
from gyrodrift.values.constants import CLOCK_MASK
from gyrodrift.values.sample import Reading
from gyrodrift.values.vectors import Vector

IDENTITY = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
ROTATION_TOLERANCE = 0.02
"""Largest error of a product of two rows of a mount matrix; device trees have two or three digits."""

TIMESTAMP = "timestamp"
MILLI = 1e-3

JOIN_NS = 50_000_000
"""Longest time between a rate and its acceleration, ns: half a period at the usual minimum of 12.5 Hz."""

MOST_FORCES = 64


@dataclass(frozen=True, slots=True)
class IioChannel:
    """Scale and offset of a channel."""

    scale: float = 1.0
    offset: float = 0.0

    def value(self, count: int) -> float:
        """Value in the unit of the channel."""
        return (count + self.offset) * self.scale


@dataclass(frozen=True, slots=True)
class IioDescription:
    """Description of a device in sysfs.

    name
        Name of the device.
    rate_hz
        Sampling frequency, Hz; 0 if unknown.
    matrix
        Mount matrix by rows, which turns from the chip to the board.
    channels
        Channels by name: `anglvel_x`, `accel_z`, `temp`, `timestamp`.
    """

    name: str
    rate_hz: float
    matrix: tuple[float, ...]
    channels: Mapping[str, IioChannel]

    def value(self, name: str, counts: Mapping[str, int]) -> float:
        """Value of a channel; NaN without it."""
        return self.channels[name].value(counts[name]) if name in counts else nan

    def vector(self, kind: str, counts: Mapping[str, int]) -> Vector | None:
        """Vector of a kind in the axes of the board; None without all three axes."""
        if not all(f"{kind}_{axis}" in counts for axis in "xyz"):
            return None
        x, y, z = (self.value(f"{kind}_{axis}", counts) for axis in "xyz")
        m = self.matrix
        first, second, third = (m[row] * x + m[row + 1] * y + m[row + 2] * z for row in (0, 3, 6))
        return first, second, third


def is_rotation(matrix: tuple[float, ...]) -> bool:
    """Whether nine numbers are a right-handed rotation; a mirrored one would change the sign of a rate."""
    if (
        len(matrix) != len(IDENTITY)
        or not all(map(isfinite, matrix))
        or max(map(abs, matrix)) > 1.0 + ROTATION_TOLERANCE
    ):
        return False
    rows = matrix[:3], matrix[3:6], matrix[6:]
    products = [
        abs(sum(a * b for a, b in zip(rows[i], rows[j], strict=True)) - (i == j)) for i in range(3) for j in range(i, 3)
    ]
    (a, b, c), (d, e, f), (g, h, i) = rows
    determinant = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
    return max(products) <= ROTATION_TOLERANCE and determinant > 0.0


class IioReadings:
    """Readings of one gyro.

    device
        Its description.
    """

    def __init__(self, gyro: IioDescription, accel: IioDescription | None = None) -> None:
        scale, axes = degrees(gyro.channels["anglvel_z"].scale), 3 if "anglvel_x" in gyro.channels else 1
        self.device = DeviceDescription(gyro.name, gyro.rate_hz or None, scale, axes=axes)
        self._gyro, self._accel = gyro, accel
        self._forces: deque[tuple[int, Vector]] = deque(maxlen=MOST_FORCES)

    def keep_forces(self, counts: Mapping[str, int]) -> None:
        """Keep a scan of the other accelerometer."""
        forces = None if self._accel is None else self._accel.vector("accel", counts)
        if forces is not None and TIMESTAMP in counts:
            self._forces.append((counts[TIMESTAMP], forces))

    def reading(self, counts: Mapping[str, int], temp_c: float) -> Reading | None:
        """Reading of a scan of the gyro; None with impossible rates. `temp_c` is used without a temperature in it."""
        gyro, t_ns = self._gyro, counts.get(TIMESTAMP)
        if "temp" in counts:
            temp_c = gyro.value("temp", counts) * MILLI
        rates = gyro.vector("anglvel", counts)
        forces = gyro.vector("accel", counts) or self._force_at(t_ns)
        inertial = None if rates is None else inertial_of(tuple(map(degrees, rates)), forces)
        rate_dps = degrees(gyro.value("anglvel_z", counts)) if inertial is None else inertial.gyro_z_dps
        if not abs(rate_dps) <= MAX_RATE_DPS or (rates is not None and inertial is None):
            return None
        t_us = None if t_ns is None else t_ns // 1000 & CLOCK_MASK
        return Reading(t_us, None, rate_dps, temp_c=temp_c if isfinite(temp_c) else nan, inertial=inertial)

    def _force_at(self, t_ns: int | None) -> Vector | None:
        """Acceleration of the scan that is nearest in time; None without a near one."""
        if t_ns is None or not self._forces:
            return None
        force_ns, forces = min(self._forces, key=lambda entry: abs(entry[0] - t_ns))
        return forces if abs(force_ns - t_ns) <= JOIN_NS else None
