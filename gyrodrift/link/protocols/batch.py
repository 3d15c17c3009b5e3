"""Readings of a source whose messages are values, such as the frames of a bus: no stream of bytes lies between."""

from dataclasses import dataclass, field

from gyrodrift.link.protocols.decoder import CountingDecoder, DeviceDescription
from gyrodrift.link.protocols.protocol import WireProtocol
from gyrodrift.values.sample import Reading


@dataclass(slots=True)
class ReadingBatch:
    """Result of one read of a source of readings; it is false without a message.

    device
        Description of the device, as far as it is known.
    messages
        Messages as they arrived, which a recording with `--raw` keeps.
    damaged
        Number of messages that cannot be read.
    """

    device: DeviceDescription = field(default_factory=DeviceDescription)
    readings: list[Reading] = field(default_factory=list)
    messages: list[bytes] = field(default_factory=list)
    damaged: int = 0

    def __bool__(self) -> bool:
        return bool(self.messages)

    @property
    def content(self) -> bytes:
        """All messages."""
        return b"".join(self.messages)

    def add(self, message: bytes, reading: Reading | None) -> None:
        """Add a message and its reading; None for a message without a rate."""
        self.messages.append(message)
        if reading is not None:
            self.readings.append(reading)

    def add_damaged(self, message: bytes) -> None:
        """Add a message that cannot be read."""
        self.messages.append(message)
        self.damaged += 1


class BatchDecoder(CountingDecoder):
    """Decoder of a source of readings: it counts them."""

    def __init__(self, name: str) -> None:
        super().__init__()
        self.name = name

    def push(self, batch: ReadingBatch) -> list[Reading]:
        """Readings of a batch."""
        frames = len(batch.messages) - batch.damaged
        self.counters.frames += frames
        self.counters.other_frames += frames - len(batch.readings)
        self.counters.damaged += batch.damaged
        self.device = batch.device
        return batch.readings


def batch_protocol(name: str, about: str, without_rate: str = "") -> WireProtocol:
    """Protocol of a source of readings, whose rates have a unit; a reading may have its time."""
    return WireProtocol(
        name,
        about,
        lambda: BatchDecoder(name),
        has_clock=True,
        rank=0,
        is_detected=False,
        has_unit=True,
        without_rate=without_rate,
    )
