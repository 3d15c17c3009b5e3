"""Samples of an MCAP file that is still being written, from its bytes as they come."""

import json
import math
from collections import deque
from collections.abc import Iterator
from io import BytesIO

from mcap.opcode import Opcode
from mcap.records import Channel, Schema

from gyrodrift.io.files import OPENED_BYTES
from gyrodrift.session.foreign.channels import UNDERSTOOD, Messages
from gyrodrift.session.foreign.columns import Decode, WrongValueError
from gyrodrift.session.foreign.read import decoder_of
from gyrodrift.session.foreign.records import ForeignRecord, framed, message, opened
from gyrodrift.session.mcap.layout import AIDS, HEAD, MAGIC, SAMPLES, STILLS
from gyrodrift.session.mcap.walk import BrokenRecordError, aid_in, channel_of, metadata_of, schema_of, still_of
from gyrodrift.values.aid import Aid
from gyrodrift.values.errors import DataError
from gyrodrift.values.sample import Sample

LONGEST_RECORD_BYTES = OPENED_BYTES
"""Longest record that is waited for: the limit of a chunk of a short file."""

UNREAD_MAX, FIELDS_MAX = 8, 16
"""Largest number of topics, and of fields of a message, that are named."""

RECORDS_MAX, PUSH_BYTES = 1024, 1 << 20
"""Largest number of records of a push, about 8 ms, and largest size of chunks that are opened in it, about 2 ms."""

STILLS_MAX = AIDS_MAX = 1 << 18
"""Largest number of rest flags for later samples; a recorder writes a flag right before its sample."""


