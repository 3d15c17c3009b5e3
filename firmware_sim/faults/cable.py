"""Faults of cable and port: a wrong baud rate, and an unplugged cable."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from firmware_sim.faults.fault import Fault, Lasting, Rng, Seconds
from firmware_sim.faults.frames import at_moment
from firmware_sim.faults.measurements import Reset
from firmware_sim.measure import Block
from firmware_sim.wire.encoder import Frame

BITS_OF_A_BYTE = 10
"""A start bit (0), eight data bits, lowest first, and a stop bit (1)."""


class WrongBaud(Lasting):
    """The device sends at a fixed baud rate; a reader with another one gets garbage.

    baud
        Baud rate of the device.
    """

    fault: ClassVar[str] = "wrong_baud"
    from_s: Seconds = 0.0
    baud: Annotated[int, Field(ge=50, le=4_000_000)] = 9600

    def carry(self, content: bytes, t_s: float, read_baud: Callable[[], int]) -> bytes:
        """Bytes that the reader gets from the line at its own baud rate."""
        if not self.is_on(t_s) or (reader_baud := read_baud()) in (0, self.baud):
            return content
        return received_at(content, self.baud, reader_baud)


class Unplug(Fault):
    """The plug is pulled and put back: a loose connector, or a hub that switches a port off.

    seconds
        Time without a port, s.
    name
        same: it returns under its name, like names in /dev/serial/by-id. other: it returns as NAME-1 (then NAME-2),
        like ttyUSB0 that becomes ttyUSB1 while a reader holds it.
    power_lost
        1 if the device loses power and boots again, 0 if it keeps measuring.
    """

    fault: ClassVar[str] = "unplug"
    seconds: Annotated[float, Field(gt=0.0, le=1e6)] = 1.0
    name: Literal["same", "other"] = "same"
    power_lost: Literal[0, 1] = 1

    @property
    def back_s(self) -> float:
        """Time of the return, s."""
        return self.from_s + self.seconds

    def on_blocks(self, blocks: Iterator[Block]) -> Iterator[Block]:
        """No measurements without power."""
        return Reset(from_s=self.from_s, silent_s=self.seconds).on_blocks(blocks) if self.power_lost else blocks

    def on_frames(self, frames: Iterator[Frame], rng: Rng) -> Iterator[Frame]:
        """Frames with two empty ones, so that the device acts at both times."""
        _ = rng
        for moment_s in (self.from_s, self.back_s):
            frames = at_moment(frames, moment_s, lambda t_s: Frame(t_s, b"", 0))
        return frames

    def link_at(self, link: Path, t_s: float) -> Path | None:
        """Present name of the link, or None."""
        if self.from_s <= t_s < self.back_s:
            return None
        if self.name == "same" or t_s < self.from_s:
            return link
        stem, _, number = link.name.rpartition("-")
        return link.with_name(f"{stem}-{int(number) + 1}" if stem and number.isdecimal() else f"{link.name}-1")


def received_at(content: bytes, sent_baud: int, read_baud: int) -> bytes:
    """Bytes of a receiver at `read_baud` from consecutive bytes at `sent_baud`.

    It waits for a falling edge, samples the middle of eight bits with its own clock, and waits for the end of the stop
    bit. The idle line is 1.
    """
    line = [bit for byte in content for bit in (0, *(byte >> bit & 1 for bit in range(8)), 1)]
    step = sent_baud / read_baud
    heard = bytearray()
    position = 0
    while position < len(line):
        if line[position]:
            position += 1
            continue
        samples = (int(position + step * (bit + 1.5)) for bit in range(8))
        heard.append(sum(_level(line, sample) << bit for bit, sample in enumerate(samples)))
        position = max(position + 1, int(position + step * (BITS_OF_A_BYTE - 0.5)))
    return bytes(heard)


def _level(line: list[int], position: int) -> int:
    return line[position] if position < len(line) else 1
