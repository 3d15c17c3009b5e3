"""The native protocol: COBS frames with a CRC, HELLO once a second and SAMPLE for every measurement.

Only HELLO has the scale of a count. Earlier samples wait as counts, and are scaled when it arrives.
"""

from binascii import crc_hqx
from collections import deque
from math import nan
from struct import Struct

from cobs import cobs

from gyrodrift.link.protocols.decoder import WAITING_MAX, DecoderCounters, DeviceDescription
from gyrodrift.link.protocols.goes_on import goes_on
from gyrodrift.link.protocols.protocol import WireProtocol
from gyrodrift.sample import Reading

CRC_INIT = 0xFFFF
"""CRC-16/CCITT-FALSE; `binascii.crc_hqx` has its polynomial 0x1021."""

HELLO = Struct("<BBHfI16s")
SAMPLE = Struct("<BBHIhhi")
CRC = Struct("<H")
HELLO_TYPE = 0x01
SAMPLE_TYPE = 0x02
VERSION = 1
ENCODER_VALID = 0x01
TEMPERATURE_VALID = 0x02
RATE_CLIPPED = 0x04
STILL_VALID = 0x08
STILL = 0x10

DPS_PER_LSB_MIN, DPS_PER_LSB_MAX = 1e-9, 10.0
"""Range of scales that 16-bit gyros can have; a HELLO outside counts as damaged."""

MAX_FRAME_BYTES = HELLO.size + CRC.size + 1
"""The longest frame before its delimiter; COBS adds one byte to payloads as short as these."""


class NativeDecoder:
    """Decoder of frames between zero bytes; damage costs one frame, since every zero starts a new one."""

    name = "native"

    def __init__(self) -> None:
        self.counters = DecoderCounters()
        self.device = DeviceDescription()
        self._pending = b""
        self._overlong = False
        self._dps_per_lsb = 0.0
        self._deg_per_count = 0.0
        self._waiting: deque[bytes] = deque(maxlen=WAITING_MAX)
        self._is_known_device = False

    def push(self, chunk: bytes) -> list[Reading]:
        """Split at the delimiters, and decode complete frames."""
        readings: list[Reading] = []
        *frames, pending = (self._pending + chunk).split(b"\0")
        for frame in frames:
            if frame:
                self._decode(frame, readings)
            self._overlong = False
        if len(pending) > MAX_FRAME_BYTES:
            self._overlong = True
            pending = pending[:1]  # enough to remember that this frame is not empty
        self._pending = pending
        return readings

    def _decode(self, frame: bytes, readings: list[Reading]) -> None:
        if self._overlong or len(frame) > MAX_FRAME_BYTES:
            self.counters.damaged += 1
            return
        try:
            body = cobs.decode(frame)
        except cobs.DecodeError:
            self.counters.damaged += 1
            return
        payload = body[:-2]
        if len(body) < 3 or crc_hqx(payload, CRC_INIT) != body[-2] | body[-1] << 8:
            self.counters.damaged += 1
        elif payload[0] == SAMPLE_TYPE and len(payload) == SAMPLE.size:
            self.counters.frames += 1
            self._sample(payload, readings)
        elif payload[0] == HELLO_TYPE and len(payload) == HELLO.size:
            self._hello(payload)
        else:
            self.counters.frames += 1
            self.counters.other_frames += 1

    def _hello(self, payload: bytes) -> None:
        _, version, sample_rate_hz, dps_per_lsb, encoder_cpr, device_id = HELLO.unpack(payload)
        if version != VERSION:
            self.counters.frames += 1
            self.counters.other_frames += 1
            return
        if not DPS_PER_LSB_MIN <= dps_per_lsb <= DPS_PER_LSB_MAX:
            self.counters.damaged += 1
            return
        self.counters.frames += 1
        device = DeviceDescription(
            device_id=_printable(device_id.rstrip(b"\0")),
            sample_rate_hz=float(sample_rate_hz) or None,
            dps_per_lsb=dps_per_lsb,
            encoder_cpr=encoder_cpr or None,
        )
        if not self._dps_per_lsb:
            self._is_known_device = device == self.device
        self.device = device
        self._dps_per_lsb = dps_per_lsb
        self._deg_per_count = 360.0 / encoder_cpr if encoder_cpr else 0.0

    def _sample(self, payload: bytes, readings: list[Reading]) -> None:
        if payload[1] & RATE_CLIPPED:
            self.counters.clipped += 1
        if not self._dps_per_lsb:
            self.counters.before_hello += 1
            self._waiting.append(payload)
            return
        if self._waiting:
            self._release(payload, readings)
        readings.append(self._reading(payload))

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
        breaks = (i for i in range(1, len(readings)) if not goes_on(readings[i - 1], readings[i], rate_hz))
        return max(breaks, default=0)

    def _reading(self, payload: bytes) -> Reading:
        _, flags, seq, t_us, rate_raw, temp_centi_c, encoder_counts = SAMPLE.unpack(payload)
        has_encoder = flags & ENCODER_VALID and self._deg_per_count
        return Reading(
            t_us,
            seq,
            rate_raw * self._dps_per_lsb,
            encoder_counts * self._deg_per_count if has_encoder else nan,
            temp_centi_c / 100.0 if flags & TEMPERATURE_VALID else nan,
            (1.0 if flags & STILL else 0.0) if flags & STILL_VALID else nan,
        )


def _printable(name: bytes) -> str:
    """Name with a replacement character for everything but printable ASCII."""
    return "".join(character if character.isprintable() else "\ufffd" for character in name.decode("ascii", "replace"))


PROTOCOL = WireProtocol(
    "native", "COBS frames with a CRC; HELLO tells the scale", NativeDecoder, has_clock=True, rank=0
)
