"""MAVLink 1 and 2: rates, accelerations and clock of HIGHRES_IMU, SCALED_IMU, SCALED_IMU2, SCALED_IMU3 and RAW_IMU.

pymavlink finds the frames and checks them. A message that its dialect `ardupilotmega` does not know is not checked, and
is ignored. The axes are forward, right, down: y and z change their sign. A signature of MAVLink 2 is not checked.
Definitions: https://mavlink.io/en/messages/common.html.
"""

from dataclasses import dataclass
from math import isfinite, nan
from typing import TYPE_CHECKING, Any, NamedTuple

from gyrodrift.link.protocols.decoder import CountingDecoder, DeviceDescription
from gyrodrift.link.protocols.plausible import inertial_of
from gyrodrift.link.protocols.protocol import WireProtocol
from gyrodrift.values.constants import CLOCK_MASK, DEG_PER_RAD, STANDARD_GRAVITY_MPS2
from gyrodrift.values.sample import Reading, upside_down

if TYPE_CHECKING:
    from pymavlink.dialects.v20.ardupilotmega import MAVLink_message

HIGHRES, RAW = "HIGHRES_IMU", "RAW_IMU"
MESSAGES = (HIGHRES, "SCALED_IMU", "SCALED_IMU2", "SCALED_IMU3", RAW)
"""Messages with rates, the best one first: HIGHRES_IMU has more digits, SCALED_IMU is the first of three sensors."""

MPS2_PER_MG = STANDARD_GRAVITY_MPS2 / 1000.0
DPS_PER_MRADS = DEG_PER_RAD / 1000.0
GYRO_UPDATED = 0b111000
"""Bits of `fields_updated` of HIGHRES_IMU for the three rates."""

LISTEN_US, LISTEN_READINGS = 1_000_000, 1024
"""Time for which a better message may still come, µs, and most readings that wait.

Vehicles stream a message at least once a second. Chosen.
"""

MOST_NAMES = 8
"""Most vehicles that are named."""


@dataclass(frozen=True, slots=True)
class ImuChoice:
    """Vehicle and message to read; None for the first vehicle, and for its best message.

    raw_dps_per_lsb
        Rate of one count of RAW_IMU, deg/s; None: unknown, so RAW_IMU is not read.
    raw_mps2_per_lsb
        Acceleration of one count; None if unknown.
    """

    system: int | None = None
    message: str | None = None
    raw_dps_per_lsb: float | None = None
    raw_mps2_per_lsb: float | None = None


class MavlinkStream(NamedTuple):
    """One of the streams with rates: message, sensor of the message, vehicle."""

    rank: int
    sensor: int
    system: int
    component: int


