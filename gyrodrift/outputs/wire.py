"""Messages between the service and the process of the outputs: datagrams with a kind, on a socket pair.

Samples are packed, not text: it takes the loop that reads the port only a microsecond per sample. A batch in which a
sample has three axes is sent with longer records, of another kind.
"""

import json
from collections.abc import Iterator, Sequence
from math import nan
from struct import Struct
from typing import Any

from gyrodrift.sample import Attitude, Corrected, Inertial, Sample

SAMPLES = b"S"
AXES = b"X"
EVENT = b"E"
STATUS = b"T"
OUTPUTS = b"O"
DROPPED = b"D"
ACCESS = b"A"

RECORD = Struct("<q16d")
"""Fields of a sample before its axes, then of a corrected sample before its attitude."""

AXES_RECORD = Struct("<q16d6d11d2?")
"""A record, the axes of the sensor, the attitude, and whether the sample has them."""

RECORDS = {SAMPLES: RECORD, AXES: AXES_RECORD}
"""Layout of a sample by the kind of its message."""

MOST_RECORDS = 256
"""Most samples in a datagram."""

LONGEST_BYTES = 128 << 10
"""Longest datagram; the default of the kernel is 208 KiB."""

NO_AXES = Inertial(*(nan,) * len(Inertial._fields))
NO_ATTITUDE = Attitude(*(nan,) * len(Attitude._fields))

_pack = RECORD.pack


def pack_samples(samples: Sequence[Corrected]) -> bytes:
    """Pack at most MOST_RECORDS samples."""
    records = []
    for corrected in samples:
        sample = corrected[0]
        if sample[7] is not None or corrected[11] is not None:
            return AXES + b"".join([_with_axes(corrected) for corrected in samples])
        records.append(_pack(*sample[:7], *corrected[1:11]))
    return SAMPLES + b"".join(records)


def unpack_samples(message: bytes) -> list[Corrected]:
    """Unpack the samples of `pack_samples`."""
    records = RECORDS[message[:1]].iter_unpack(memoryview(message)[1:])
    if message[:1] == AXES:
        return [_of_axes(record) for record in records]
    return [Corrected(Sample(*record[:7]), *record[7:]) for record in records]


def count_samples(message: bytes) -> int:
    """Samples in a message; 0 for a message of another kind."""
    record = RECORDS.get(message[:1])
    return 0 if record is None else (len(message) - 1) // record.size


def _with_axes(corrected: Corrected) -> bytes:
    inertial, attitude = corrected.sample.inertial, corrected.attitude
    return AXES_RECORD.pack(
        *corrected.sample[:7],
        *corrected[1:11],
        *(inertial or NO_AXES),
        *(attitude or NO_ATTITUDE),
        inertial is not None,
        attitude is not None,
    )


def _of_axes(record: tuple[Any, ...]) -> Corrected:
    inertial = Inertial(*record[17:23]) if record[34] else None
    attitude = Attitude(*record[23:34]) if record[35] else None
    return Corrected._make((Sample._make((*record[:7], inertial)), *record[7:17], attitude))


def pack_json(kind: bytes, value: Any) -> bytes:
    """Pack a JSON value."""
    return kind + json.dumps(value, separators=(",", ":"), default=str).encode()


def unpack_json(message: bytes) -> Any:
    """Unpack the value of `pack_json`."""
    return json.loads(message[1:])


def batches(samples: Sequence[Corrected]) -> Iterator[Sequence[Corrected]]:
    """Samples in batches that fit into a datagram."""
    if len(samples) <= MOST_RECORDS:
        yield samples
        return
    for start in range(0, len(samples), MOST_RECORDS):
        yield samples[start : start + MOST_RECORDS]