class SampleStream:
    """Splits the bytes of a file into samples, in any pieces, a limited number of records at a time.

    The channel `/gyro` is read, or else the first one that can be read.

    damaged
        Number of messages that are no samples.
    device
        Table `device` of our own recordings.
    other_topics
        Topics that could be read too, and are ignored.
    unread_contents
        Contents of the file that cannot be read, and what is needed instead; empty after the first sample, and before
        the first message.
    """

    def __init__(self, name: str) -> None:
        self.damaged = 0
        self.is_behind = False
        self.device: dict[str, str] = {}
        self.other_topics: frozenset[str] = frozenset()
        self._name = name
        self._pending = bytearray()
        self._has_magic = False
        self._opened: Iterator[ForeignRecord] = iter(())
        self._schemas: dict[int, Schema] = {}
        self._channels: dict[int, Channel] = {}
        self._topic: str | None = None
        self._decoders: dict[int, Decode | None] = {}
        self._stills: deque[tuple[int, float]] = deque(maxlen=STILLS_MAX)
        self._aids: deque[tuple[int, Aid]] = deque(maxlen=AIDS_MAX)
        self._still = math.nan
        self._count = 0
        self._unread: dict[str, str] = {}

    @property
    def unread_contents(self) -> str:  # noqa: D102 - above
        if self._count or not self._unread:
            return ""
        topics = "; ".join(self._unread.values())
        ellipsis = "; …" if len(self._unread) == UNREAD_MAX else ""
        return f"it has messages, but no samples: {topics}{ellipsis}; expected {UNDERSTOOD}"

    def push(self, chunk: bytes) -> list[Sample]:
        """Samples of the next records that are complete now.

        Raises
        ------
        DataError
            It is no MCAP file, or damaged: nothing after this can be read.
        """
        self._pending += chunk
        if not self._has_magic and len(self._pending) >= len(MAGIC):
            if bytes(self._pending[: len(MAGIC)]) != MAGIC:
                raise DataError(f"{self._name}: is no MCAP file: it does not begin as one")
            del self._pending[: len(MAGIC)]
            self._has_magic = True
        try:
            return self._next_samples()
        except BrokenRecordError as error:
            raise DataError(f"{self._name}: is damaged: {error}") from error

    def _next_samples(self) -> list[Sample]:
        samples: list[Sample] = []
        opened_bytes = records = 0
        while opened_bytes < PUSH_BYTES and records < RECORDS_MAX:
            record = next(self._opened, None) or self._cut()
            if record is None:
                self.is_behind = False
                return samples
            if record.opcode == Opcode.CHUNK:
                opened_bytes += self._open(record)
            else:
                samples += self._samples_of(record)
            records += 1
        self.is_behind = True
        return samples

    def _cut(self) -> ForeignRecord | None:
        """The next whole record of the file; None until more of it is there."""
        if not self._has_magic or len(self._pending) < HEAD.size:
            return None
        opcode, length = HEAD.unpack_from(self._pending)
        if length > LONGEST_RECORD_BYTES:
            raise BrokenRecordError(f"a record claims {length} bytes, at most {LONGEST_RECORD_BYTES} are read")
        end = HEAD.size + length
        if end > len(self._pending):
            return None
        body = bytes(self._pending[HEAD.size : end])
        del self._pending[:end]
        return ForeignRecord(opcode, body, is_whole=True)

    def _open(self, chunk: ForeignRecord) -> int:
        """Read on in a chunk; its size."""
        content = opened(chunk, LONGEST_RECORD_BYTES)
        inner = framed(BytesIO(content), len(content), is_torn=False)
        self._opened = (record for record in inner if record.opcode != Opcode.CHUNK)  # no chunk holds chunks
        return len(content)

    def _samples_of(self, record: ForeignRecord) -> list[Sample]:
        match record.opcode:
            case Opcode.MESSAGE:
                return self._sample(record.body)
            case Opcode.SCHEMA:
                schema = schema_of(record.body)
                self._schemas[schema.id] = schema
            case Opcode.CHANNEL:
                self._declare(channel_of(record.body))
            case Opcode.METADATA:
                table = metadata_of(record.body)
                if table.name == "device":
                    self.device = dict(table.metadata)
        return []

    def _declare(self, channel: Channel) -> None:
        self._channels[channel.id] = channel
        self._decoders.pop(channel.id, None)
        if channel.topic == SAMPLES.name and not self._count:
            self._topic = channel.topic
            self._decoders.clear()

    def _sample(self, body: bytes) -> list[Sample]:
        channel_id, log_ns, payload = message(body)
        channel = self._channels.get(channel_id)
        if channel is None:
            raise BrokenRecordError(f"it has messages of channel {channel_id}, which is not declared")
        if channel.topic in (STILLS.name, AIDS.name):
            self._take_flag(channel.topic, payload)
            return []
        decode = self._decoder(channel)
        if decode is None:
            self._note(channel, "")
            return []
        try:
            sample = decode(payload, log_ns)
        except WrongValueError as error:
            self.damaged += 1
            self._note(channel, f": a message {error}{_fields(payload)}")
            return []
        return [self._with_still(sample)]

    def _note(self, channel: Channel, reason: str) -> None:
        """Note a channel whose messages cannot be read."""
        if not self._count and len(self._unread) < UNREAD_MAX:
            messages = Messages(channel.topic, channel.message_encoding, self._schemas.get(channel.schema_id), 0)
            self._unread.setdefault(channel.topic, f"{messages}{reason}")

    def _decoder(self, channel: Channel) -> Decode | None:
        """Decoder of a channel; None if it is ignored."""
        if channel.id not in self._decoders:
            schema = self._schemas.get(channel.schema_id)
            messages = Messages(channel.topic, channel.message_encoding, schema, 0)
            is_read = messages.is_understood and self._topic in (None, channel.topic)
            if messages.is_understood and not is_read:
                self.other_topics |= {channel.topic}
            if is_read:
                self._topic = channel.topic
            self._decoders[channel.id] = decoder_of(f"{self._name}: {channel.topic}", messages) if is_read else None
        return self._decoders[channel.id]

    def _take_flag(self, topic: str, payload: bytes) -> None:
        """Keep a rest flag or a measurement of a second source for the next samples; it has its own time."""
        try:
            if topic == STILLS.name:
                self._stills.append(still_of(payload))
            else:
                self._aids.append(aid_in(payload))
        except BrokenRecordError:
            self.damaged += 1

    def _with_still(self, sample: Sample) -> Sample:
        """Sample with the flag that holds from an earlier one on, and with its second sources."""
        while self._stills and self._stills[0][0] <= self._count:
            self._still = self._stills.popleft()[1]
        self._count += 1
        aids = []
        while self._aids and self._aids[0][0] < self._count:
            aids.append(self._aids.popleft()[1])
        if aids:
            sample = sample._replace(aids=tuple(aids))
        return sample if math.isnan(self._still) else sample._replace(still=self._still)


def _fields(payload: bytes) -> str:
    """Names of the fields of a JSON object, in words; empty for another message."""
    try:
        content = json.loads(payload)
    except (ValueError, RecursionError):
        return ""
    if not isinstance(content, dict):
        return ""
    names = list(map(str, content))
    return f", its fields are {', '.join(names[:FIELDS_MAX])}{', …' if len(names) > FIELDS_MAX else ''}"
