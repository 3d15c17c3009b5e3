"""What recordings show by themselves of a candidate's second parameter: an estimator and a default for each hint."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from scipy.fft import next_fast_len

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features.sample_values import LEAK, NEAR_ZERO_DPS
from gyrodrift.diagnose.features.spectral_line import spectral_line
from gyrodrift.diagnose.recording.order_statistics import DECIMALS, distinct
from gyrodrift.diagnose.recording.outliers import step_of
from gyrodrift.diagnose.recording.recording import Recording
from gyrodrift.diagnose.simulate.candidate import Hints
from gyrodrift.diagnose.simulate.twin import Subject

NEAR_STEP = np.linspace(0.98, 1.02, 401)
"""Multiples of a step that its levels are held against."""

BEGINS_AFTER, AT_ONCE, FEW_BUNCHES = 1.5, 0.5, 20
"""Sample periods of silence before a bunch of samples, and between two in it; few may be stalls of a host."""

FEW_ARRIVALS, MANY_ARRIVALS, LONGEST_TICK_S = 200, 20_000, 0.2
"""Arrivals that show no comb; as many as are looked at; and ticks that are looked for."""

MOST_SILENT = 10.0
"""Times as long as samples would take: a host whose clock was set anew, by which ticks have no phase."""

TICK_BIN, TICK_FINER = 1.0 / 16.0, 4
"""Of a sample period, in which arrivals are counted; and how much finer frequencies are than these alone give."""

ON_TICKS, OWN_PERIOD = 0.85, 1e-3
"""Share of arrivals at one phase, of those that come at ticks; and how near a tick may be to the samples themselves,
whose clock it is then."""

LEVELS_ABOVE = 4
"""Of a rate, which come about equally often."""

FEW_SIZES, FAR_BELOW = 25, 6.0
"""Smallest rates whose distance is usual, and how many times that LEAK of them lie apart where the first is alone."""

LEAST_RANGE_DPS = 1.0
"""No gyro ends at less."""


@dataclass(frozen=True, slots=True)
class Shown:
    """A session with what several estimators look at.

    slow_dps
        Rates near zero, where a step of the rate is least hidden; shape (some,).
    """

    subject: Subject
    slow_dps: Floats


Estimator = Callable[[Sequence[Shown]], float]
"""All sessions to a hint; 0 where they show nothing."""


class HintSource(NamedTuple):
    """Where a hint comes from, and what is usual where the recordings show nothing."""

    estimator: Estimator
    default: float = 0.0


def hints_of(subjects: Sequence[Subject]) -> Hints:
    """What the sessions show, or what is usual where they show nothing."""
    shown = [Shown(subject, _near_zero_dps(subject)) for subject in subjects]
    values: dict[str, Any] = {name: source.estimator(shown) or source.default for name, source in SOURCES.items()}
    return Hints(**values)


def line_hz(shown: Sequence[Shown]) -> float:
    """Frequency of the strongest tone at rest."""
    return _median([spectral_line(one.subject.seen, one.subject.design).frequency_hz for one in shown])


def spike_dps(shown: Sequence[Shown]) -> float:
    """Height of outliers of the rate, over those of all sessions."""
    heights = np.concatenate([np.abs(one.subject.seen.spikes_dps) for one in shown])
    return _median(heights) if len(heights) else 0.0


def slip_deg(shown: Sequence[Shown]) -> float:
    """Height of jumps of the angle, over those of all sessions."""
    heights = np.concatenate([np.abs(one.subject.seen.slips_deg) for one in shown])
    return _median(heights) if len(heights) else 0.0


def rate_step_dps(shown: Sequence[Shown]) -> float:
    """The step that rates come in; of a single one, itself."""
    return _median([_even_step_of(one) or _most(one.slow_dps) or one.subject.rig.base.dps_per_lsb for one in shown])


def angle_step_deg(shown: Sequence[Shown]) -> float:
    """The step that angles come in; of a single one, a count."""
    return _median([step_of(one.subject.seen.recording.encoder_deg) or _count_deg(one.subject) for one in shown])


def least_dps(shown: Sequence[Shown]) -> float:
    """The rate below which zero is put out; of none but zeros, one count.

    A level stands for all rates within half a step. Of those at the smallest one that comes only some were let through,
    which are the fewer beside the levels above it, the higher the least of them was. Where that one stands for zero
    itself, as where a bias was taken off rates in coarse steps, it is the least.
    """
    sizes = np.abs(np.concatenate([one.slow_dps for one in shown]))
    sizes = sizes[sizes > 0.0]
    if not len(sizes):
        return dps_per_lsb(shown)
    step = rate_step_dps(shown)
    level = _first_of_many(sizes, step)
    at = np.rint((sizes - level) / step)
    here, above = np.count_nonzero(at == 0), np.count_nonzero((at > 0) & (at <= LEVELS_ABOVE)) / LEVELS_ABOVE
    let_through = min(here / above, 1.0) if above else 1.0
    least = level + (0.5 - let_through) * step
    return least if least > 0.0 else level


def _first_of_many(sizes: Floats, step: float) -> float:
    """The smallest of some numbers, but for a few that lie far below all others and may be chance."""
    few = np.sort(sizes)[:FEW_SIZES]
    usual = max(step, float(np.ptp(few[LEAK - 1 :])) / len(few)) if len(few) >= LEAK else step
    apart = few[LEAK - 1 :] - few[: len(few) - LEAK + 1]
    alone = np.logical_and.accumulate(apart[: LEAK - 1] > FAR_BELOW * usual)
    return float(few[np.count_nonzero(alone)])


def largest_dps(shown: Sequence[Shown]) -> float:
    """The largest rate of all sessions, LEAST_RANGE_DPS at least."""
    return max(LEAST_RANGE_DPS, *(_most(one.subject.seen.rate_dps) for one in shown))


def sample_period_s(shown: Sequence[Shown]) -> float:
    """The shortest of all sessions."""
    return min(one.subject.seen.recording.period_s for one in shown)


def bunch_s(shown: Sequence[Shown]) -> float:
    """How far apart samples reach the host in bunches, over the sessions; 0 where they do not come in bunches."""
    recordings = [one.subject.seen.recording for one in shown]
    return _median([_tick_s(recording) or _bunch_s(recording) for recording in recordings])


def _bunch_s(recording: Recording) -> float:
    """By the silence before a sample that another one follows at once: after one that was lost none does."""
    arrived_s = _arrived_s(recording)
    gaps = np.diff(arrived_s) / recording.period_s
    begins = np.flatnonzero((gaps[:-1] > BEGINS_AFTER) & (gaps[1:] < AT_ONCE))
    return float(np.median(np.diff(arrived_s[begins]))) if len(begins) > FEW_BUNCHES else 0.0


def _tick_s(recording: Recording) -> float:
    """By the comb that arrivals at ticks make: of all at one phase its lowest frequency.

    Where ticks are about as far apart as samples, there are no bunches, but now and then a tick without a sample. Much
    shorter ones stand behind the comb of the samples themselves; how short they are matters little.
    """
    arrived_s, period_s = _arrived_s(recording)[:MANY_ARRIVALS], recording.period_s
    if len(arrived_s) < FEW_ARRIVALS or np.ptp(arrived_s) > MOST_SILENT * len(arrived_s) * period_s:
        return 0.0
    places = np.floor((arrived_s - arrived_s.min()) / (TICK_BIN * period_s)).astype(np.int64)
    bins = next_fast_len(TICK_FINER * int(places.max() + 1), real=True)
    aligned = np.abs(np.fft.rfft(np.bincount(places), bins)) / len(arrived_s)
    per_bin_hz = 1.0 / (bins * TICK_BIN * period_s)
    first = int(1.0 / (LONGEST_TICK_S * per_bin_hz)) + 1
    comb = np.flatnonzero(aligned[first:] > ON_TICKS)
    if not len(comb):
        return 0.0
    peak = first + int(comb[0])
    beside = peak + int(np.argmax(aligned[peak : peak + TICK_FINER]))
    tick_s = 1.0 / (beside * per_bin_hz)
    return 0.0 if abs(tick_s / period_s - 1.0) < OWN_PERIOD else tick_s


def _arrived_s(recording: Recording) -> Floats:
    """When samples reached the host; none where nobody knows."""
    return np.zeros(0) if recording.host_s is None else recording.host_s[np.isfinite(recording.host_s)]


def dps_per_lsb(shown: Sequence[Shown]) -> float:
    """What the rig says."""
    return _median([one.subject.rig.base.dps_per_lsb for one in shown])


SOURCES = {
    "line_hz": HintSource(line_hz, default=20.0),
    "spike_dps": HintSource(spike_dps, default=20.0),
    "slip_deg": HintSource(slip_deg, default=0.5),
    "rate_step_dps": HintSource(rate_step_dps),
    "angle_step_deg": HintSource(angle_step_deg),
    "least_dps": HintSource(least_dps),
    "largest_dps": HintSource(largest_dps),
    "sample_period_s": HintSource(sample_period_s),
    "bunch_s": HintSource(bunch_s),
    "dps_per_lsb": HintSource(dps_per_lsb),
}
"""One for each field of `Hints`; without a default there is always something to read off."""


def _even_step_of(one: Shown) -> float:
    """The step of rates near zero, within what the rig's finer steps leave possible; 0 where there is one level."""
    step_dps = _even_step(one.slow_dps)
    if not step_dps:
        return 0.0
    least, most = _possible_steps(distinct(one.slow_dps), step_dps, one.subject.rig.base.dps_per_lsb)
    return step_dps if least > most else float(np.clip(step_dps, least, most))


