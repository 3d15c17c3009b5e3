"""Faults of cable and port: a reader at another line rate, and a plug that is pulled."""

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
"""A start bit (0), eight data bits, the lowest first, a stop bit (1)."""


class WrongBaud(Lasting):
    """The device sends at a line rate that is its own: what a reader gets at another one is garbage.

    baud
        Line rate of the device; a reader that has set it gets every byte as it is.
    """

    fault: ClassVar[str] = "wrong_baud"
    from_s: Seconds = 0.0
    baud: Annotated[int, Field(ge=50, le=4_000_000)] = 9600

    def carry(self, content: bytes, t_s: float, read_baud: Callable[[], int]) -> bytes:
        """The same line, sampled by the clock of the reader."""
        if not self.is_on(t_s) or (heard_baud := read_baud()) in (0, self.baud):
            return content
        return heard_at(content, self.baud, heard_baud)


class Unplug(Fault):
    """The plug is pulled and put back: a loose connector, a hub that switches a port off.

    seconds
        How long the port is gone, s.
    name
        same: it comes back under its name, as one in /dev/serial/by-id does. other: its name stays gone and it
        comes back as NAME-1 (at the next time NAME-2), as ttyUSB0 becomes ttyUSB1 while a reader holds it.
    power_lost
        1 where the device lives on the power of the plug and boots anew, 0 where it goes on measuring.
    """

    fault: ClassVar[str] = "unplug"
    seconds: Annotated[float, Field(gt=0.0, le=1e6)] = 1.0
    name: Literal["same", "other"] = "same"
    power_lost: Literal[0, 1] = 1

    @property
    def back_s(self) -> float:
        """When it is put back, s."""
        return self.from_s + self.seconds

    def on_blocks(self, blocks: Iterator[Block]) -> Iterator[Block]:
        """Without power nothing is measured."""
        return Reset(from_s=self.from_s, silent_s=self.seconds).on_blocks(blocks) if self.power_lost else blocks

    def on_frames(self, frames: Iterator[Frame], rng: Rng) -> Iterator[Frame]:
        """Both moments as frames of nothing, so that the device meets them on time."""
        _ = rng
        for moment_s in (self.from_s, self.back_s):
            frames = at_moment(frames, moment_s, lambda t_s: Frame(t_s, b"", 0))
        return frames

    def link_at(self, link: Path, t_s: float) -> Path | None:
        """Its name, its next name, or none."""
        if self.from_s <= t_s < self.back_s:
            return None
        if self.name == "same" or t_s < self.from_s:
            return link
        stem, _, number = link.name.rpartition("-")
        return link.with_name(f"{stem}-{int(number) + 1}" if stem and number.isdecimal() else f"{link.name}-1")


def heard_at(content: bytes, sent_baud: int, read_baud: int) -> bytes:
    """What a receiver at `read_baud` makes of bytes sent one after the other at `sent_baud`.

    It waits for a falling edge, samples the middle of each of eight bits by its own clock, and waits for the stop
    bit to end. The line rests at 1.
    """
    line = [bit for byte in content for bit in (0, *(byte >> place & 1 for place in range(8)), 1)]
    step = sent_baud / read_baud
    heard = bytearray()
    at = 0
    while at < len(line):
        if line[at]:
            at += 1
            continue
        samples = (int(at + step * (place + 1.5)) for place in range(8))
        heard.append(sum(_level(line, sample) << place for place, sample in enumerate(samples)))
        at = max(at + 1, int(at + step * (BITS_OF_A_BYTE - 0.5)))
    return bytes(heard)


def _level(line: list[int], at: int) -> int:
    return line[at] if at < len(line) else 1
