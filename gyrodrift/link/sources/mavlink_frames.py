"""MAVLink 1 and 2: rates, accelerations and clock of HIGHRES_IMU, SCALED_IMU, SCALED_IMU2, SCALED_IMU3 and RAW_IMU.

A frame ends with CRC-16/MCRF4XX over header, payload, and a byte that stands for the fields of the message. That byte
is known here for the messages that are read. Other messages may have any such byte, so a check of 8 bits remains.

The axes are forward, right, down: y and z change their sign. A signature of MAVLink 2 is not checked.
Definitions: https://mavlink.io/en/guide/serialization.html and https://mavlink.io/en/messages/common.html.
"""

import re
from binascii import crc_hqx
from dataclasses import dataclass
from math import degrees, isfinite, nan
from struct import Struct
from typing import NamedTuple

from gyrodrift.link.protocols.decoder import DeviceDescription
from gyrodrift.link.protocols.frames import FrameDecoder
from gyrodrift.link.protocols.lines import MAX_RATE_DPS
from gyrodrift.link.protocols.protocol import WireProtocol
from gyrodrift.values.constants import STANDARD_GRAVITY_MPS2
from gyrodrift.values.sample import Inertial, Reading, upside_down

MAGIC_1, MAGIC_2 = 0xFE, 0xFD
HEADER_1, HEADER_2, CHECK_BYTES, SIGNATURE_BYTES = 6, 10, 2, 13
SIGNED = 0x01
"""The only incompatibility flag of MAVLink 2; frames with others must be dropped."""

REVERSED = bytes(int(f"{byte:08b}"[::-1], 2) for byte in range(256))
HEAD = re.compile(b"[\xfd\xfe]")

MPS2_PER_MG = STANDARD_GRAVITY_MPS2 / 1000.0
DPS_PER_MRADS = degrees(1e-3)
DPS_PER_RADS = degrees(1.0)
GYRO_UPDATED = 0b111000
"""Bits of `fields_updated` of HIGHRES_IMU for the three rates."""

LISTEN_US, LISTEN_READINGS = 1_000_000, 1024
"""Time for which a better message may still come, µs, and most readings that wait.

Vehicles stream a message at least once a second. Chosen.
"""

CLOCK_MASK = 0xFFFFFFFF
MOST_NAMES = 8
"""Most vehicles that are named."""


class MavlinkMessage(NamedTuple):
    """A message with rates.

    extra
        Byte for its fields in the checksum.
    rank
        Order of preference, ascending: HIGHRES_IMU has more digits, SCALED_IMU is the first of three sensors.
    """

    name: str
    extra: int
    rank: int
    form: Struct


HIGHRES = Struct("<Q13fHB")
SCALED = Struct("<I10h")
RAW = Struct("<Q9hBh")
MESSAGES = {
    105: MavlinkMessage("highres_imu", 93, 0, HIGHRES),
    26: MavlinkMessage("scaled_imu", 170, 1, SCALED),
    116: MavlinkMessage("scaled_imu2", 76, 2, SCALED),
    129: MavlinkMessage("scaled_imu3", 46, 3, SCALED),
    27: MavlinkMessage("raw_imu", 144, 4, RAW),
}
"""Messages by id, with the extensions of MAVLink 2; missing bytes at their end are 0."""

HEARTBEAT_ID, HEARTBEAT_EXTRA = 0, 50
EXTRAS = {HEARTBEAT_ID: HEARTBEAT_EXTRA, **{number: message.extra for number, message in MESSAGES.items()}}


def checksum(content: bytes, start: int = 0xFFFF) -> int:
    """CRC-16/MCRF4XX: the bits of CRC-16/CCITT in reverse order."""
    crc = crc_hqx(content.translate(REVERSED), start)
    return REVERSED[crc & 0xFF] << 8 | REVERSED[crc >> 8]


POSSIBLE = frozenset(checksum(bytes((byte,)), 0) for byte in range(256))
"""Changes of a checksum by one byte."""


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


