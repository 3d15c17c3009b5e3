"""Bunches of arrivals: how far apart they are, and by how much their distances scatter."""

from typing import NamedTuple

import numpy as np
from scipy.fft import next_fast_len

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.recording.recording import Recording

BEGINS_AFTER, AT_ONCE, FEW_BUNCHES = 1.5, 0.5, 20
"""Sample periods of silence before a bunch of samples, and between two in it; few may be stalls of a host."""

TICK_BIN, TICK_FINER = 1.0 / 16.0, 4
"""Bin in which arrivals are counted, in sample periods, and factor by which the frequencies are finer than its own."""

WITHIN_90 = 3.29
"""Distance of the quantiles 5 and 95 % of a normal distribution, in standard deviations."""


class Bunches(NamedTuple):
    """Bunches of samples at the host; all 0 without any.

    distance_s
        From one to the next.
    spread
        Standard deviation of these distances as a share of their mean; 0 on even ticks.
    handover_s
        Median distance of samples within a bunch; 0 without bunches of two samples or more.
    """

    distance_s: float
    spread: float
    handover_s: float


def bunches_of(recording: Recording) -> Bunches:
    """Bunches by the phase of even ticks, or by the silence before them."""
    arrived_s, period_s = _arrived_s(recording), recording.period_s
    tick_s = _tick_s(arrived_s, period_s)
    distance_s = tick_s or _silence_s(arrived_s, period_s)
    if not distance_s:
        return Bunches(0.0, 0.0, 0.0)
    return Bunches(distance_s, 0.0 if tick_s else _spread(arrived_s, period_s), _handover_s(arrived_s, period_s))


def _spread(arrived_s: Floats, period_s: float) -> float:
    """Of the quantiles 5 and 95 %: a host that stalls now and then is no spread of its ticks."""
    intervals_s = np.diff(arrived_s[1:][np.diff(arrived_s) > AT_ONCE * period_s])
    low_s, high_s = np.quantile(intervals_s, (0.05, 0.95))
    return float((high_s - low_s) / WITHIN_90 / intervals_s.mean())


def _handover_s(arrived_s: Floats, period_s: float) -> float:
    gaps_s = np.diff(arrived_s)
    within_s = gaps_s[gaps_s < AT_ONCE * period_s]
    return float(np.median(within_s)) if len(within_s) else 0.0


def _silence_s(arrived_s: Floats, period_s: float) -> float:
    """Distance of bunches by the silence before two samples at once; a lost sample leaves no second one."""
    gaps = np.diff(arrived_s) / period_s
    begins = np.flatnonzero((gaps[:-1] > BEGINS_AFTER) & (gaps[1:] < AT_ONCE))
    return float(np.median(np.diff(arrived_s[begins]))) if len(begins) > FEW_BUNCHES else 0.0


def _tick_s(arrived_s: Floats, period_s: float) -> float:
    """Distance of ticks by the lowest frequency at which all arrivals have one phase.

    Where ticks are about as far apart as samples, there are no bunches, but now and then a tick without a sample. Much
    shorter ones stand behind the comb of the samples themselves; how short they are matters little.
    """
    arrived_s = arrived_s[:20_000]
    # A host whose clock was set: ticks have no phase.
    if len(arrived_s) < 200 or np.ptp(arrived_s) > 10.0 * len(arrived_s) * period_s:
        return 0.0
    places = np.floor((arrived_s - arrived_s.min()) / (TICK_BIN * period_s)).astype(np.int64)
    bins = next_fast_len(TICK_FINER * int(places.max() + 1), real=True)
    aligned = np.abs(np.fft.rfft(np.bincount(places), bins)) / len(arrived_s)
    per_bin_hz = 1.0 / (bins * TICK_BIN * period_s)
    first = int(1.0 / (0.2 * per_bin_hz)) + 1  # ticks of 0.2 s and less
    comb = np.flatnonzero(aligned[first:] > 0.85)  # share of arrivals at one phase
    if not len(comb):
        return 0.0
    peak = first + int(comb[0])
    highest = peak + int(np.argmax(aligned[peak : peak + TICK_FINER]))
    tick_s = 1.0 / (highest * per_bin_hz)
    return 0.0 if abs(tick_s / period_s - 1.0) < 1e-3 else tick_s  # the clock of the samples themselves


def _arrived_s(recording: Recording) -> Floats:
    """When samples reached the host; none where nobody knows."""
    return np.zeros(0) if recording.host_s is None else recording.host_s[np.isfinite(recording.host_s)]
