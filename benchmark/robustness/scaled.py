"""Device, pty and link in one process: the host's clock is that of the samples, and runs as fast as they do."""

from collections.abc import Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from itertools import takewhile
from pathlib import Path
from typing import Any

from firmware_sim.faults.catalogue import FaultyCable, faulty_blocks, faulty_frames
from firmware_sim.faults.fault import Fault
from firmware_sim.measure import Block, measure
from firmware_sim.motion.profile import load_profile
from firmware_sim.pty import PtyDevice
from firmware_sim.rig import Base, Rig
from firmware_sim.wire.encoder import Frame
from firmware_sim.wire.registry import ENCODERS
from gyrodrift.link.link import Link
from gyrodrift.link.options import LinkCounters, LinkOptions
from gyrodrift.values.errors import UnitError
from gyrodrift.values.sample import Sample
from robustness.identity import numbered

BASE = Base(bias_dps=0.35, encoder_cpr=36000)
MOTION = "turntable"
STEP_S = 0.01
BAUD = 115200
BEGUN_S = 1000.0
"""Of the host's monotonic clock when the device is switched on."""


@dataclass(slots=True)
class Story:
    """What one run was.

    measured
        Every measurement that was taken, in blocks; their numbers count from 0.
    whole
        The frames as they were before anything happened to their bytes.
    came
        All bytes that reached the reader, with the host's time.
    samples, heard_s
        What the link made of them, and the host's time at which it did.
    events
        What it told.
    refused
        Why it gave the stream up; empty where it did not.
    damaged, before_hello
        As it counted.
    """

    protocol: str
    measured: list[Block] = field(default_factory=list)
    whole: list[Frame] = field(default_factory=list)
    came: list[bytes] = field(default_factory=list)
    samples: list[Sample] = field(default_factory=list)
    heard_s: list[float] = field(default_factory=list)
    events: list[tuple[str, dict[str, Any]]] = field(default_factory=list)
    refused: str = ""
    counters: LinkCounters = field(default_factory=LinkCounters)
    damaged: int = 0
    before_hello: int = 0


def play(folder: Path, protocol: str, faults: Sequence[Fault], seconds: float, seed: int = 1) -> Story:
    """Let a device with these faults speak for so many seconds of its own time."""
    story, now_s = Story(protocol), [BEGUN_S]
    frames = _frames(story, faults, seconds, seed)
    cable = FaultyCable(faults)
    with closing(PtyDevice(folder / "gyro", ENCODERS[protocol].hello(BASE), cable)) as device:
        options = LinkOptions(str(device.link), BAUD, protocol)
        link = Link(options, lambda event, **fields: story.events.append((event, fields)), lambda: now_s[0])
        link.tap = lambda content, _: story.came.append(content)
        try:
            for frame in frames:
                while now_s[0] + STEP_S < BEGUN_S + frame.t_s:
                    now_s[0] += STEP_S
                    device.live_until(now_s[0] - BEGUN_S)
                    _read(link, story, now_s[0])
                now_s[0] = max(now_s[0], BEGUN_S + frame.t_s)
                device.live_until(frame.t_s)
                device.send(frame.content)
                _read(link, story, now_s[0])
        except UnitError as error:
            story.refused = str(error)
        finally:
            story.counters = link.counters
            if link.decoder is not None:
                story.damaged = link.decoder.counters.damaged
                story.before_hello = link.decoder.counters.before_hello
            link.close()
    return story


def _frames(story: Story, faults: Sequence[Fault], seconds: float, seed: int) -> Iterator[Frame]:
    def kept(blocks: Iterator[Block]) -> Iterator[Block]:
        for block in blocks:
            story.measured.append(block)
            yield block

    def remembered(frames: Iterator[Frame]) -> Iterator[Frame]:
        for frame in takewhile(lambda frame: frame.t_s < seconds, frames):
            story.whole.append(frame)
            yield frame

    motion = load_profile(MOTION)
    blocks = numbered(faulty_blocks(measure(Rig(base=BASE), motion, seed, block_samples=256), faults))
    return faulty_frames(remembered(ENCODERS[story.protocol].frames(kept(blocks), BASE)), faults, seed)


def _read(link: Link, story: Story, now_s: float) -> None:
    for sample in link.read():
        story.samples.append(sample)
        story.heard_s.append(now_s)
