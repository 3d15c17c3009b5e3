"""Messages between the service and the process of the outputs: datagrams with a kind, on a socket pair.

Samples are packed, not text: it takes the loop that reads the port only a microsecond per sample.
"""

import json
from collections.abc import Iterator, Sequence
from struct import Struct
from typing import Any

from gyrodrift.sample import Corrected, Sample

SAMPLES = b"S"
EVENT = b"E"
STATUS = b"T"
OUTPUTS = b"O"
DROPPED = b"D"
ACCESS = b"A"

RECORD = Struct("<q16d")
SAMPLE_NUMBERS, CORRECTED_NUMBERS = 7, 11
"""Fields of a sample before its axes, and of a corrected sample before its attitude."""

MOST_RECORDS = 256
"""Most samples in a datagram."""

LONGEST_BYTES = 128 << 10
"""Longest datagram; the default of the kernel is 208 KiB."""

_pack = RECORD.pack


def pack_samples(samples: Sequence[Corrected]) -> bytes:
    """Pack at most MOST_RECORDS samples."""
    return SAMPLES + b"".join([_packed(corrected) for corrected in samples])


def unpack_samples(message: bytes) -> list[Corrected]:
    """Unpack the samples of `pack_samples`."""
    return [
        Corrected(Sample(*record[:SAMPLE_NUMBERS]), *record[SAMPLE_NUMBERS:])
        for record in RECORD.iter_unpack(memoryview(message)[1:])
    ]


def _packed(corrected: Corrected) -> bytes:
    return _pack(*corrected[0][:SAMPLE_NUMBERS], *corrected[1:CORRECTED_NUMBERS])


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
