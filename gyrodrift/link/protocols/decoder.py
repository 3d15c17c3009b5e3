"""Decoder of a wire protocol: bytes in, readings out, damage counted.

A decoder never reads, waits or raises. Its readings do not depend on how the stream is split. Between two pushes it
keeps less than 5 kB, and the samples that wait for their scale.
"""

from dataclasses import dataclass
from typing import Any, Protocol

from gyrodrift.values.sample import Reading

WAITING_MAX = 65_536
"""Largest number of samples that wait for their scale; then the oldest are dropped.

One turn of the 16-bit sample counter: more than a minute at 1 kHz, 6 s at 10 kHz, and at most 5 MB.
"""

ANGLES_BEFORE = 5
"""Angles without a rate before the angle is chosen: devices that send both alternate."""


@dataclass(slots=True)
class DecoderCounters:
    """Counters of a decoder.

    frames
        Good frames or lines, of any kind.
    damaged
        Frames or lines that failed their checksum, length or form.
    before_hello
        Good samples without a known scale: waiting or dropped.
    late
        Good samples that waited for their scale, and got it.
    clipped
        Samples with a rate or an acceleration that the device marked as out of range.
    other_frames
        Good frames without a yaw rate.
    lone_yaws
        Good frames with the device's own yaw but without its sample, or before the device said that it runs a filter.
    passed_over
        Names of further talkers with a rate on the same line, which are ignored.
    """

    frames: int = 0
    damaged: int = 0
    before_hello: int = 0
    late: int = 0
    clipped: int = 0
    other_frames: int = 0
    lone_yaws: int = 0
    passed_over: frozenset[str] = frozenset()


@dataclass(frozen=True, slots=True)
class DeviceDescription:
    """Description that a device sends; None if its protocol has no such field.

    axes
        Number of gyro axes, 1 or 3.
    mps2_per_lsb
        One count of an acceleration, m/s².
    device_filter
        Name of the filter that the device runs itself.
    """

    device_id: str | None = None
    sample_rate_hz: float | None = None
    dps_per_lsb: float | None = None
    encoder_cpr: int | None = None
    axes: int | None = None
    mps2_per_lsb: float | None = None
    device_filter: str | None = None


class CountingDecoder:
    """Base of all decoders: counters, the description of the device, and why what came cannot be read.

    is_behind
        Whether a push is complete only after further pushes of no bytes; each of them is short, whatever the content.
    """

    name: str
    unread: str = ""
    is_behind: bool = False

    def __init__(self) -> None:
        self.counters = DecoderCounters()
        self.device = DeviceDescription()

    def count(self, reading: Reading | None, readings: list[Reading]) -> None:
        """Count a good frame, and keep its reading; None for a frame without a rate."""
        self.counters.frames += 1
        if reading is None:
            self.counters.other_frames += 1
        else:
            readings.append(reading)


class Decoder(Protocol):
    """Decoder of a wire protocol."""

    name: str
    counters: DecoderCounters
    device: DeviceDescription
    unread: str

    def push(self, chunk: Any) -> list[Reading]:
        """Decode the next bytes of the stream, or the next batch of a source of readings; return the readings."""
        ...


class RateOrAngle:
    """Choice for the whole stream: the rate, unless ANGLES_BEFORE angles came without one."""

    def __init__(self) -> None:
        self._has_rate = False
        self._angles = 0

    @property
    def is_angle(self) -> bool:
        """Whether the angle has been chosen."""
        return self._angles > ANGLES_BEFORE

    def offer_rate(self) -> bool:
        """Note a received rate, and return whether it is used."""
        self._has_rate = not self.is_angle
        return self._has_rate

    def offer_angle(self) -> bool:
        """Note a received angle, and return whether it is used."""
        self._angles += not self._has_rate
        return self.is_angle