class MavlinkDecoder(CountingDecoder):
    """Decoder that follows one message of one vehicle."""

    name = "mavlink"

    def __init__(self, choice: ImuChoice) -> None:
        from pymavlink.dialects.v20 import ardupilotmega

        super().__init__()
        self._parser = ardupilotmega.MAVLink(None)
        self._parser.robust_parsing = True  # damage is a message, not an error
        self._damage, self._unknown = ardupilotmega.MAVLink_bad_data, ardupilotmega.MAVLink_unknown
        self._in_step = False
        self._choice = choice
        self._chosen: MavlinkStream | None = None
        self._candidate: MavlinkStream | None = None
        self._waiting: list[Reading] = []

    def push(self, chunk: bytes) -> list[Reading]:
        """Decode complete frames; the parser keeps the rest."""
        readings: list[Reading] = []
        for message in self._parser.parse_buffer(chunk) or ():
            if isinstance(message, self._damage):
                self.counters.damaged += self._in_step
                self._in_step = False
            elif not isinstance(message, self._unknown):
                self._in_step = True
                self._take(message, readings)
        del self._parser.buf[: self._parser.buf_index]  # the parser itself keeps all until a chunk ends with a frame
        self._parser.buf_index = 0
        return readings

    def _take(self, message: "MAVLink_message", readings: list[Reading]) -> None:
        measured = self._measured(message)
        if measured is not None and measured[0] == self._chosen:
            self.count(measured[1], readings)
        elif measured is not None and self._follow_best(measured[0]):
            self.counters.frames += 1
            self._wait(*measured, readings)
        else:
            self.count(None, readings)
            if measured is not None:
                self._pass_over(measured[0])

    def _pass_over(self, stream: MavlinkStream) -> None:
        """Name another vehicle; noise and hostile input may have many."""
        followed, names = self._chosen or self._candidate, self.counters.passed_over
        if followed is not None and stream[2:] != followed[2:] and len(names) < MOST_NAMES:
            self.counters.passed_over = names | {f"{stream.system}/{stream.component}"}

    def _follow_best(self, stream: MavlinkStream) -> bool:
        """Follow a stream that is the best of the vehicle so far; False after one is chosen, and for others."""
        if self._chosen is not None:
            return False
        best = self._candidate
        if best is None or (stream[2:] == best[2:] and stream < best):
            self._candidate, self._waiting, self.counters.before_hello = stream, [], 0
        return stream == self._candidate

    def _wait(self, stream: MavlinkStream, reading: Reading, readings: list[Reading]) -> None:
        """Keep readings until no better message can be expected."""
        self._waiting.append(reading)
        waited_us = ((reading.t_us or 0) - (self._waiting[0].t_us or 0)) & CLOCK_MASK
        is_certain = not stream.rank or self._choice.message is not None
        if not (is_certain or waited_us >= LISTEN_US or len(self._waiting) >= LISTEN_READINGS):
            self.counters.before_hello = len(self._waiting)
            return
        self.counters.before_hello = 0
        self.counters.late += len(self._waiting) - 1
        readings += self._waiting
        self._chosen, self._waiting = stream, []
        self.device = DeviceDescription(_described(stream), axes=3)

    def _measured(self, message: Any) -> tuple[MavlinkStream, Reading] | None:
        """Stream and reading of a message; None without rates, or of another vehicle or message."""
        name, system = message.get_type(), message.get_srcSystem()
        if name not in MESSAGES or self._choice.message not in (None, name.lower()):
            return None
        if self._choice.system not in (None, system):
            return None
        sensor, reading = self._read_fields(name, message)
        if reading is None:
            return None
        return MavlinkStream(MESSAGES.index(name), sensor, system, message.get_srcComponent()), reading

    def _read_fields(self, name: str, message: Any) -> tuple[int, Reading | None]:
        """Number of the sensor, and its reading."""
        if name == HIGHRES:
            if message.fields_updated and not message.fields_updated & GYRO_UPDATED:
                return message.id, None
            return message.id, _reading(message, message.time_usec, DEG_PER_RAD, 1.0, message.temperature)
        temp_c = message.temperature / 100.0
        if name != RAW:
            return 0, _reading(message, message.time_boot_ms * 1000, DPS_PER_MRADS, MPS2_PER_MG, temp_c)
        if self._choice.raw_dps_per_lsb is None:
            return 0, None
        scales = self._choice.raw_dps_per_lsb, self._choice.raw_mps2_per_lsb or nan
        return message.id, _reading(message, message.time_usec, *scales, temp_c)


def _reading(message: Any, t_us: int, dps: float, mps2: float, temp_c: float) -> Reading | None:
    """Reading with z up; None without plausible rates. A temperature of 0 means that there is none."""
    rates_dps = tuple(dps * rate for rate in (message.xgyro, message.ygyro, message.zgyro))
    inertial = inertial_of(rates_dps, tuple(mps2 * force for force in (message.xacc, message.yacc, message.zacc)))
    if inertial is None:
        return None
    inertial = upside_down(inertial)
    is_warm = isfinite(temp_c) and temp_c != 0.0
    return Reading(t_us & CLOCK_MASK, None, inertial.gyro_z_dps, temp_c=temp_c if is_warm else nan, inertial=inertial)


def _described(stream: MavlinkStream) -> str:
    return f"MAVLink {stream.system}/{stream.component} {MESSAGES[stream.rank]}"


WITHOUT_RATE = (
    "ask the vehicle for HIGHRES_IMU or SCALED_IMU, with MAV_CMD_SET_MESSAGE_INTERVAL or its stream rates; RAW_IMU has "
    "no unit: append ?raw=mrads to the address for ArduPilot, or ?raw=lsb/N for N counts per deg/s"
)


def mavlink_protocol(choice: ImuChoice) -> WireProtocol:
    """Protocol that reads one message of one vehicle."""
    return WireProtocol(
        "mavlink",
        "MAVLink 1 and 2",
        lambda: MavlinkDecoder(choice),
        has_clock=True,
        rank=3,
        is_detected=False,
        has_unit=True,
        without_rate=WITHOUT_RATE,
        choice_hint="the first vehicle is used; append ?system=N to the address for another one",
    )
