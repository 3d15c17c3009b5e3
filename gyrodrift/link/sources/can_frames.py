"""Readings of a gyro on a CAN bus. Its frames of one measurement are joined.

A gyro sends the frames of a measurement one after the other. The bus lets the lowest id pass first. So an id that is
not higher than the last one begins the next measurement. A measurement is complete as soon as it has all ids that were
seen in the last measurements.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import isfinite, nan

from gyrodrift.link.protocols.batch import batch_protocol
from gyrodrift.link.protocols.decoder import DeviceDescription
from gyrodrift.link.protocols.plausible import MAX_RATE_DPS, inertial_of
from gyrodrift.values.constants import CLOCK_MASK, COUNTER_MASK
from gyrodrift.values.sample import Reading, upside_down

EXTENDED = 1 << 31
"""Flag of an id with 29 bits, as in SocketCAN."""

FORGET = 20
"""Measurements without an id after which it is not expected any more. Chosen."""

RATES, FORCES = ("gx", "gy", "gz"), ("ax", "ay", "az")


@dataclass(frozen=True, slots=True)
class CanGyro:
    """Frames of a gyro.

    ids
        Ids of its frames, with `EXTENDED`.
    fields
        Function from an id and a content to values by name: `gx` to `gz` in deg/s, `ax` to `az` in m/s², `temp` in °C,
        `t_us`, `seq`. It returns no value that a frame lacks, and never raises.
    is_upside_down
        Whether its z axis points down.
    """

    name: str
    ids: frozenset[int]
    fields: Callable[[int, bytes], Mapping[str, float]]
    is_upside_down: bool = False


class CanReadings:
    """Readings of one gyro on a bus.

    device
        Its description.
    """

    def __init__(self, gyro: CanGyro) -> None:
        self.device = DeviceDescription(gyro.name)
        self._gyro = gyro
        self._values: dict[str, float] = {}
        self._ids: set[int] = set()
        self._last_id = -1
        self._received_us = 0
        self._absent: dict[int, int] = {}
        self._is_first = True
        self._has_clock = False
        self._temp_c = nan

    def reading(self, received_us: int, number: int, content: bytes) -> Reading | None:
        """Measurement that a frame of the gyro completes, or that it shows to be over."""
        is_next = bool(self._ids) and number & ~EXTENDED <= self._last_id
        finished = self._finish() if is_next else None
        values = self._gyro.fields(number, content)
        if "gz" in values:
            self._received_us = received_us
        self._values.update(values)
        self._ids.add(number)
        self._last_id = number & ~EXTENDED
        return self._finish() if finished is None and self._is_complete() else finished

    def _is_complete(self) -> bool:
        """Whether all expected ids are there."""
        return not self._is_first and "gz" in self._values and self._absent.keys() <= self._ids

    def _finish(self) -> Reading | None:
        """Reading of the present measurement, which ends. The first one may have begun before, and is dropped."""
        for number in list(self._absent):
            self._absent[number] += 1
            if self._absent[number] > FORGET:
                del self._absent[number]
        self._absent.update(dict.fromkeys(self._ids, 0))
        values, self._values, self._ids, self._last_id = self._values, {}, set(), -1
        is_first, self._is_first = self._is_first, False
        return None if is_first else self._measured(values)

    def _measured(self, values: Mapping[str, float]) -> Reading | None:
        rate_dps = values.get("gz", nan)
        if not abs(rate_dps) <= MAX_RATE_DPS:
            return None
        self._has_clock = self._has_clock or "t_us" in values
        if self._has_clock and "t_us" not in values:
            return None
        temp_c = values.get("temp", nan)
        self._temp_c = temp_c if isfinite(temp_c) else self._temp_c
        t_us = int(values.get("t_us", self._received_us)) & CLOCK_MASK
        seq = int(values["seq"]) & COUNTER_MASK if "seq" in values else None
        rates, forces = ([values.get(name, nan) for name in names] for names in (RATES, FORCES))
        inertial = inertial_of(rates, forces)
        if self._gyro.is_upside_down:
            rate_dps, inertial = -rate_dps, None if inertial is None else upside_down(inertial)
        return Reading(t_us, seq, rate_dps, temp_c=self._temp_c, inertial=inertial)


CAN_PROTOCOL = batch_protocol("can", "CAN frames of a gyro", "check gyro=, signal= and the ids")
