"""The native protocol: COBS frames with a CRC, HELLO once a second and SAMPLE for every measurement.

A device with three axes and an accelerometer sends HELLO version 2 and SAMPLE3 instead. A device that runs a filter
sends HELLO version 3, and YAW after a sample. Only HELLO has the scales of a count. Earlier samples wait as counts, and
are scaled when it arrives.

A YAW follows its sample, so that sample has to wait for it. Devices may send a YAW for every tenth sample only. Then
the other nine do not wait: the smallest distance between two YAWs so far tells which sample has one.
"""

from binascii import crc_hqx
from collections import deque
from math import isnan, nan
from struct import Struct
from typing import Any

from cobs import cobs

from gyrodrift.link.clocks.device import ODD_SHARE, ODD_US, step_between
from gyrodrift.link.protocols.decoder import WAITING_MAX, DecoderCounters, DeviceDescription
from gyrodrift.link.protocols.frames import PieceDecoder
from gyrodrift.link.protocols.protocol import WireProtocol
from gyrodrift.values.constants import COUNTER_WRAP
from gyrodrift.values.sample import DeviceYaw, Inertial, Reading

YAW = Struct("<BBHIfff")
YAW_TYPE = 0x04

FILTERS = {1: "hdr", 2: "restlevel", 3: "attitude"}
"""Names of the filters in HELLO version 3; 0 stands for none."""

MOST_DEG = 2.0**23
"""Largest absolute yaw and sigma, deg: from there on a float of four bytes has no half degrees."""

MOST_BIAS_DPS = 2.0**15 * 10.0
"""Largest absolute bias, deg/s: the largest rate in 16 bits at the largest scale."""

CRC_INIT = 0xFFFF
"""CRC-16/CCITT-FALSE; `binascii.crc_hqx` has its polynomial 0x1021."""

HELLO = Struct("<BBHfI16s")
SAMPLE = Struct("<BBHIhhi")
CRC = Struct("<H")
AXES_HELLO = Struct("<BBHfI16sfB")
FILTER_HELLO = Struct("<BBHfI16sfBB")
AXES_SAMPLE = Struct("<BBHI7hi")
HELLO_TYPE = 0x01
SAMPLE_TYPE = 0x02
AXES_SAMPLE_TYPE = 0x03
HELLOS = {HELLO.size: (1, HELLO), AXES_HELLO.size: (2, AXES_HELLO), FILTER_HELLO.size: (3, FILTER_HELLO)}
"""Versions and layouts of HELLO by size."""

SAMPLE_SIZES = {SAMPLE_TYPE: SAMPLE.size, AXES_SAMPLE_TYPE: AXES_SAMPLE.size}
ENCODER_VALID = 0x01
TEMPERATURE_VALID = 0x02
RATE_CLIPPED = 0x04
STILL_VALID = 0x08
STILL = 0x10
ACCEL_VALID = 0x10
AXES_STILL = 0x20
ACCEL_CLIPPED = 0x40
"""Flags of SAMPLE3 only; the flag of an acceleration has the bit that says in SAMPLE that the device is at rest."""

DPS_PER_LSB_MIN, DPS_PER_LSB_MAX = 1e-9, 10.0
"""Range of scales that 16-bit gyros can have; a HELLO outside counts as damaged."""

MPS2_PER_LSB_MIN, MPS2_PER_LSB_MAX = 1e-6, 10.0
"""Range of scales that 16-bit accelerometers can have: ±400 g have 0.12 m/s² per count."""

AXES = (1, 3)
ABSENT: list[Any] = [0.0, None, 0]
"""Scale of accelerations, axes and filter in a HELLO without them."""

CLIPPED_FLAGS = {SAMPLE_TYPE: RATE_CLIPPED, AXES_SAMPLE_TYPE: RATE_CLIPPED | ACCEL_CLIPPED}

MAX_FRAME_BYTES = FILTER_HELLO.size + CRC.size + 1
"""The longest frame before its delimiter; COBS adds one byte to payloads as short as these."""


def filter_name(number: int) -> str | None:
    """Name of a filter in HELLO; a newer device may run one without a name here."""
    return FILTERS.get(number, f"filter {number}") if number else None