class MavlinkDecoder(FrameDecoder):
    """Decoder that follows one message of one vehicle."""

    name = "mavlink"
    head = b""
    header = HEAD
    header_bytes = 1

    def __init__(self, choice: ImuChoice) -> None:
        super().__init__()
        self._choice = choice
        self._chosen: MavlinkStream | None = None
        self._candidate: MavlinkStream | None = None
        self._waiting: list[Reading] = []

    def _find(self, buffer: bytes, position: int) -> int:
        """Position of the next head."""
        if position >= len(buffer) or buffer[position] in (MAGIC_1, MAGIC_2):
            return position
        self._lose_step()
        match = HEAD.search(buffer, position + 1)
        return len(buffer) if match is None else match.start()

    def length(self, buffer: bytes, position: int) -> int | None:
        """Length of header, payload, checksum and signature."""
        if len(buffer) - position < 3:
            return None
        payload_bytes, flags = buffer[position + 1], buffer[position + 2]
        if buffer[position] == MAGIC_1:
            return HEADER_1 + payload_bytes + CHECK_BYTES
        if buffer[position] != MAGIC_2 or flags & ~SIGNED:
            return 0
        return HEADER_2 + payload_bytes + CHECK_BYTES + SIGNATURE_BYTES * flags

    def is_whole(self, frame: bytes) -> bool:
        """Whether the checksum fits the message."""
        end = _payload_end(frame)
        stated = frame[end] | frame[end + 1] << 8
        extra = EXTRAS.get(_message_id(frame))
        if extra is None:
            return stated ^ checksum(frame[1:end]) >> 8 in POSSIBLE
        return checksum(frame[1:end] + bytes((extra,))) == stated

    def read(self, frame: bytes) -> Reading | None:
        """Reading of a message with rates."""
        measured = self._measured(frame)
        return None if measured is None else measured[1]

    def _believed_end(self, buffer: bytes, position: int) -> int | None:
        """End of a frame; after damage, another message counts only if a frame follows directly."""
        end = self._end(buffer, position)
        if not end or self._in_step or _message_id(buffer[position : position + HEADER_2]) in EXTRAS:
            return end
        next_end = self._end(buffer, end)
        return next_end and end

    def _take(self, frame: bytes, readings: list[Reading]) -> None:
        self.counters.frames += 1
        measured = self._measured(frame)
        if measured is not None and measured[0] == self._chosen:
            readings.append(measured[1])
        elif measured is not None and self._is_candidate(measured[0]):
            self._wait(*measured, readings)
        else:
            self.counters.other_frames += 1
            if measured is not None:
                self._pass_over(measured[0])

    def _pass_over(self, stream: MavlinkStream) -> None:
        """Name another vehicle; noise and hostile input may have many."""
        followed, names = self._chosen or self._candidate, self.counters.passed_over
        if followed is not None and stream[2:] != followed[2:] and len(names) < MOST_NAMES:
            self.counters.passed_over = names | {f"{stream.system}/{stream.component}"}

    def _is_candidate(self, stream: MavlinkStream) -> bool:
        """Whether a stream is the best of the vehicle so far, before one is chosen."""
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

    def _measured(self, frame: bytes) -> tuple[MavlinkStream, Reading] | None:
        """MavlinkStream and reading of a frame; None without rates, or of another vehicle or message."""
        message = MESSAGES.get(_message_id(frame))
        if message is None or self._choice.message not in (None, message.name):
            return None
        first = 5 if frame[0] == MAGIC_2 else 3
        system, component = frame[first], frame[first + 1]
        if self._choice.system not in (None, system):
            return None
        payload = frame[HEADER_2 if frame[0] == MAGIC_2 else HEADER_1 : _payload_end(frame)]
        fields = message.form.unpack(payload[: message.form.size].ljust(message.form.size, b"\0"))
        sensor, reading = self._read_fields(message, fields)
        return None if reading is None else (MavlinkStream(message.rank, sensor, system, component), reading)

    def _read_fields(self, message: MavlinkMessage, fields: tuple[float, ...]) -> tuple[int, Reading | None]:
        """Number of the sensor, and its reading."""
        if message.form is HIGHRES:
            updated, sensor = int(fields[14]), int(fields[15])
            if updated and not updated & GYRO_UPDATED:
                return sensor, None
            return sensor, _reading(fields[0], fields[1:7], DPS_PER_RADS, 1.0, fields[13])
        if message.form is SCALED:
            return 0, _reading(fields[0] * 1000, fields[1:7], DPS_PER_MRADS, MPS2_PER_MG, fields[10] / 100.0)
        if self._choice.raw_dps_per_lsb is None:
            return 0, None
        scales = self._choice.raw_dps_per_lsb, self._choice.raw_mps2_per_lsb or nan
        return int(fields[10]), _reading(fields[0], fields[1:7], *scales, fields[11] / 100.0)


def _reading(t_us: float, axes: tuple[float, ...], dps: float, mps2: float, temp_c: float) -> Reading | None:
    """Reading with z up; None without plausible rates. A temperature of 0 means that there is none."""
    rates = tuple(dps * value for value in axes[3:])
    if not all(abs(rate_dps) <= MAX_RATE_DPS for rate_dps in rates):
        return None
    forces = tuple(mps2 * value for value in axes[:3])
    finite_forces = forces if all(map(isfinite, forces)) else ()
    inertial = upside_down(Inertial(*rates, *finite_forces))
    is_warm = isfinite(temp_c) and temp_c != 0.0
    return Reading(
        int(t_us) & CLOCK_MASK, None, inertial.gyro_z_dps, temp_c=temp_c if is_warm else nan, inertial=inertial
    )


def _message_id(frame: bytes) -> int:
    return frame[7] | frame[8] << 8 | frame[9] << 16 if frame[0] == MAGIC_2 else frame[5]


def _payload_end(frame: bytes) -> int:
    return frame[1] + (HEADER_2 if frame[0] == MAGIC_2 else HEADER_1)


def _described(stream: MavlinkStream) -> str:
    message = next(message.name for message in MESSAGES.values() if message.rank == stream.rank)
    return f"MAVLink {stream.system}/{stream.component} {message.upper()}"


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
