"""Faults of the bytes on the line: damaged, missing, repeated, or late."""

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
"""Output of the ESP32 boot loader at 115200 baud, before the firmware runs."""


class Damage(Lasting):
    """Base of faults that change the bytes of a frame."""

    def on_frames(self, frames: Iterator[Frame], rng: Rng) -> Iterator[Frame]:
        """Frames, damaged while the fault is active."""
        for frame in frames:
            yield frame._replace(content=self.damaged(frame, rng)) if self.is_on(frame.t_s) else frame

    @abstractmethod
    def damaged(self, frame: Frame, rng: Rng) -> bytes:
        """Damaged bytes of a frame."""


class BitFlips(Damage):
    """Single bits flip: a long unshielded cable next to a motor.

    per_kilobyte
        Mean number of flipped bits in 1000 bytes.
    """

    fault: ClassVar[str] = "bit_flips"
    per_kilobyte: PerKilobyte = 1.0

    def damaged(self, frame: Frame, rng: Rng) -> bytes:
        """Independent flips of all bits."""
        content = frame.content
        flips = np.packbits(rng.random(8 * len(content)) < self.per_kilobyte / KILOBYTE / 8.0)
        return (np.frombuffer(content, np.uint8) ^ flips).tobytes()


class DroppedBytes(Damage):
    """Bytes are missing: a receiver that overflows.

    per_kilobyte
        Mean number of missing bytes in 1000.
    """

    fault: ClassVar[str] = "dropped_bytes"
    per_kilobyte: PerKilobyte = 1.0

    def damaged(self, frame: Frame, rng: Rng) -> bytes:
        """Independent changes of all bytes."""
        kept = rng.random(len(frame.content)) >= self.per_kilobyte / KILOBYTE
        return np.frombuffer(frame.content, np.uint8)[kept].tobytes()


class DuplicatedBytes(Damage):
    """Bytes are repeated: a driver that repeats a transfer.

    per_kilobyte
        Mean number of repeated bytes in 1000.
    """

    fault: ClassVar[str] = "duplicated_bytes"
    per_kilobyte: PerKilobyte = 1.0

    def damaged(self, frame: Frame, rng: Rng) -> bytes:
        """Independent changes of all bytes."""
        times = 1 + (rng.random(len(frame.content)) < self.per_kilobyte / KILOBYTE)
        return np.repeat(np.frombuffer(frame.content, np.uint8), times).tobytes()


class MergedFrames(Damage):
    """A frame loses its end and runs into the next one: two tasks of a firmware write to a port.

    share_percent
        Share of frames without their end: delimiter, line end, or last byte.
    """

    fault: ClassVar[str] = "merged_frames"
    share_percent: Percent = 5.0

    def damaged(self, frame: Frame, rng: Rng) -> bytes:
        """Bytes without the end."""
        return _split_end(frame)[0] if rng.random() < self.share_percent / 100.0 else frame.content


class TruncatedFrames(Damage):
    """A frame is cut, but keeps its end mark: a firmware with a short line buffer.

    share_percent
        Share of frames that lose a tail of random length.
    """

    fault: ClassVar[str] = "truncated_frames"
    share_percent: Percent = 5.0

    def damaged(self, frame: Frame, rng: Rng) -> bytes:
        """Part of the head, and the end mark if the protocol has one."""
        if rng.random() >= self.share_percent / 100.0:
            return frame.content
        head, end = _split_end(frame)
        kept = head[: int(rng.integers(max(1, len(head))))]
        return kept + end if frame.end_mark else kept


class Zeros(Lasting):
    """A run of zero bytes inside a frame: a break on the line, like a touched plug.

    length_bytes
        Length of the run.
    every_s
        Interval of the runs, s.
    """

    fault: ClassVar[str] = "zeros"
    length_bytes: Annotated[int, Field(ge=1, le=100_000)] = 64
    every_s: Annotated[float, Field(gt=0.0, le=1e6)] = 1.0

    def on_frames(self, frames: Iterator[Frame], rng: Rng) -> Iterator[Frame]:
        """Frames with a run of zeros in the first frame of every interval."""
        runs = -1
        for frame in frames:
            now = int((frame.t_s - self.from_s) // self.every_s)
            if self.is_on(frame.t_s) and now > runs:
                runs = now
                position = int(rng.integers(1, max(2, len(frame.content))))
                content = frame.content[:position] + bytes(self.length_bytes) + frame.content[position:]
                yield frame._replace(content=content)
            else:
                yield frame


class BootBanner(Fault):
    """Foreign text in the stream: the log of the ESP32 boot loader."""

    fault: ClassVar[str] = "boot_banner"

    def on_frames(self, frames: Iterator[Frame], rng: Rng) -> Iterator[Frame]:
        """Frames with the banner before the first frame from `from_s` on."""
        _ = rng
        return at_moment(frames, self.from_s, lambda t_s: Frame(t_s, BANNER, 0))


class Stall(Lasting):
    """Frames wait, then arrive in a burst: a sleeping USB driver, or a radio link that repeats.

    seconds
        Length of a stall, s.
    every_s
        Interval of the stalls, s; None for a single one.
    """

    fault: ClassVar[str] = "stall"
    seconds: Annotated[float, Field(gt=0.0, le=1e6)] = 1.0
    every_s: Annotated[float | None, Field(gt=0.0, le=1e6)] = None

    @field_validator("every_s")
    @classmethod
    def _stalls_end(cls, every_s: float | None, info: ValidationInfo) -> float | None:
        seconds = info.data.get("seconds", 0.0)
        if every_s is not None and every_s <= seconds:
            raise PydanticCustomError("stalls", "Expected more than seconds, which is {seconds}", {"seconds": seconds})
        return every_s

    def on_frames(self, frames: Iterator[Frame], rng: Rng) -> Iterator[Frame]:
        """Frames, delayed until the end of the stall; none is lost."""
        _ = rng
        for frame in frames:
            begun_s = self.from_s
            if self.every_s is not None:
                begun_s += (frame.t_s - self.from_s) // self.every_s * self.every_s
            over_s = begun_s + self.seconds
            is_delayed = self.is_on(begun_s) and begun_s <= frame.t_s < over_s
            yield frame._replace(t_s=over_s) if is_delayed else frame


def at_moment(frames: Iterator[Frame], t_s: float, frame_at: Callable[[float], Frame]) -> Iterator[Frame]:
    """Frames with an additional one at `t_s`."""
    is_due = True
    for frame in frames:
        if is_due and frame.t_s >= t_s:
            is_due = False
            yield frame_at(t_s)
        yield frame


def _split_end(frame: Frame) -> tuple[bytes, bytes]:
    """Bytes of a frame, and its end: the end mark, or the last byte."""
    length = len(frame.end_mark) if frame.end_mark and frame.content.endswith(frame.end_mark) else 1
    return frame.content[:-length], frame.content[-length:]