class YawJoin:
    """Holds a sample back while its YAW is due, and joins the two.

    No sample waits until HELLO says that the device runs a filter.

    is_idle
        No sample waits, and none will: samples need not pass through `take`.
    """

    def __init__(self) -> None:
        self.is_idle = True
        self._is_announced = False
        self._held: Reading | None = None
        self._yaw_seq: int | None = None
        self._stride = 0

    def announce(self, filter_name: str | None) -> None:
        """Start again after HELLO of a device, which names its filter or None."""
        self._is_announced = filter_name is not None
        self._yaw_seq, self._stride = None, 0
        self.is_idle = not self._is_announced and self._held is None

    def take(self, reading: Reading, readings: list[Reading]) -> None:
        """Pass a sample on, after the one that waited; it waits itself if its YAW is due."""
        self._release(readings)
        if self._is_due(reading):
            self._held = reading
        else:
            readings.append(reading)

    def join(self, payload: bytes, readings: list[Reading], counters: DecoderCounters) -> None:
        """Pass on the sample that waits, with the YAW of `payload`; without such a sample the YAW is only counted."""
        _, _, seq, t_us, *values = YAW.unpack(payload)
        if not _is_possible(*values):
            counters.damaged += 1
            return
        counters.frames += 1
        sample = self._held
        if not self._is_announced or sample is None or (sample.seq, sample.t_us) != (seq, t_us):
            counters.lone_yaws += 1
            self._learn(seq)
            return
        self._held = sample._replace(device_yaw=DeviceYaw(*values))
        self._release(readings)
        self._learn(seq)

    def _release(self, readings: list[Reading]) -> None:
        if self._held is not None:
            readings.append(self._held)
            self._held = None
            self.is_idle = not self._is_announced

    def _is_due(self, reading: Reading) -> bool:
        """Whether a YAW may follow this sample."""
        if not self._is_announced or self._yaw_seq is None or reading.seq is None:
            return self._is_announced
        return (reading.seq - self._yaw_seq) % COUNTER_WRAP >= self._stride

    def _learn(self, seq: int) -> None:
        """Note the distance from the YAW before; 0 is a repeated frame."""
        distance = 0 if self._yaw_seq is None else (seq - self._yaw_seq) % COUNTER_WRAP
        if distance:
            self._stride = min(self._stride or distance, distance)
        self._yaw_seq = seq


def _is_possible(yaw_deg: float, yaw_sigma_deg: float, bias_dps: float) -> bool:
    """Whether a filter can give these values; only the sigma may be NaN."""
    has_sigma = isnan(yaw_sigma_deg) or 0.0 <= yaw_sigma_deg <= MOST_DEG
    return has_sigma and abs(yaw_deg) <= MOST_DEG and abs(bias_dps) <= MOST_BIAS_DPS


