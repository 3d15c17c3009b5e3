"""The native protocol: COBS frames with a CRC, HELLO once a second and SAMPLE for every measurement.

Only HELLO says what a count is. Samples before it are held back with their counts, and scaled when it comes.
"""

from binascii import crc_hqx
from collections import deque
from math import nan
from struct import Struct

from cobs import cobs

from gyrodrift.link.protocols.decoder import MOST_HELD, DecoderCounters, DeviceDescription
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

LEAST_DPS_PER_LSB, MOST_DPS_PER_LSB = 1e-9, 10.0
"""Far outside of what 16 bits are used for: a HELLO beyond is none, since every rate would be wrong by its scale."""

MAX_FRAME_BYTES = HELLO.size + CRC.size + 1
"""The longest frame before its delimiter; COBS adds one byte to payloads as short as these."""


class NativeDecoder:
    """Frames between zero bytes; a damaged one costs itself alone, since every zero starts afresh."""

    name = "native"

    def __init__(self) -> None:
        self.counters = DecoderCounters()
        self.device = DeviceDescription()
        self._pending = b""
        self._overlong = False
        self._dps_per_lsb = 0.0
        self._deg_per_count = 0.0
        self._held: deque[bytes] = deque(maxlen=MOST_HELD)
        self._is_known_device = False

    def push(self, chunk: bytes) -> list[Reading]:
        """Split at the delimiters and decode each whole frame."""
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
            self.counters.other += 1

    def _hello(self, payload: bytes) -> None:
        _, version, sample_rate_hz, dps_per_lsb, encoder_cpr, device_id = HELLO.unpack(payload)
        if version != VERSION:
            self.counters.frames += 1
            self.counters.other += 1
            return
        if not LEAST_DPS_PER_LSB <= dps_per_lsb <= MOST_DPS_PER_LSB:
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
            self._held.append(payload)
            return
        if self._held:
            self._release(payload, readings)
        readings.append(self._reading(payload))

    def _release(self, payload: bytes, readings: list[Reading]) -> None:
        """Scale what was held back, now that the first sample after HELLO has come.

        All of it is of the device that said HELLO where that device was known before, since nobody exchanges a device
        twice between two frames. Otherwise only what leads up to this sample without a break is. The rest stays counted
        as `before_hello`.
        """
        held = [self._reading(each) for each in (*self._held, payload)]
        self._held.clear()
        late = held[0 if self._is_known_device else self._last_break(held) : -1]
        readings += late
        self.counters.before_hello -= len(late)
        self.counters.late += len(late)

    def _last_break(self, readings: list[Reading]) -> int:
        """Index of the reading that does not go on from the one before it, 0 where all do; of several the last."""
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
    """A name goes to terminals, files and pages: what is no printable ASCII in it is told from what is."""
    return "".join(each if each.isprintable() else "\ufffd" for each in name.decode("ascii", "replace"))


PROTOCOL = WireProtocol(
    "native", "COBS frames with a CRC; HELLO tells the scale", NativeDecoder, has_clock=True, rank=0
)
