"""Messages between the service and the process of the outputs: datagrams with a kind, on a socket pair.

Samples are packed, not text: it takes the loop that reads the port only a microsecond per sample. A batch in which a
sample has three axes or a device's own yaw is sent with longer records, of another kind.
"""

import json
from collections.abc import Iterator, Sequence
from math import nan
from struct import Struct
from typing import Any

from gyrodrift.values.sample import Attitude, Corrected, DeviceYaw, Inertial, Sample

SAMPLES = b"S"
AXES = b"X"
DEVICE_YAW = b"Y"
EVENT = b"E"
STATUS = b"T"
OUTPUTS = b"O"
DROPPED = b"D"
ACCESS = b"A"

RECORD = Struct("<q16d")
"""Fields of a sample before its axes, then of a corrected sample before its attitude."""

AXES_RECORD = Struct("<q16d6d11d2?")
"""A record, the axes of the sensor, the attitude, and whether the sample has them."""

DEVICE_YAW_RECORD = Struct(AXES_RECORD.format + "4d?")
"""A record with axes, the result of the device's own filter, the difference, and whether the sample has a result."""

RECORDS = {SAMPLES: RECORD, AXES: AXES_RECORD, DEVICE_YAW: DEVICE_YAW_RECORD}
"""Layout of a sample by the kind of its message."""

MOST_RECORDS = 256
"""Most samples in a datagram."""

LONGEST_BYTES = 128 << 10
"""Longest datagram; the default of the kernel is 208 KiB."""

NO_AXES = Inertial(*(nan,) * len(Inertial._fields))
NO_ATTITUDE = Attitude(*(nan,) * len(Attitude._fields))
NO_YAW = DeviceYaw(nan, nan, nan)

_pack = RECORD.pack


def pack_samples(samples: Sequence[Corrected]) -> bytes:
    """Pack at most MOST_RECORDS samples."""
    records = []
    for corrected in samples:
        sample = corrected[0]
        if sample[7] is not None or corrected[11] is not None or _is_compared(corrected):
            return _pack_long(samples)
        records.append(_pack(*sample[:7], *corrected[1:11]))
    return SAMPLES + b"".join(records)


def _pack_long(samples: Sequence[Corrected]) -> bytes:
    """Pack samples of which one has axes or the device's own yaw."""
    if any(map(_is_compared, samples)):
        return DEVICE_YAW + b"".join([_with_yaw(corrected) for corrected in samples])
    return AXES + b"".join([_with_axes(corrected) for corrected in samples])


def unpack_samples(message: bytes) -> list[Corrected]:
    """Unpack the samples of `pack_samples`."""
    records = RECORDS[message[:1]].iter_unpack(memoryview(message)[1:])
    if message[:1] == AXES:
        return [_of_axes(record) for record in records]
    if message[:1] == DEVICE_YAW:
        return [_of_yaw(record) for record in records]
    return [Corrected(Sample(*record[:7]), *record[7:]) for record in records]


def count_samples(message: bytes) -> int:
    """Samples in a message; 0 for a message of another kind."""
    record = RECORDS.get(message[:1])
    return 0 if record is None else (len(message) - 1) // record.size


def _is_compared(corrected: Corrected) -> bool:
    """Whether the device sends its own yaw."""
    return corrected[0][8] is not None or corrected[12] == corrected[12]


def _with_axes(corrected: Corrected) -> bytes:
    return AXES_RECORD.pack(*_axes_values(corrected))


def _with_yaw(corrected: Corrected) -> bytes:
    device_yaw = corrected.sample.device_yaw
    own = (*(device_yaw or NO_YAW), corrected.device_difference_deg)
    return DEVICE_YAW_RECORD.pack(*_axes_values(corrected), *own, device_yaw is not None)


def _axes_values(corrected: Corrected) -> tuple[float, ...]:
    """Values of a record with axes."""
    inertial, attitude = corrected.sample.inertial, corrected.attitude
    return (
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
    return Corrected._make((Sample._make((*record[:7], inertial, None)), *record[7:17], attitude, nan))


def _of_yaw(record: tuple[Any, ...]) -> Corrected:
    corrected = _of_axes(record)
    device_yaw = DeviceYaw(*record[36:39]) if record[40] else None
    sample = corrected.sample._replace(device_yaw=device_yaw)
    difference_deg = record[39]
    is_known = difference_deg == difference_deg  # noqa: PLR0124 - not NaN
    return corrected._replace(sample=sample, device_difference_deg=difference_deg if is_known else nan)


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
