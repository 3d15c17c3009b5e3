"""Layout of a session file: MCAP without chunks, so that every flushed sample survives a kill.

A sample is a message on `/gyro`, CDR-encoded with the ROS 2 schema `gyrodrift/Sample`. All samples of a file have the
same size. It is larger for a device with three axes, and for one that sends its own yaw. A run of samples is a table
that numpy reads at once, also in an unfinished file. A torn end costs only the torn message. `/raw` has the bytes of
the link, a message per read. `/link` has link events as JSON. `/still` has rest flags from other sources than the rate.
"""

import struct
from dataclasses import dataclass, replace

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
AXES_SAMPLES = Topic(
    channel_id=SAMPLES.channel_id,
    name=SAMPLES.name,
    message_encoding=SAMPLES.message_encoding,
    schema_name=SAMPLES.schema_name,
    schema_encoding=SAMPLES.schema_encoding,
    schema_text=SAMPLES.schema_text
    + """\
# Sensor frame: right-handed, z up if the board lies flat. rate_dps is gyro_z_dps.
float64 gyro_x_dps
float64 gyro_y_dps
float64 gyro_z_dps
float64 accel_x_mps2  # specific force
float64 accel_y_mps2
float64 accel_z_mps2
""",
)
"""Samples of a device with three axes; a file has either these or `SAMPLES`."""

DEVICE_YAW_TEXT = """\
# Result of the device's own filter; NaN where a sample has none.
float64 device_yaw_deg
float64 device_yaw_sigma_deg
float64 device_bias_dps
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

MESSAGE_OPCODE = 5
CDR_LITTLE_ENDIAN = 0x00000100
"""The four bytes 00 01 00 00 before the values."""

MESSAGE = struct.Struct("<BQHIQQIqddddd")
"""A sample in the file: record head, channel, sequence, log and publish time in ns, CDR head, values."""
AXES_MESSAGE = struct.Struct(MESSAGE.format + "dddddd")
"""A sample of a device with three axes."""


@dataclass(frozen=True, slots=True)
class SampleLayout:
    """Layout of all samples of a file: their channel with its schema, and the bytes of a message."""

    topic: Topic
    message: struct.Struct


def _with_device_yaw(layout: SampleLayout) -> SampleLayout:
    topic = replace(layout.topic, schema_text=layout.topic.schema_text + DEVICE_YAW_TEXT)
    return SampleLayout(topic, struct.Struct(layout.message.format + "ddd"))


_LAYOUTS = (SampleLayout(SAMPLES, MESSAGE), SampleLayout(AXES_SAMPLES, AXES_MESSAGE))
LAYOUTS = {
    (bool(has_axes), has_device_yaw): _with_device_yaw(layout) if has_device_yaw else layout
    for has_axes, layout in enumerate(_LAYOUTS)
    for has_device_yaw in (False, True)
}
"""Layout by whether samples have three axes, and whether they have the device's own yaw."""

READ_HEAD = struct.Struct("<BQHIQQIdI")
"""A read up to its bytes; the last value is their number."""

LATEST_NS = 1 << 63
"""Times in message heads are clipped to this; the values of the samples are not."""

REPAIR, PROVED = "repair", "samples_proved"
"""Metadata table of a file that `repair` wrote, and its entry: "no" where no checksum proved the samples."""
