"""Faults of the bytes on their way: damaged, missing, too many, or late."""

from abc import abstractmethod
from collections.abc import Callable, Iterator
from typing import Annotated, ClassVar

import numpy as np
from pydantic import Field, ValidationInfo, field_validator
from pydantic_core import PydanticCustomError

from firmware_sim.faults.fault import Fault, Lasting, Rng
from firmware_sim.wire.encoder import Frame

KILOBYTE = 1000.0
PerKilobyte = Annotated[float, Field(ge=0.0, le=500.0)]
Percent = Annotated[float, Field(ge=0.0, le=100.0)]

BANNER = b"""ets Jun  8 2016 00:22:57\r
\r
rst:0x1 (POWERON_RESET),boot:0x13 (SPI_FAST_FLASH_BOOT)\r
configsip: 0, SPIWP:0xee\r
clk_drv:0x00,q_drv:0x00,d_drv:0x00,cs0_drv:0x00,hd_drv:0x00,wp_drv:0x00\r
mode:DIO, clock div:1\r
load:0x3fff0030,len:1344\r
load:0x40078000,len:13964\r
load:0x40080400,len:3600\r
entry 0x400805f0\r
"""
"""What the boot loader of an ESP32 prints at 115200 baud before anybody's firmware runs."""


class Damage(Lasting):
    """Base of the faults that change the bytes of a frame."""

    def on_frames(self, frames: Iterator[Frame], rng: Rng) -> Iterator[Frame]:
        """Each frame that leaves while it is at work, damaged."""
        for frame in frames:
            yield frame._replace(content=self.damaged(frame, rng)) if self.is_on(frame.t_s) else frame

    @abstractmethod
    def damaged(self, frame: Frame, rng: Rng) -> bytes:
        """What is left of the bytes of one frame."""


class BitFlips(Damage):
    """Bits turn over, one by one: a long cable without a shield beside a motor.

    per_kilobyte
        Turned bits in 1000 bytes, on average.
    """

    fault: ClassVar[str] = "bit_flips"
    per_kilobyte: PerKilobyte = 1.0

    def damaged(self, frame: Frame, rng: Rng) -> bytes:
        """Each bit for itself."""
        content = frame.content
        flips = np.packbits(rng.random(8 * len(content)) < self.per_kilobyte / KILOBYTE / 8.0)
        return (np.frombuffer(content, np.uint8) ^ flips).tobytes()


class DroppedBytes(Damage):
    """Bytes are missing: a receiver that overflows because nobody fetched them in time.

    per_kilobyte
        Missing bytes in 1000, on average.
    """

    fault: ClassVar[str] = "dropped_bytes"
    per_kilobyte: PerKilobyte = 1.0

    def damaged(self, frame: Frame, rng: Rng) -> bytes:
        """Each byte for itself."""
        kept = rng.random(len(frame.content)) >= self.per_kilobyte / KILOBYTE
        return np.frombuffer(frame.content, np.uint8)[kept].tobytes()


class DuplicatedBytes(Damage):
    """Bytes come twice: a driver that repeats a transfer whose end it did not see.

    per_kilobyte
        Doubled bytes in 1000, on average.
    """

    fault: ClassVar[str] = "duplicated_bytes"
    per_kilobyte: PerKilobyte = 1.0

    def damaged(self, frame: Frame, rng: Rng) -> bytes:
        """Each byte for itself."""
        times = 1 + (rng.random(len(frame.content)) < self.per_kilobyte / KILOBYTE)
        return np.repeat(np.frombuffer(frame.content, np.uint8), times).tobytes()


class MergedFrames(Damage):
    """The end of a frame is lost and it runs into the next: two tasks of a firmware write to one port.

    share_percent
        Frames without their end: delimiter, line end, or the last byte where a protocol has neither.
    """

    fault: ClassVar[str] = "merged_frames"
    share_percent: Percent = 5.0

    def damaged(self, frame: Frame, rng: Rng) -> bytes:
        """All but its end."""
        return _split_end(frame)[0] if rng.random() < self.share_percent / 100.0 else frame.content


