"""All faults by name, and how several act at once: in the order of the catalogue, however they were given."""

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from zlib import crc32

import numpy as np

from firmware_sim.faults.cable import Unplug, WrongBaud
from firmware_sim.faults.fault import Fault
from firmware_sim.faults.frames import (
    BitFlips,
    BootBanner,
    DroppedBytes,
    DuplicatedBytes,
    MergedFrames,
    Stall,
    TruncatedFrames,
    Zeros,
)
from firmware_sim.faults.measurements import (
    ClockStep,
    DoubleRate,
    FullScale,
    MillisecondClock,
    RateChange,
    Reset,
    StuckValue,
)
from firmware_sim.measure import Block
from firmware_sim.named import parse_named
from firmware_sim.pty import Cable
from firmware_sim.wire.encoder import Frame

_KINDS: tuple[type[Fault], ...] = (
    DoubleRate,
    StuckValue,
    FullScale,
    RateChange,
    ClockStep,
    Reset,
    MillisecondClock,
    TruncatedFrames,
    MergedFrames,
    DroppedBytes,
    DuplicatedBytes,
    BitFlips,
    Zeros,
    BootBanner,
    Stall,
    WrongBaud,
    Unplug,
)

FAULTS: dict[str, type[Fault]] = {kind.fault: kind for kind in _KINDS}
"""Class by name, in the order in which they act: what happens first on the way from sensor to reader is first."""

_ORDER = {name: place for place, name in enumerate(FAULTS)}


def parse_fault(text: str) -> Fault:
    """A fault as a command line says it: `name`, or `name:parameter=value,...`.

    Raises
    ------
    FileError
        Where there is no such fault or parameter, or a value is none or out of range.
    """
    return parse_named("fault", text, FAULTS, lambda _: {})


def faulty_blocks(blocks: Iterator[Block], faults: Sequence[Fault]) -> Iterator[Block]:
    """The measurements of a device that has these faults."""
    for fault in _in_order(faults):
        blocks = fault.on_blocks(blocks)
    return blocks


def faulty_frames(frames: Iterator[Frame], faults: Sequence[Fault], seed: int) -> Iterator[Frame]:
    """What such a device sends; each fault has a random generator of its own."""
    twins: dict[str, int] = {}
    for fault in _in_order(faults):
        twins[fault.fault] = twins.get(fault.fault, 0) + 1
        rng = np.random.default_rng([seed, crc32(fault.fault.encode()), twins[fault.fault]])
        frames = fault.on_frames(frames, rng)
    return frames


class FaultyCable(Cable):
    """A cable that has what these faults do to one."""

    def __init__(self, faults: Sequence[Fault]) -> None:
        self._faults = _in_order(faults)

    def link_at(self, link: Path, t_s: float) -> Path | None:
        """The name that the faults leave it."""
        name: Path | None = link
        for fault in self._faults:
            name = None if name is None else fault.link_at(name, t_s)
        return name

    def carry(self, content: bytes, t_s: float, read_baud: Callable[[], int]) -> bytes:
        """What the faults let through."""
        for fault in self._faults:
            content = fault.carry(content, t_s, read_baud)
        return content


def _in_order(faults: Sequence[Fault]) -> list[Fault]:
    """Of one kind the earlier is first: resets count on from each other."""
    return sorted(faults, key=lambda fault: (_ORDER[fault.fault], fault.from_s))
