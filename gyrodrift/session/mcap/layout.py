"""Layout of a session file: MCAP without chunks, so that every flushed sample survives a kill.

A sample is a message on `/gyro`, CDR-encoded with the ROS 2 schema `gyrodrift/Sample`. All samples of a file have the
same size. It is larger for a device with three axes, and for one that sends its own yaw. A run of samples is a table
that numpy reads at once, also in an unfinished file. A torn end costs only the torn message. `/raw` has the bytes of
the link, a message per read. `/link` has link events as JSON. `/still` has rest flags from other sources than the rate,
and `/aid` what second sources measured.

Every byte has a CRC-32. A sample ends with its own. Other records are followed by a seal, a private record with theirs.
Neither depends on its position: bytes before it may be missing or doubled. Each checksum is XORed with the salt of the
recording. So no sample of another recording, and no bytes of a device, pass for a sample of this one.
"""

import struct
import zlib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from hashlib import blake2b
from itertools import product

MAGIC = b"\x89MCAP0\r\n"
HEAD = struct.Struct("<BQ")
"""Head of every record: opcode, and length of the rest."""

FOOTER_LENGTH = 20
CLOSED_TAIL = HEAD.pack(2, FOOTER_LENGTH)
"""Start of the footer of a finished file, `CLOSED_TAIL_BYTES` before its end."""
CLOSED_TAIL_BYTES = HEAD.size + FOOTER_LENGTH + len(MAGIC)


@dataclass(frozen=True, slots=True)
class Topic:
    """A channel of a session file and the schema of its messages."""

    channel_id: int
    name: str
    message_encoding: str
    schema_name: str
    schema_encoding: str
    schema_text: str


SAMPLES = Topic(
    channel_id=1,
    name="/gyro",
    message_encoding="cdr",
    schema_name="gyrodrift/Sample",
    schema_encoding="ros2msg",
    schema_text="""\
# A rate sample of a gyro. Angles are degrees, times seconds; NaN (seq: -1) where the device sends none.
int64 seq             # counter, unwrapped
float64 t_device_s    # the sensor's own clock, unwrapped
float64 t_host_s      # arrival, Unix time
float64 rate_dps      # counter-clockwise positive
float64 encoder_deg   # reference angle
float64 temp_c
""",
)
AXES_TEXT = """\
# Sensor frame: right-handed, z up if the board lies flat. rate_dps is gyro_z_dps.
float64 gyro_x_dps
float64 gyro_y_dps
float64 gyro_z_dps
float64 accel_x_mps2  # specific force
float64 accel_y_mps2
float64 accel_z_mps2
"""
DEVICE_YAW_TEXT = """\
# Result of the device's own filter; NaN where a sample has none.
float64 device_yaw_deg
float64 device_yaw_sigma_deg
float64 device_bias_dps
"""
CHECKSUM_TEXT = """\
uint32 crc32          # CRC-32 of the record before this field, XORed with a constant of the recording
"""

READS = Topic(
    channel_id=2,
    name="/raw",
    message_encoding="cdr",
    schema_name="gyrodrift/Read",
    schema_encoding="ros2msg",
    schema_text="""\
# The bytes that one read of the port gave.
float64 t_host_s      # when, Unix time
uint8[] content
""",
)
EVENTS = Topic(
    channel_id=3,
    name="/link",
    message_encoding="json",
    schema_name="gyrodrift.LinkEvent",
    schema_encoding="jsonschema",
    schema_text='{"type": "object", "properties": {"event": {"type": "string"}, "t_host_s": {"type": "number"}}}',
)
STILLS = Topic(
    channel_id=4,
    name="/still",
    message_encoding="json",
    schema_name="gyrodrift.Still",
    schema_encoding="jsonschema",
    schema_text='{"type": "object", '
    '"properties": {"sample": {"type": "integer"}, "still": {"type": ["number", "null"]}}}',
)
"""Rest flags: a message per change, with the number of the first sample that it applies to."""