class TruncatedFrames(Damage):
    """A frame ends too soon, and its end mark still comes: a firmware whose line buffer is too short.

    share_percent
        Frames that have lost a tail of any length.
    """

    fault: ClassVar[str] = "truncated_frames"
    share_percent: Percent = 5.0

    def damaged(self, frame: Frame, rng: Rng) -> bytes:
        """Some of its head, and its end mark where the protocol has one."""
        if rng.random() >= self.share_percent / 100.0:
            return frame.content
        head, end = _split_end(frame)
        left = head[: int(rng.integers(max(1, len(head))))]
        return left + end if frame.end_mark else left


class Zeros(Lasting):
    """A run of zero bytes cuts through a frame: a break on the line, as when a plug is touched.

    length_bytes
        Length of the run.
    every_s
        Time between two runs, s.
    """

    fault: ClassVar[str] = "zeros"
    length_bytes: Annotated[int, Field(ge=1, le=100_000)] = 64
    every_s: Annotated[float, Field(gt=0.0, le=1e6)] = 1.0

    def on_frames(self, frames: Iterator[Frame], rng: Rng) -> Iterator[Frame]:
        """The first frame of each interval is cut."""
        runs = -1
        for frame in frames:
            now = int((frame.t_s - self.from_s) // self.every_s)
            if self.is_on(frame.t_s) and now > runs:
                runs = now
                at = int(rng.integers(1, max(2, len(frame.content))))
                content = frame.content[:at] + bytes(self.length_bytes) + frame.content[at:]
                yield frame._replace(content=content)
            else:
                yield frame


class BootBanner(Fault):
    """Text that is no measurement stands in the stream: the boot loader of an ESP32 tells its log."""

    fault: ClassVar[str] = "boot_banner"

    def on_frames(self, frames: Iterator[Frame], rng: Rng) -> Iterator[Frame]:
        """Once, before the first frame from then on."""
        _ = rng
        return at_moment(frames, self.from_s, lambda t_s: Frame(t_s, BANNER, 0))


class Stall(Lasting):
    """Frames are held, then come in one burst: a host whose USB driver sleeps, a radio link that repeats.

    seconds
        How long they are held, s.
    every_s
        Time from one stall to the next, s; only one where nothing is said.
    """

    fault: ClassVar[str] = "stall"
    seconds: Annotated[float, Field(gt=0.0, le=1e6)] = 1.0
    every_s: Annotated[float | None, Field(gt=0.0, le=1e6)] = None

    @field_validator("every_s")
    @classmethod
    def _stalls_end(cls, every_s: float | None, others: ValidationInfo) -> float | None:
        seconds = others.data.get("seconds", 0.0)
        if every_s is not None and every_s <= seconds:
            raise PydanticCustomError("stalls", "Expected more than seconds, which is {seconds}", {"seconds": seconds})
        return every_s

    def on_frames(self, frames: Iterator[Frame], rng: Rng) -> Iterator[Frame]:
        """Held until the stall is over; what is held is not lost."""
        _ = rng
        for frame in frames:
            begun_s = self.from_s
            if self.every_s is not None:
                begun_s += (frame.t_s - self.from_s) // self.every_s * self.every_s
            over_s = begun_s + self.seconds
            is_held = self.is_on(begun_s) and begun_s <= frame.t_s < over_s
            yield frame._replace(t_s=over_s) if is_held else frame


def at_moment(frames: Iterator[Frame], t_s: float, frame_at: Callable[[float], Frame]) -> Iterator[Frame]:
    """The frames, with one more where `t_s` is reached."""
    is_due = True
    for frame in frames:
        if is_due and frame.t_s >= t_s:
            is_due = False
            yield frame_at(t_s)
        yield frame


def _split_end(frame: Frame) -> tuple[bytes, bytes]:
    """The bytes of a frame and its end: its end mark, or simply the last byte."""
    length = len(frame.end_mark) if frame.end_mark and frame.content.endswith(frame.end_mark) else 1
    return frame.content[:-length], frame.content[-length:]
