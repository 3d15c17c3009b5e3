"""What every decoder is: bytes are pushed in, readings come out, and what was damaged is counted.

A decoder never reads, waits or raises. It gives the same readings for any split of the stream, and keeps less
than five kilobytes between two pushes, beside samples whose scale is not known yet.
"""

from dataclasses import dataclass
from typing import Protocol

from gyrodrift.sample import Reading

MOST_HELD = 65_536
"""Samples that may wait for their scale; then the oldest goes for each that comes.

One turn of the 16-bit sample counter: more than a minute at 1 kHz, 6 s at 10 kHz, and at most 5 MB.
"""


@dataclass(slots=True)
class DecoderCounters:
    """What a decoder has seen.

    frames
        Good frames or lines, of any kind.
    damaged
        Frames or lines that failed their checksum, length or form.
    before_hello
        Good samples whose scale is not known: those that wait for it, and those that were dropped for the lack of it.
    late
        Good samples that waited for their scale and were handed on when it came.
    clipped
        Samples that the device marked as out of its range.
    other
        Good frames of kinds that carry no yaw rate.
    passed_over
        Names of other senders of a rate on the same line: one is listened to.
    """

    frames: int = 0
    damaged: int = 0
    before_hello: int = 0
    late: int = 0
    clipped: int = 0
    other: int = 0
    passed_over: frozenset[str] = frozenset()


@dataclass(frozen=True, slots=True)
class DeviceDescription:
    """What a device says of itself; None where its protocol has no word for it."""

    device_id: str | None = None
    sample_rate_hz: float | None = None
    dps_per_lsb: float | None = None
    encoder_cpr: int | None = None


class Decoder(Protocol):
    """A wire protocol, push-only."""

    name: str
    counters: DecoderCounters
    device: DeviceDescription

    def push(self, chunk: bytes) -> list[Reading]:
        """Take the next bytes of the stream and give the readings that they complete."""
        ...