AIDS = Topic(
    channel_id=5,
    name="/aid",
    message_encoding="json",
    schema_name="gyrodrift.Aid",
    schema_encoding="jsonschema",
    schema_text='{"type": "object", "properties": {"sample": {"type": "integer"}, "name": {"type": "string"}, '
    '"kind": {"type": "string"}, "value": {"type": "number"}, "t_s": {"type": "number"}}}',
)
"""Measurements of second sources, each with the number of the sample that it came with."""

MESSAGE_OPCODE = 5
CDR_LITTLE_ENDIAN = 0x00000100
"""The four bytes 00 01 00 00 before the values."""

MESSAGE_START = struct.Struct("<HIQQ")
"""A message after its record head, up to its content: channel, sequence, log and publish time in ns."""

CRC_BYTES = 4
SAMPLE_HEAD = "<BQHIQQI"
"""Record head, channel, number of the sample in the file, log and publish time in ns, CDR head."""


@dataclass(frozen=True, slots=True)
class SampleLayout:
    """Layout of all samples of a file.

    topic
        Their channel with its schema.
    values
        Bytes of a message up to its checksum.
    message
        All bytes of a message.
    """

    topic: Topic
    values: struct.Struct
    message: struct.Struct


KINDS = tuple(product((False, True), repeat=3))
"""Kinds of samples: whether they have three axes, the device's own yaw, and a checksum each.

Earlier versions wrote no checksum in a sample, but tables of checksums between the samples.
"""


def _layout(has_axes: bool, has_device_yaw: bool, has_checksum: bool) -> SampleLayout:  # noqa: FBT001 - a kind
    text = SAMPLES.schema_text + AXES_TEXT * has_axes + DEVICE_YAW_TEXT * has_device_yaw + CHECKSUM_TEXT * has_checksum
    values = SAMPLE_HEAD + "qddddd" + "dddddd" * has_axes + "ddd" * has_device_yaw
    message = struct.Struct(values + "I" * has_checksum)
    return SampleLayout(replace(SAMPLES, schema_text=text), struct.Struct(values), message)


LAYOUTS = {kind: _layout(*kind) for kind in KINDS}
"""Layout of samples by their kind."""

MESSAGE = LAYOUTS[False, False, True].message
"""A sample of a device with one axis, as this version writes it."""

READ_HEAD = struct.Struct("<BQHIQQIdI")
"""A read up to its bytes; the last value is their number."""

LATEST_NS = 1 << 63
LATEST_S = LATEST_NS * 1e-9
"""Times in message heads are clipped to this; the values of the samples are not."""

SEAL_OPCODE = 0x94
"""In the range of the MCAP specification for applications, 0x80 to 0xFF, which MCAP readers skip."""

SEAL = struct.Struct("<BQQQQ")
"""A seal up to its checksum: record head, number of the seal, bytes of the records right before it, samples so far."""

SEAL_BYTES = SEAL.size + CRC_BYTES
SEAL_START = HEAD.pack(SEAL_OPCODE, SEAL_BYTES - HEAD.size)

REPAIR, PROVED = "repair", "samples_proved"
"""Metadata table of a file that `repair` wrote, and its entry: "no" where no checksum proved the samples."""


def salt_of(metadata: Mapping[str, Mapping[str, str]]) -> int:
    """Salt of a recording, from its tables, which a device does not know."""
    text = repr(metadata).encode(errors="backslashreplace")
    return int.from_bytes(blake2b(text, digest_size=CRC_BYTES).digest())


def seal(number: int, content: bytes, samples: int, salt: int) -> bytes:
    """The seal of the records right before it.

    Parameters
    ----------
    number
        Number of seals before it.
    content
        Bytes of the records.
    samples
        Number of samples before it.
    salt
        Salt of the recording.
    """
    start = SEAL.pack(SEAL_OPCODE, SEAL_BYTES - HEAD.size, number, len(content), samples)
    return start + (zlib.crc32(start, zlib.crc32(content)) ^ salt).to_bytes(CRC_BYTES, "little")
