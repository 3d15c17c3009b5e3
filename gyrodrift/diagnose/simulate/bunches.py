"""Bunches of samples that reach the host together: their distance, its spread, and the distance within a bunch."""

from typing import NamedTuple

import numpy as np
from scipy.fft import next_fast_len

from gyrodrift.diagnose.recording.recording import Recording
from gyrodrift.values.arrays import Floats

BEGINS_AFTER, AT_ONCE, FEW_BUNCHES = 1.5, 0.5, 20
"""Minimum gap before a bunch and maximum gap within it, in sample periods; and the number of bunches up to which the
gaps may be stalls of the host."""

TICK_BIN, TICK_FINER = 1.0 / 16.0, 4
"""Bin of the histogram of arrivals, in sample periods, and factor of zero padding of its spectrum."""

WITHIN_90 = 3.29
"""Distance of the quantiles 5 and 95 % of a normal distribution, in standard deviations: 2·1.645."""


class Bunches(NamedTuple):
    """Bunches of samples at the host; all 0 without bunches.

    distance_s
        Distance of successive bunches.
    spread
        Standard deviation of the distances divided by their mean; 0 for even ticks.
    handover_s
        Median distance of samples within a bunch; 0 without bunches of two samples or more.
    """

    distance_s: float
    spread: float
    handover_s: float


def bunches_of(recording: Recording) -> Bunches:
    """Find bunches by the phase of even ticks, or by the gaps before them."""
    arrived_s, period_s = _arrived_s(recording), recording.period_s
    tick_s = _tick_s(arrived_s, period_s)
    distance_s = tick_s or _silence_s(arrived_s, period_s)
    if not distance_s:
        return Bunches(0.0, 0.0, 0.0)
    return Bunches(distance_s, 0.0 if tick_s else _spread(arrived_s, period_s), _handover_s(arrived_s, period_s))


def _spread(arrived_s: Floats, period_s: float) -> float:
    """Standard deviation of the distances of bunches, divided by their mean.

    It is computed from the quantiles 5 and 95 %, so that rare stalls of a host do not count.
    """
    intervals_s = np.diff(arrived_s[1:][np.diff(arrived_s) > AT_ONCE * period_s])
    low_s, high_s = np.quantile(intervals_s, (0.05, 0.95))
    return float((high_s - low_s) / WITHIN_90 / intervals_s.mean())


def _handover_s(arrived_s: Floats, period_s: float) -> float:
    """Median gap within bunches, s; 0 without such gaps."""
    gaps_s = np.diff(arrived_s)
    within_s = gaps_s[gaps_s < AT_ONCE * period_s]
    return float(np.median(within_s)) if len(within_s) else 0.0


def _silence_s(arrived_s: Floats, period_s: float) -> float:
    """Median distance of bunches, s; 0 for FEW_BUNCHES or less.

    A bunch begins with a gap, followed by two samples at once. A lost sample leaves a gap, but not two samples at once.
    """
    gaps = np.diff(arrived_s) / period_s
    begins = np.flatnonzero((gaps[:-1] > BEGINS_AFTER) & (gaps[1:] < AT_ONCE))
    return float(np.median(np.diff(arrived_s[begins]))) if len(begins) > FEW_BUNCHES else 0.0


def _tick_s(arrived_s: Floats, period_s: float) -> float:
    """Distance of even ticks, s; 0 without ticks.

    It is the inverse of the lowest frequency at which all arrivals have the same phase. Ticks about as long as the
    sample period make no bunches; sometimes a tick has no sample. The frequency of much shorter ticks lies above the
    harmonics of the samples, and their exact length is irrelevant.
    """
    arrived_s = arrived_s[:20_000]
    # The ticks have no phase if the clock of the host was set meanwhile.
    if len(arrived_s) < 200 or np.ptp(arrived_s) > 10.0 * len(arrived_s) * period_s:
        return 0.0
    bin_numbers = np.floor((arrived_s - arrived_s.min()) / (TICK_BIN * period_s)).astype(np.int64)
    padded_bins = next_fast_len(TICK_FINER * int(bin_numbers.max() + 1), real=True)
    aligned = np.abs(np.fft.rfft(np.bincount(bin_numbers), padded_bins)) / len(arrived_s)
    per_bin_hz = 1.0 / (padded_bins * TICK_BIN * period_s)
    first = int(1.0 / (0.2 * per_bin_hz)) + 1  # ticks of 0.2 s and less
    harmonics = np.flatnonzero(aligned[first:] > 0.85)  # resultant length: 1 if all arrivals have the same phase
    if not len(harmonics):
        return 0.0
    peak = first + int(harmonics[0])
    highest = peak + int(np.argmax(aligned[peak : peak + TICK_FINER]))
    tick_s = 1.0 / (highest * per_bin_hz)
    return 0.0 if abs(tick_s / period_s - 1.0) < 1e-3 else tick_s  # this is the sample period itself


def _arrived_s(recording: Recording) -> Floats:
    """Known arrival times of samples, s; empty without times of the host."""
    return np.zeros(0) if recording.host_s is None else recording.host_s[np.isfinite(recording.host_s)]