def _possible_steps(levels: Floats, step: float, finer: float) -> tuple[float, float]:
    """The least and the most that the step of some levels may be, each of which was rounded to finer steps at last.

    One within half of the finer step of a whole multiple leaves an interval, and they share one; where they share a
    single step, ties were rounded both ways. The least is above the most where no step could give all the levels.
    """
    times = np.abs(np.rint(levels / step))
    some = times > 0.0
    nearest = finer * np.rint(np.abs(levels[some]) / finer)
    least, most = ((nearest + part * finer) / times[some] for part in (-0.5, 0.5))
    return round(float(least.max(initial=0.0)), DECIMALS), round(float(most.min(initial=np.inf)), DECIMALS)


def _even_step(values: Floats) -> float:
    """The step of which all levels are nearest to whole multiples; 0 where there is one level only.

    Levels that were rounded to others are uneven: of a step of two and a half of these, two and three in turn.
    """
    step = step_of(values)
    if not step:
        return 0.0
    levels, near = distinct(values), step * NEAR_STEP
    return float(near[np.abs(np.exp(2j * np.pi * levels / near[:, None]).mean(axis=1)).argmax()])


def _most(values: Floats) -> float:
    return float(np.abs(values).max(initial=0.0))


def _count_deg(subject: Subject) -> float:
    return 360.0 / max(1, subject.rig.base.encoder_cpr)


def _median(values: Sequence[float] | Floats) -> float:
    return float(np.median(values))


def _near_zero_dps(subject: Subject) -> Floats:
    rates = subject.seen.recording.rate_dps
    near = rates[np.isfinite(rates) & (np.abs(rates) < NEAR_ZERO_DPS)]
    return near if np.any(near != 0.0) else rates[np.isfinite(rates) & (rates != 0.0)]
