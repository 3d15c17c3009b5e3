"""Rests of the device: by the encoder, or else where the rate is at its quietest."""

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum
from math import inf, sqrt
from typing import NamedTuple

import numpy as np

from gyrodrift.facts.arrays import blocks_of, only, samples_in, smallest_step, true_runs
from gyrodrift.session.session import Session
from gyrodrift.values.arrays import Floats, Mask

Runs = list[tuple[int, int]]
"""Half-open ranges of indices."""

ENCODER_BLOCK_S = 0.25
STILL_LEAST_S = 2.0
STILL_LEAST_BLOCKS = 4
RESTLESS = 0.75
ENCODER_SCATTERS = 8.0
ENCODER_SLACK_DEG = 0.15
"""At rest an encoder may move by its smallest step, or by ENCODER_SCATTERS times its movement within a block, whichever
is larger, up to ENCODER_SLACK_DEG. An optical reference is never quite still."""

CREEP_DPS = 0.01
COMPARABLE = 4
"""Adjacent stationary runs may be one slow turn. A run counts only if the turn would be slower than CREEP_DPS, or if it
is COMPARABLE times as long as its neighbors."""

QUIETEST = 0.1
"""Share of the blocks taken as quiet; the noise floor is the largest scatter among them."""

STEADY_BLOCK_S = 1.0
STEADY_BLOCK_SAMPLES = 10
STEADY_LEAST_BLOCKS = 3
QUIET = 1.5
JUMP = 1.0
SCATTERS = 5.0
"""A block is quiet up to QUIET times the noise floor. It joins the next block if their means differ by less than JUMP
floors. Short blocks scatter more; SCATTERS standard deviations of that are allowed."""


BREAK_S = 1.0
BREAK_PERIODS = 10.0
"""A time step longer than both ends a rest."""


class RestSource(Enum):
    """Evidence of rest; the rate alone cannot distinguish rest from a constant spin."""

    ENCODER = "encoder"
    RATE = "rate"


@dataclass(frozen=True, slots=True)
class Stretch:
    """A rest: start and end in s after the first sample, mean rate (the bias) and standard deviation in deg/s."""

    start_s: float
    end_s: float
    mean_dps: float
    std_dps: float

    @property
    def seconds(self) -> float:
        """Length, s."""
        return self.end_s - self.start_s


class RestRates(NamedTuple):
    """A rest, and its rates, deg/s, shape (n,)."""

    stretch: Stretch
    rate_dps: Floats


def rests_of(session: Session, period_s: float) -> list[RestRates]:
    """Rests in order of time, by the encoder if there is one."""
    is_usable = np.isfinite(session.rate_dps) & np.isfinite(session.t_device_s)
    t_s, rate_dps = only(session.t_device_s, is_usable), only(session.rate_dps, is_usable)
    steps_s = np.diff(t_s, prepend=t_s[:1])
    is_break = (steps_s < 0.0) | (steps_s > max(BREAK_S, BREAK_PERIODS * period_s))
    if session.encoder_deg is None:
        runs = stationary_by_rate(rate_dps, is_break, period_s)
    else:
        runs = stationary_by_encoder(only(session.encoder_deg, is_usable), is_break, period_s)
    first_s = float(session.t_device_s[np.isfinite(session.t_device_s)][0])
    return [_rest(t_s[start:end] - first_s, rate_dps[start:end]) for start, end in runs]


def _rest(t_s: Floats, rate_dps: Floats) -> RestRates:
    return RestRates(Stretch(float(t_s[0]), float(t_s[-1]), float(rate_dps.mean()), float(rate_dps.std())), rate_dps)


class StationaryRun(NamedTuple):
    """A half-open range of blocks in which the encoder moves by no more than the slack."""

    start: int
    end: int
    slack_deg: float

    @property
    def blocks(self) -> int:
        """Number of blocks."""
        return self.end - self.start


