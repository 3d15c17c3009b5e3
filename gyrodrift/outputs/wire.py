"""Messages between the service and the process of the outputs: datagrams with a kind, on a socket pair.

Samples are packed, not text: it takes the loop that reads the port only a microsecond per sample. A batch in which a
sample has three axes or a device's own yaw is sent with longer records, of another kind.
"""

import json
from collections.abc import Iterator, Sequence
from itertools import islice
from math import nan
from struct import Struct
from typing import Any

from gyrodrift.values.aid import AidStatus
from gyrodrift.values.sample import NO_AXES, NO_YAW, Attitude, Corrected, Sample

SAMPLES = b"S"
EXTENDED = b"X"
EVENT = b"E"
STATUS = b"T"
OUTPUTS = b"O"
AIDED = b"I"
DROPPED = b"D"
ACCESS = b"A"

OWN = Sample._fields.index("inertial")
"""Number of values of a sample before its axes."""

RESULTS = Corrected._fields.index("attitude")
"""Index of the attitude: results before it, and behind the difference that follows it, go into every record."""

AIDS = Corrected._fields.index("aids")
PLAIN = OWN + len(Corrected._fields) - len(("sample", "attitude", "device_difference_deg", "aids"))
RECORD = Struct(f"<q{PLAIN - 1}d")
"""Values of a sample before its axes, then results of the filter."""

NO_ATTITUDE = Attitude(*(nan,) * len(Attitude._fields))
PARTS = (NO_AXES, NO_ATTITUDE, NO_YAW)

EXTENDED_RECORD = Struct(f"{RECORD.format}{sum(map(len, PARTS)) + 1}d{len(PARTS)}?")
"""A record, the axes of the sensor, the attitude, the result of the device's own filter and the difference from it. At
the end: whether the sample has axes, an attitude, a result."""

AIDS_LENGTH = Struct("<I")
"""Behind AIDED: bytes of a list as JSON, with the ages of the second sources of each sample. Then follows a message of
samples."""

RECORDS = {SAMPLES: RECORD, EXTENDED: EXTENDED_RECORD}
"""Layout of a sample by the kind of its message."""

SAMPLE_KINDS = frozenset((*RECORDS, AIDED))
"""Kinds of messages with samples."""

MOST_RECORDS, MOST_AIDED = 256, 64
"""Most samples in a datagram, and most with second sources, whose ages are text."""

LONGEST_BYTES = 128 << 10
"""Longest datagram; the default of the kernel is 208 KiB."""

_pack = RECORD.pack


def pack_samples(samples: Sequence[Corrected]) -> bytes:
    """Pack at most MOST_RECORDS samples; with the longer records if one of them has more than one axis measures."""
    if any(corrected[AIDS] is not None for corrected in samples):
        return _with_aids(samples)
    records = []
    for corrected in samples:
        sample = corrected[0]
        if (
            sample[7] is not None
            or sample[8] is not None
            or corrected[11] is not None
            or corrected[12] == corrected[12]
        ):
            return EXTENDED + b"".join(map(_extended, samples))
        records.append(_pack(*sample[:OWN], *corrected[1:RESULTS], *corrected[RESULTS + 2 : AIDS]))
    return SAMPLES + b"".join(records)


def unpack_samples(message: bytes) -> list[Corrected]:
    """Unpack the samples of `pack_samples`."""
    if message[:1] == AIDED:
        texts, records_of = _aided_parts(message)
        return [
            corrected._replace(aids={name: AidStatus(age_s, nan) for name, age_s in ages.items()} or None)
            for corrected, ages in zip(unpack_samples(records_of), json.loads(texts), strict=True)
        ]
    records = RECORDS[message[:1]].iter_unpack(memoryview(message)[1:])
    return [_corrected(record) if len(record) == PLAIN else _of_extended(record) for record in records]


def count_samples(message: bytes) -> int:
    """Samples in a message; 0 for a message of another kind."""
    message = _aided_parts(message)[1] if message[:1] == AIDED else message
    record = RECORDS.get(message[:1])
    return 0 if record is None else (len(message) - 1) // record.size


def _with_aids(samples: Sequence[Corrected]) -> bytes:
    """Message of samples with the ages of their second sources."""
    ages = [{name: status.age_s for name, status in (corrected.aids or {}).items()} for corrected in samples]
    text = json.dumps(ages, separators=(",", ":")).encode()
    without_aids = [corrected._replace(aids=None) for corrected in samples]
    return AIDED + AIDS_LENGTH.pack(len(text)) + text + pack_samples(without_aids)


def _aided_parts(message: bytes) -> tuple[bytes, bytes]:
    """Second sources as JSON, and the message of their samples."""
    start = 1 + AIDS_LENGTH.size
    end = start + AIDS_LENGTH.unpack_from(message, 1)[0]
    return message[start:end], message[end:]


def _extended(corrected: Corrected) -> bytes:
    sample, attitude = corrected.sample, corrected.attitude
    return EXTENDED_RECORD.pack(
        *sample[:OWN],
        *corrected[1:RESULTS],
        *corrected[RESULTS + 2 : AIDS],
        *(sample.inertial or NO_AXES),
        *(attitude or NO_ATTITUDE),
        *(sample.device_yaw or NO_YAW),
        corrected.device_difference_deg,
        sample.inertial is not None,
        attitude is not None,
        sample.device_yaw is not None,
    )


def _corrected(record: tuple[Any, ...], *parts: Any, difference_deg: float = nan) -> Corrected:
    """Sample of the plain values of a record, and its parts: axes, attitude and result of the device."""
    inertial, attitude, device_yaw = parts or (None, None, None)
    sample = Sample._make((*record[:OWN], inertial, device_yaw, ()))
    results = OWN + RESULTS - 1
    return Corrected._make((sample, *record[OWN:results], attitude, difference_deg, *record[results:PLAIN], None))


def _of_extended(record: tuple[Any, ...]) -> Corrected:
    values = iter(record[PLAIN:])
    parts = [type(part)(*islice(values, len(part))) for part in PARTS]
    difference_deg, *are_there = values
    present_parts = [part if is_there else None for part, is_there in zip(parts, are_there, strict=True)]
    return _corrected(record, *present_parts, difference_deg=difference_deg)


def pack_json(kind: bytes, value: Any) -> bytes:
    """Pack a JSON value."""
    return kind + json.dumps(value, separators=(",", ":"), default=str).encode()


def unpack_json(message: bytes) -> Any:
    """Unpack the value of `pack_json`."""
    return json.loads(message[1:])


def batches(samples: Sequence[Corrected]) -> Iterator[Sequence[Corrected]]:
    """Samples in batches that fit into a datagram."""
    most = MOST_RECORDS if not samples or samples[-1].aids is None else MOST_AIDED
    if len(samples) <= most:
        yield samples
        return
    for start in range(0, len(samples), most):
        yield samples[start : start + most]