class NativeDecoder(PieceDecoder):
    """Decoder of frames between zero bytes; damage costs one frame, since every zero starts a new one."""

    name = "native"
    delimiter = b"\0"
    longest_bytes = MAX_FRAME_BYTES

    def __init__(self) -> None:
        super().__init__()
        self._dps_per_lsb = 0.0
        self._deg_per_count = 0.0
        self._mps2_per_lsb = nan
        self._waiting: deque[bytes] = deque(maxlen=WAITING_MAX)
        self._is_known_device = False
        self._join = YawJoin()

    def take(self, piece: bytes, readings: list[Reading]) -> None:
        """Decode a frame."""
        try:
            body = cobs.decode(piece)
        except cobs.DecodeError:
            self.counters.damaged += 1
            return
        payload = body[:-2]
        if len(body) < 3 or crc_hqx(payload, CRC_INIT) != body[-2] | body[-1] << 8:
            self.counters.damaged += 1
        elif SAMPLE_SIZES.get(payload[0]) == len(payload):
            self.counters.frames += 1
            self._sample(payload, readings)
        elif payload[0] == YAW_TYPE and len(payload) == YAW.size:
            self._join.join(payload, readings, self.counters)
        elif payload[0] == HELLO_TYPE and len(payload) in HELLOS:
            self._hello(payload)
        else:
            self.counters.frames += 1
            self.counters.other_frames += 1

    def _hello(self, payload: bytes) -> None:
        version, layout = HELLOS[len(payload)]
        _, stated, sample_rate_hz, dps_per_lsb, encoder_cpr, device_id, *accelerometer = layout.unpack(payload)
        if stated != version:
            self.counters.frames += 1
            self.counters.other_frames += 1
            return
        mps2_per_lsb, axes, filter_number = accelerometer + ABSENT[len(accelerometer) :]
        has_scale = DPS_PER_LSB_MIN <= dps_per_lsb <= DPS_PER_LSB_MAX
        if not has_scale or not _is_accelerometer(mps2_per_lsb) or (accelerometer and axes not in AXES):
            self.counters.damaged += 1
            return
        self.counters.frames += 1
        device = DeviceDescription(
            device_id=_printable(device_id.rstrip(b"\0")),
            sample_rate_hz=float(sample_rate_hz) or None,
            dps_per_lsb=dps_per_lsb,
            encoder_cpr=encoder_cpr or None,
            axes=axes,
            mps2_per_lsb=mps2_per_lsb or None,
            device_filter=filter_name(filter_number),
        )
        if not self._dps_per_lsb:
            self._is_known_device = device == self.device
        if device != self.device or not self._dps_per_lsb:
            self._join.announce(device.device_filter)
        self.device = device
        self._dps_per_lsb = dps_per_lsb
        self._deg_per_count = 360.0 / encoder_cpr if encoder_cpr else 0.0
        self._mps2_per_lsb = mps2_per_lsb or nan

    def _sample(self, payload: bytes, readings: list[Reading]) -> None:
        if payload[1] & CLIPPED_FLAGS[payload[0]]:
            self.counters.clipped += 1
        if not self._dps_per_lsb:
            self.counters.before_hello += 1
            self._waiting.append(payload)
            return
        if self._waiting:
            self._release(payload, readings)
        if self._join.is_idle:
            readings.append(self._reading(payload))
        else:
            self._join.take(self._reading(payload), readings)

    def _release(self, payload: bytes, readings: list[Reading]) -> None:
        """Scale the waiting samples when the first sample after HELLO has arrived.

        If the device is the same as before, all of them are its own. Otherwise only those count that lead up to this
        sample without a break. The rest stays counted as `before_hello`.
        """
        waiting = [self._reading(sample) for sample in (*self._waiting, payload)]
        self._waiting.clear()
        late = waiting[0 if self._is_known_device else self._last_break(waiting) : -1]
        readings += late
        self.counters.before_hello -= len(late)
        self.counters.late += len(late)

    def _last_break(self, readings: list[Reading]) -> int:
        """Index of the last reading that does not follow from the one before it; 0 without one."""
        rate_hz = self.device.sample_rate_hz
        breaks = (i for i in range(1, len(readings)) if not _goes_on(readings[i - 1], readings[i], rate_hz))
        return max(breaks, default=0)

    def _reading(self, payload: bytes) -> Reading:
        inertial, still = None, STILL
        if payload[0] == SAMPLE_TYPE:
            _, flags, seq, t_us, rate_raw, temp_centi_c, encoder_counts = SAMPLE.unpack(payload)
            rate_dps = rate_raw * self._dps_per_lsb
        else:
            _, flags, seq, t_us, *raw, temp_centi_c, encoder_counts = AXES_SAMPLE.unpack(payload)
            inertial, still = self._inertial(flags, raw), AXES_STILL
            rate_dps = inertial.gyro_z_dps
        has_encoder = flags & ENCODER_VALID and self._deg_per_count
        return Reading(
            t_us,
            seq,
            rate_dps,
            encoder_counts * self._deg_per_count if has_encoder else nan,
            temp_centi_c / 100.0 if flags & TEMPERATURE_VALID else nan,
            (1.0 if flags & still else 0.0) if flags & STILL_VALID else nan,
            nan,
            inertial,
        )

    def _inertial(self, flags: int, raw: list[int]) -> Inertial:
        """All axes from their counts; a clipped acceleration counts as missing, because its direction is wrong."""
        dps_per_lsb, has_forces = self._dps_per_lsb, flags & (ACCEL_VALID | ACCEL_CLIPPED) == ACCEL_VALID
        mps2_per_lsb = self._mps2_per_lsb if has_forces else nan
        x, y, z, accel_x, accel_y, accel_z = raw
        return Inertial(
            x * dps_per_lsb,
            y * dps_per_lsb,
            z * dps_per_lsb,
            accel_x * mps2_per_lsb,
            accel_y * mps2_per_lsb,
            accel_z * mps2_per_lsb,
        )


def _goes_on(last: Reading, reading: Reading, rate_hz: float | None) -> bool:
    """Whether two samples come from the same device: the clock advances, and the counter by the samples of that time.

    `rate_hz` is None if the device does not send it; then only the clock counts.
    """
    step_us, counted = step_between(last, reading)
    if step_us < 0:
        return False
    if rate_hz is None:
        return True
    off = (counted - step_us * 1e-6 * rate_hz) % COUNTER_WRAP
    return min(off, COUNTER_WRAP - off) <= max(ODD_US, ODD_SHARE * step_us) * 1e-6 * rate_hz


def _is_accelerometer(mps2_per_lsb: float) -> bool:
    """Whether an accelerometer may have this scale; 0 stands for none."""
    return mps2_per_lsb == 0.0 or MPS2_PER_LSB_MIN <= mps2_per_lsb <= MPS2_PER_LSB_MAX


def _printable(name: bytes) -> str:
    """Name with a replacement character for everything but printable ASCII."""
    return "".join(character if character.isprintable() else "\ufffd" for character in name.decode("ascii", "replace"))


PROTOCOL = WireProtocol(
    "native", "COBS frames with a CRC; HELLO tells the scale", NativeDecoder, has_clock=True, rank=0
)
