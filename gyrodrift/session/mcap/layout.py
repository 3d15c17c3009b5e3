"""What stands in a session file: MCAP without chunks, so that every flushed sample survives whatever happens.

A sample is one message of fixed size on `/gyro`, CDR-encoded with the ROS 2 schema `gyrodrift/Sample`: a run of
them is a table that numpy reads in one look, finished or not, and a torn tail costs the torn message alone.
`/raw` holds the bytes of the link, one message a read; `/link` what happened on it, as JSON; `/still` what something
else than the rate said of rest.
"""

import struct
from dataclasses import dataclass

MAGIC = b"\x89MCAP0\r\n"
HEAD = struct.Struct("<BQ")
"""What every record begins with: its opcode and the length of the rest."""

FOOTER_LENGTH = 20
CLOSED_TAIL = HEAD.pack(2, FOOTER_LENGTH)
"""Where the footer of a finished file begins: `CLOSED_TAIL_BYTES` before its end."""
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
"""What was said from outside of rest: a message where it changes, with the number of the first sample it holds for."""

MESSAGE_OPCODE = 5
CDR_LITTLE_ENDIAN = 0x00000100
"""The four bytes 00 01 00 00 before the values."""

MESSAGE = struct.Struct("<BQHIQQIqddddd")
"""A sample as it stands in the file: record head, channel, sequence, log and publish time in ns, CDR head, values."""
MESSAGE_LENGTH = MESSAGE.size - HEAD.size

READ_HEAD = struct.Struct("<BQHIQQIdI")
"""A read up to its bytes; the last value is how many there are."""

LATEST_NS = 1 << 63
"""A time that leaves this range or is not finite is cut to it in the message heads; the values stay as they are."""