def stationary_by_encoder(encoder_deg: Floats, is_break: Mask, period_s: float) -> Runs:
    """Runs of at least 2 s in which the encoder moves no more than at rest."""
    size = samples_in(ENCODER_BLOCK_S, period_s)
    blocks_deg = blocks_of(encoder_deg, size)
    lows_deg, highs_deg = np.fmin.reduce(blocks_deg, axis=1), np.fmax.reduce(blocks_deg, axis=1)
    ranges_deg = highs_deg - lows_deg
    highs_deg[blocks_of(is_break, size).any(axis=1)] = np.nan
    lows, highs = lows_deg.tolist(), highs_deg.tolist()
    step_deg = 1.001 * (smallest_step(encoder_deg) or 0.0)
    most_deg = max(step_deg, ENCODER_SLACK_DEG)
    runs: list[StationaryRun] = []
    for start, end in _within(lows, highs, most_deg):
        noise_deg = ENCODER_SCATTERS * float(np.quantile(ranges_deg[start:end], RESTLESS))
        slack_deg = max(step_deg, min(noise_deg, most_deg))
        parts = _within(lows[start:end], highs[start:end], slack_deg)
        runs += [StationaryRun(start + first, start + last, slack_deg) for first, last in parts]
    return [
        (
            size * (start + (start > 0)),
            size * (end - (end < len(blocks_deg))),
        )  # motion begins before the encoder shows it
        for start, end, _ in _without_creep(runs, size * period_s)
    ]


def _within(lows: list[float], highs: list[float], slack: float) -> Iterator[tuple[int, int]]:
    """Runs of blocks whose common range stays within the slack; a NaN ends a run."""
    start, low, high = 0, inf, -inf
    for i, (block_low, block_high) in enumerate(zip(lows, highs, strict=True)):
        if max(high, block_high) - min(low, block_low) <= slack and block_high == block_high:  # noqa: PLR0124 - NaN
            low, high = min(low, block_low), max(high, block_high)
            continue
        if i > start:
            yield start, i
        is_begun = block_high - block_low <= slack
        start, low, high = (i, block_low, block_high) if is_begun else (i + 1, inf, -inf)
    if len(lows) > start:
        yield start, len(lows)


def _without_creep(runs: list[StationaryRun], block_s: float) -> Iterator[StationaryRun]:
    """Runs that are long enough; a run beside one of comparable length may be a slow turn and must be longer."""
    starts, ends = {run.start: run for run in runs}, {run.end: run for run in runs}
    for run in runs:
        neighbors = (ends.get(run.start), starts.get(run.end))
        longest = max((neighbor.blocks for neighbor in neighbors if neighbor is not None), default=0)
        is_creep = COMPARABLE * longest >= run.blocks
        least_s = max(STILL_LEAST_S, run.slack_deg / CREEP_DPS if is_creep else 0.0)
        if run.blocks >= max(STILL_LEAST_BLOCKS, least_s / block_s):
            yield run


def stationary_by_rate(rate_dps: Floats, is_break: Mask, period_s: float) -> Runs:
    """Runs of blocks of about a second in which the rate is at its quietest."""
    size = max(STEADY_BLOCK_SAMPLES, samples_in(STEADY_BLOCK_S, period_s))
    blocks_dps = blocks_of(rate_dps, size)
    if not len(blocks_dps):
        return []
    means_dps, scatters_dps = blocks_dps.mean(axis=1), blocks_dps.std(axis=1)
    floor_dps = float(np.quantile(scatters_dps, QUIETEST))
    step_dps = 0.5 * (smallest_step(rate_dps) or 0.0)
    own = SCATTERS / sqrt(size)
    is_quiet = scatters_dps <= max(QUIET, 1.0 + own / sqrt(2.0)) * floor_dps + step_dps
    is_quiet &= ~blocks_of(is_break, size).any(axis=1)
    continues = is_quiet[1:] & is_quiet[:-1]
    continues &= np.abs(np.diff(means_dps)) <= max(JUMP, own * sqrt(2.0)) * floor_dps + step_dps
    runs = true_runs(continues)
    return [(size * start, size * (end + 1)) for start, end in runs if end + 1 - start >= STEADY_LEAST_BLOCKS]
