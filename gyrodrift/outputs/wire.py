"""What goes between the service and the outputs' process: datagrams of a kind and a content, on a socket pair.

Samples are packed and not written as text: handing one over costs the loop that reads the port a microsecond.
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
MOST_RECORDS = 256
"""In a datagram."""

LONGEST_BYTES = 128 << 10
"""Of a datagram; the kernel's default takes 208 KiB."""

_pack = RECORD.pack


def pack_samples(samples: Sequence[Corrected]) -> bytes:
    """No more than MOST_RECORDS of them."""
    return SAMPLES + b"".join([_pack(*each[0], *each[1:]) for each in samples])


def unpack_samples(message: bytes) -> list[Corrected]:
    """What `pack_samples` packed."""
    return [Corrected(Sample(*record[:7]), *record[7:]) for record in RECORD.iter_unpack(memoryview(message)[1:])]


def pack_json(kind: bytes, value: Any) -> bytes:
    """Anything else."""
    return kind + json.dumps(value, separators=(",", ":"), default=str).encode()


def unpack_json(message: bytes) -> Any:
    """What `pack_json` packed."""
    return json.loads(message[1:])


def batches(samples: Sequence[Corrected]) -> Iterator[Sequence[Corrected]]:
    """Samples in handfuls that fit a datagram."""
    if len(samples) <= MOST_RECORDS:
        yield samples
        return
    for at in range(0, len(samples), MOST_RECORDS):
        yield samples[at : at + MOST_RECORDS]
