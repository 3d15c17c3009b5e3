"""All faults by name; several faults act in the order of the catalogue."""

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
"""Class by name, in the order of action from sensor to reader."""

_ORDER = {name: index for index, name in enumerate(FAULTS)}


def parse_fault(text: str) -> Fault:
    """Fault from a command line: `name`, or `name:parameter=value,...`.

    Raises
    ------
    FileError
        The fault or a parameter is unknown, or a value is invalid.
    """
    return parse_named("fault", text, FAULTS, lambda _: {})


def faulty_blocks(blocks: Iterator[Block], faults: Sequence[Fault]) -> Iterator[Block]:
    """Measurements of a device with these faults."""
    for fault in _in_order(faults):
        blocks = fault.on_blocks(blocks)
    return blocks


def faulty_frames(frames: Iterator[Frame], faults: Sequence[Fault], seed: int) -> Iterator[Frame]:
    """Frames of a device with these faults; every fault has its own random generator."""
    twins: dict[str, int] = {}
    for fault in _in_order(faults):
        twins[fault.fault] = twins.get(fault.fault, 0) + 1
        rng = np.random.default_rng([seed, crc32(fault.fault.encode()), twins[fault.fault]])
        frames = fault.on_frames(frames, rng)
    return frames


class FaultyCable(Cable):
    """Cable with these faults."""

    def __init__(self, faults: Sequence[Fault]) -> None:
        self._faults = _in_order(faults)

    def link_at(self, link: Path, t_s: float) -> Path | None:
        """Present name of the link, or None."""
        name: Path | None = link
        for fault in self._faults:
            name = None if name is None else fault.link_at(name, t_s)
        return name

    def carry(self, content: bytes, t_s: float, read_baud: Callable[[], int]) -> bytes:
        """Bytes after all faults."""
        for fault in self._faults:
            content = fault.carry(content, t_s, read_baud)
        return content


def _in_order(faults: Sequence[Fault]) -> list[Fault]:
    """Faults in the order of the catalogue; of a kind, the earlier one comes first."""
    return sorted(faults, key=lambda fault: (_ORDER[fault.fault], fault.from_s))
