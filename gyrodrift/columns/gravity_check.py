"""Check of the unit of the accelerations of a stream by gravity."""

from math import hypot, isnan
from statistics import median
from typing import Any

from gyrodrift.columns.sizes import FREE_SHARE, gravity_unit, is_gravity
from gyrodrift.values.constants import STANDARD_GRAVITY_MPS2
from gyrodrift.values.sample import Sample

LENGTHS = 200
"""Number of accelerations that are judged: a second or more, so that a jolt is no median."""

HINTS = {
    "csv": "send m/s², or read it with --columns 't_us, gx, gy, gz, ax:{unit}, ay:{unit}, az:{unit}'",
    "text": "in --columns, write ax:{unit}, ay:{unit}, az:{unit}",
}
SCALE_HINT = "the scale of the accelerometer in HELLO does not fit its range"


class AccelerationCheck:
    """Collects the lengths of accelerations, in m/s² as the stream is read, until there are enough to judge."""

    def __init__(self, protocol: str) -> None:
        self.is_over = False
        self._protocol = protocol
        self._lengths: list[float] = []

    def take(self, samples: list[Sample]) -> dict[str, Any] | None:
        """Fields of the event about a wrong unit, once; None while there is nothing to tell."""
        for sample in samples:
            if sample.inertial is not None and not isnan(length := hypot(*sample.inertial[3:])):
                self._lengths.append(length)
        if self.is_over or len(self._lengths) < LENGTHS:
            return None
        self.is_over = True
        length_mps2 = median(self._lengths)
        return None if is_gravity(length_mps2) else self._fields(length_mps2)

    def _fields(self, length_mps2: float) -> dict[str, Any]:
        unit = gravity_unit(length_mps2)
        if not unit and length_mps2 < FREE_SHARE * STANDARD_GRAVITY_MPS2:
            hint = "send the accelerometer itself, not linear acceleration: the tilt is unknown without gravity"
        else:
            hint = HINTS.get(self._protocol, SCALE_HINT).format(unit=unit or "lsb/N")
        return {"unit": unit or "unknown", "length_mps2": round(length_mps2, 4), "hint": hint}
