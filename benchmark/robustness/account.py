"""What was sent, lost, received and wrong: from the bytes on the wire, by rules that know nothing of the decoders.

A frame has arrived where its bytes are there as they were sent, between two ends of frames; of a protocol without an
end mark, where the one before it or behind it is there as well, since nothing else tells a frame from noise.
"""

from collections import Counter
from dataclasses import dataclass
from itertools import pairwise
from math import isclose

import numpy as np

from firmware_sim.motion.profile import load_profile
from firmware_sim.wire.encoder import Frame
from gyrodrift.filters.registry import DEFAULT
from gyrodrift.values.sample import Sample
from robustness.identity import number_of
from robustness.scaled import BASE, BEGUN_S, MOTION, Story

WITMOTION_BYTES = 11
"""Length of a frame, bytes."""

TIME_SLACK_S = 0.02
UNSEEN_S = 0.03


@dataclass(frozen=True, slots=True)
class Tally:
    """One run in numbers.

    sent, arrived, received
        Measurements that were sent; whose bytes reached the reader whole; that the link handed on.
    lost_by_us
        That arrived and were not handed on, though later ones were; one may still wait for the next at the end.
    wrong
        That were handed on with a rate, or at a time, that was never sent; `restarts` of the clock are told, and none.
    back_s
        From the first frame after the trouble to the first sample of it, s; None where none came.
    yaw_deg
        By the moment of the measurement, s, less the turns that nobody could know: across more than `UNSEEN_S` without
        a sample they are what the table did less a straight line between the rates at both ends, or, where the filter
        held yaw over a gap, all of it.
    """

    sent: int
    arrived: int
    received: int
    lost_by_us: int
    wrong: int
    back_s: float | None
    yaw_deg: dict[float, float]

    @property
    def lost_by_link(self) -> int:
        """Sent, and not arrived whole."""
        return self.sent - self.arrived


def tally(story: Story, trouble_over_s: float) -> Tally:
    """The account of a run."""
    truth = _truth(story)
    arrived = _arrived(story)
    known = [number_of(sample, story.protocol, BASE) for sample in story.samples]
    rates_fit = [
        number is not None and number in truth and isclose(sample.rate_dps, truth[number][1], abs_tol=1e-4)
        for number, sample in zip(known, story.samples, strict=True)
    ]
    right = [number for number, fits in zip(known, rates_fit, strict=True) if fits and number is not None]
    wrong = len(known) - len(right) + _mistimed(story, known, rates_fit, truth)
    sent_numbers = [number for number, frame in _rows(story) if frame.t_s >= trouble_over_s]
    return Tally(
        sent=sum(frame.rows for frame in story.whole),
        arrived=len(arrived),
        received=len(known),
        lost_by_us=len({number for number in arrived if number <= max(right, default=-1)} - set(right)),
        wrong=wrong,
        back_s=_back_s(story, known, min(sent_numbers, default=0)),
        yaw_deg=_yaw(story, [number if fits else None for number, fits in zip(known, rates_fit, strict=True)]),
    )


def _rows(story: Story) -> list[tuple[int, Frame]]:
    """The frames that hold a measurement, by its number."""
    return list(enumerate(frame for frame in story.whole if frame.rows))


def _truth(story: Story) -> dict[int, tuple[float, float]]:
    """Device time in s and rate in deg/s by number."""
    t_us = np.concatenate([block.t_device_us for block in story.measured])
    raw = np.concatenate([block.rate_raw for block in story.measured])
    scale = 2000.0 / 32768.0 if story.protocol == "witmotion" else BASE.dps_per_lsb
    rate_dps = raw * BASE.dps_per_lsb
    if story.protocol == "witmotion":
        rate_dps = np.round(rate_dps / scale) * scale
    return {number: (float(t) / 1e6, float(r)) for number, (t, r) in enumerate(zip(t_us, rate_dps, strict=True))}


def _arrived(story: Story) -> set[int]:
    """Numbers of the measurements whose bytes came whole."""
    stream = b"".join(story.came)
    if story.protocol == "witmotion":
        return _arrived_without_marks(story, stream)
    mark, end = (b"\0", b"\0") if story.protocol == "native" else (b"\n", b"\r\n")  # in a frame, 0x0d is content
    pieces = Counter(piece.strip(end) for piece in stream.split(mark)[:-1])
    return {number for number, frame in _rows(story) if pieces[frame.content.strip(end)]}


def _arrived_without_marks(story: Story, stream: bytes) -> set[int]:
    at, found = 0, set()
    for number, frame in _rows(story):
        first, rates, last = (frame.content[i : i + WITMOTION_BYTES] for i in range(0, 33, WITMOTION_BYTES))
        places = [stream.find(two, at) for two in (first + rates, rates + last)]
        place = min((place for place in places if place >= 0), default=-1)
        if place >= 0:
            found.add(number)
            at = place
    return found


def _mistimed(story: Story, known: list[int | None], fits: list[bool], truth: dict[int, tuple[float, float]]) -> int:
    """Steps of time that are not those of the device, but for restarts of its clock that were told."""
    if story.protocol == "witmotion":
        return 0
    held = [(n, s.t_device_s) for n, s, fit in zip(known, story.samples, fits, strict=True) if fit and n is not None]
    off = sum(abs((t_b - t_a) - (truth[b][0] - truth[a][0])) > TIME_SLACK_S for (a, t_a), (b, t_b) in pairwise(held))
    return max(0, off - story.counters.device_resets)


def _back_s(story: Story, known: list[int | None], first: int) -> float | None:
    frame = dict(_rows(story)).get(first)
    heard = [at_s for number, at_s in zip(known, story.heard_s, strict=True) if number is not None and number >= first]
    return max(0.0, heard[0] - BEGUN_S - frame.t_s) if heard and frame is not None else None


def _yaw(story: Story, known: list[int | None]) -> dict[float, float]:
    """As the default filter makes it of all that was received; moments are those of rates that are known to be true."""
    coefficients, state = DEFAULT.coefficients(DEFAULT.params()), DEFAULT.state()
    moments, found = {number: frame.t_s for number, frame in _rows(story)}, {}
    motion, unseen_deg = load_profile(MOTION), 0.0
    last: tuple[float, Sample] | None = None
    newest, gaps = -1, 0
    for number, sample in zip(known, story.samples, strict=True):
        DEFAULT.step(coefficients, state, sample.t_device_s, sample.rate_dps)
        at_s = moments.get(number) if number is not None and number > newest else None
        if at_s is None or number is None:
            continue
        newest = number
        if last is not None and at_s - last[0] > UNSEEN_S:
            angles_deg, rates_dps = motion.motion_at(np.array([last[0], at_s]) - BASE.host_delay_s)
            is_held = state.watch.gaps > gaps
            bridged_deg = 0.0 if is_held else rates_dps.mean() * (sample.t_device_s - last[1].t_device_s)
            unseen_deg += float(angles_deg[1] - angles_deg[0] - bridged_deg)
        last, gaps = (at_s, sample), state.watch.gaps
        found[at_s] = float(state.yaw_deg) + unseen_deg
    return found
