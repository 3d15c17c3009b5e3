"""Encoder of gyrodrift's native protocol for MicroPython: HELLO with SAMPLE or SAMPLE3, framed by COBS, with a CRC.

A device that runs a filter sends HELLO of version 3, and YAW right after the sample that it belongs to.

Garbage collection takes as long as one or two samples. So frames are written in place, and no number is larger than 30
bits.
"""

import struct
from array import array

HELLO_FRAME = 32
"""Bytes on the wire, with the delimiter."""

SAMPLE_FRAME = 20
HELLO3_FRAME = 37
SAMPLE3_FRAME = 30
HELLO_FILTER_FRAME = 38
YAW_FRAME = 24

ENCODER_VALID = 0x01
TEMPERATURE_VALID = 0x02
RATE_CLIPPED = 0x04
ACCEL_VALID = 0x10
ACCEL_CLIPPED = 0x40
"""Flags of a sample; the last two are of SAMPLE3."""

FILTER_NONE = 0
FILTER_HDR = 1
FILTER_RESTLEVEL = 2
FILTER_ATTITUDE = 3
"""Filter of HELLO version 3."""

HELLO_TYPE = 0x01
SAMPLE_TYPE = 0x02
SAMPLE3_TYPE = 0x03
YAW_TYPE = 0x04
VERSION = 1
AXES_VERSION = 2
FILTER_VERSION = 3
AXES = 3
PAYLOAD_AT = 1
"""Index after the first distance of COBS."""

AXES_AT = PAYLOAD_AT + 8
TEMPERATURE_AT = AXES_AT + 12
"""Indices in SAMPLE3."""


def _crc_of_byte(byte: int) -> int:
    crc = byte << 8
    for _ in range(8):
        crc = crc << 1 ^ (0x1021 if crc & 0x8000 else 0)
    return crc & 0xFFFF


CRC_TABLE = array("H", [_crc_of_byte(byte) for byte in range(256)])
"""CRC-16/CCITT-FALSE."""


class FrameWriter:
    """Writes frames into one buffer. A returned frame is valid until the next call."""

    def __init__(self) -> None:
        self._frame = bytearray(HELLO_FILTER_FRAME)
        self._hello_filter = memoryview(self._frame)
        self._hello3 = self._hello_filter[:HELLO3_FRAME]
        self._hello = self._hello_filter[:HELLO_FRAME]
        self._sample = self._hello_filter[:SAMPLE_FRAME]
        self._sample3 = self._hello_filter[:SAMPLE3_FRAME]
        self._yaw = self._hello_filter[:YAW_FRAME]

    def hello(self, sample_rate_hz: int, dps_per_lsb: float, encoder_cpr: int, device_id: str) -> memoryview:
        """HELLO, to send at boot and once a second. `device_id` is ASCII, cut after 16 characters."""
        name = device_id.encode()[:16]
        fields = (HELLO_TYPE, VERSION, sample_rate_hz, dps_per_lsb, encoder_cpr, name)
        struct.pack_into("<BBHfI16s", self._frame, PAYLOAD_AT, *fields)
        return self._framed(self._hello)

    def hello3(
        self, sample_rate_hz: int, dps_per_lsb: float, encoder_cpr: int, device_id: str, mps2_per_lsb: float
    ) -> memoryview:
        """HELLO of three axes; `mps2_per_lsb` is 0 without an accelerometer."""
        name = device_id.encode()[:16]
        fields = (HELLO_TYPE, AXES_VERSION, sample_rate_hz, dps_per_lsb, encoder_cpr, name, mps2_per_lsb, AXES)
        struct.pack_into("<BBHfI16sfB", self._frame, PAYLOAD_AT, *fields)
        return self._framed(self._hello3)

    def hello_filter(
        self,
        sample_rate_hz: int,
        dps_per_lsb: float,
        encoder_cpr: int,
        device_id: str,
        axes: int,
        mps2_per_lsb: float,
        filter_number: int,
    ) -> memoryview:
        """HELLO of a device that runs a filter; `axes` is 1 or 3, `mps2_per_lsb` 0 without an accelerometer."""
        name = device_id.encode()[:16]
        fields = (HELLO_TYPE, FILTER_VERSION, sample_rate_hz, dps_per_lsb, encoder_cpr, name, mps2_per_lsb)
        struct.pack_into("<BBHfI16sfBB", self._frame, PAYLOAD_AT, *fields, axes, filter_number)
        return self._framed(self._hello_filter)

    def sample(
        self, flags: int, seq: int, t_us: list, rate_raw: int, temp_centi_c: int, encoder_counts: int = 0
    ) -> memoryview:
        """SAMPLE of one measurement. `t_us` is the device clock as two numbers of 16 bits, the low half first."""
        low, high = t_us
        into = self._frame
        struct.pack_into(
            "<BBHHHhhi", into, PAYLOAD_AT, SAMPLE_TYPE, flags, seq, low, high, rate_raw, temp_centi_c, encoder_counts
        )
        return self._framed(self._sample)

    def sample3(
        self, flags: int, seq: int, t_us: list, axes: object, temp_centi_c: int, encoder_counts: int = 0
    ) -> memoryview:
        """SAMPLE3 of one measurement. `axes` are six counts: rates about x, y and z, then accelerations along them."""
        into = self._frame
        struct.pack_into("<BBHHH", into, PAYLOAD_AT, SAMPLE3_TYPE, flags, seq, t_us[0], t_us[1])
        struct.pack_into("<hhhhhh", into, AXES_AT, axes[0], axes[1], axes[2], axes[3], axes[4], axes[5])
        struct.pack_into("<hi", into, TEMPERATURE_AT, temp_centi_c, encoder_counts)
        return self._framed(self._sample3)

    def yaw(self, seq: int, t_us: list, yaw_deg: float, yaw_sigma_deg: float, bias_dps: float) -> memoryview:
        """YAW of the sample with this `seq` and `t_us`. The yaw is unwrapped; its sigma is NaN if there is none."""
        low, high = t_us
        into = self._frame
        struct.pack_into("<BBHHHfff", into, PAYLOAD_AT, YAW_TYPE, 0, seq, low, high, yaw_deg, yaw_sigma_deg, bias_dps)
        return self._framed(self._yaw)

    def _framed(self, view: memoryview) -> memoryview:
        frame, table = self._frame, CRC_TABLE
        crc_at = len(view) - 3
        crc = 0xFFFF
        for index in range(PAYLOAD_AT, crc_at):
            crc = (crc << 8 & 0xFFFF) ^ table[crc >> 8 ^ frame[index]]
        frame[crc_at] = crc & 0xFF
        frame[crc_at + 1] = crc >> 8
        run = 0  # index of the distance to the next zero
        for index in range(PAYLOAD_AT, crc_at + 2):
            if frame[index] == 0:
                frame[run] = index - run
                run = index
        frame[run] = crc_at + 2 - run
        frame[crc_at + 2] = 0
        return view
