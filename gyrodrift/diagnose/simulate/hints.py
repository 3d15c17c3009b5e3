"""Estimates of the second parameters of candidates from the recordings: see `Hints`."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.fft import next_fast_len

from firmware_sim.effects.environment import REFERENCE_C, SELF_HEATING_C
from gyrodrift.diagnose.features.axes import turn_lean
from gyrodrift.diagnose.features.block_means import block_means
from gyrodrift.diagnose.features.block_residuals import block_residual_dps
from gyrodrift.diagnose.features.sample_values import LEAK, NEAR_ZERO_DPS
from gyrodrift.diagnose.features.spectral_line import spectral_line
from gyrodrift.diagnose.recording.order_statistics import DECIMALS, distinct
from gyrodrift.diagnose.recording.outliers import step_of
from gyrodrift.diagnose.recording.recording import Recording
from gyrodrift.diagnose.simulate.candidate_kind import Hints
from gyrodrift.diagnose.simulate.twin import Subject
from gyrodrift.values.arrays import Floats

BEGINS_AFTER, AT_ONCE, FEW_BUNCHES = 1.5, 0.5, 20
"""Minimum gap before a bunch and maximum gap within it, in sample periods; and the number of bunches up to which the
gaps may be stalls of the host. Chosen: gaps of bunches are nearly 0 or 2 periods and more, and stalls are rare."""

TICK_BIN, TICK_FINER = 1.0 / 16.0, 4
"""Bin of the histogram of arrivals, in sample periods, and factor of zero padding of its spectrum. Chosen: fine against
a period, and to a quarter of a line."""

WITHIN_90 = 3.29
"""Distance of the quantiles 5 and 95 % of a normal distribution, in standard deviations. Derived: 2·1.645."""


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


NEAR_STEP = np.linspace(0.98, 1.02, 401)
"""Multiples of an approximate step among which the best step of the levels is searched. Chosen: 2 % on either side, in
steps of 0.01 %."""

SWEEP_C = 2.0 * SELF_HEATING_C
"""Minimum range of the temperature for an estimate of the curve, °C. Chosen: over self-heating alone, a curve and a
warm-up have the same effect on the bias."""

LEVELS_ABOVE = 4
"""Levels above the lowest one that are taken to occur equally often. Chosen: a motion takes about as long for each of a
few levels."""


def hints_of(subjects: Sequence[Subject]) -> Hints:
    """Estimate the second parameters from all sessions; defaults if the sessions do not show them."""
    recordings = [subject.cleaned.recording for subject in subjects]
    bunches = [bunches_of(recording) for recording in recordings]
    slow_dps = [_near_zero_dps(subject) for subject in subjects]
    lsb_dps = [subject.rig.base.dps_per_lsb for subject in subjects]
    pairs = zip(slow_dps, lsb_dps, strict=True)
    step_dps = _median([_even_step_of(rates_dps, lsb) or _largest(rates_dps) or lsb for rates_dps, lsb in pairs])
    return Hints(
        line_hz=_median([spectral_line(subject.cleaned, subject.design).frequency_hz for subject in subjects]) or 20.0,
        spike_dps=_power_median([subject.cleaned.spikes_dps for subject in subjects]) or 20.0,
        slip_deg=_power_median([subject.cleaned.slips_deg for subject in subjects]) or 0.5,
        rate_step_dps=step_dps,
        angle_step_deg=_median(
            [step_of(subject.cleaned.recording.encoder_deg) or _count_deg(subject) for subject in subjects]
        ),
        least_dps=_least_dps(np.concatenate(slow_dps), step_dps) or _median(lsb_dps),
        largest_dps=max(1.0, *(_largest(subject.cleaned.rate_dps) for subject in subjects)),
        sample_period_s=min(recording.period_s for recording in recordings),
        bunch_s=_median([session.distance_s for session in bunches]),
        bunch_spread=_median([session.spread for session in bunches]),
        handover_s=_median([session.handover_s for session in bunches]),
        dps_per_lsb=_median(lsb_dps),
        lean_deg=_lean_deg(subjects),
        curve_per_c=_curve_per_c(subjects),
    )


def _curve_per_c(subjects: Sequence[Subject]) -> float:
    """Curve of the bias over the temperature, divided by the slope at the reference, 1/°C; 0 without a sweep."""
    curves = [_parabola_curve_per_c(subject) for subject in subjects if _has_sweep(subject)]
    return _median(curves) if curves else 0.0


def _has_sweep(subject: Subject) -> bool:
    return float(np.ptp(subject.design.motion.sensor_c)) > SWEEP_C


def _parabola_curve_per_c(subject: Subject) -> float:
    """Ratio of the coefficients of T² and T, 1/°C, in a fit to the block residuals.

    T is the temperature less the reference. All regressors that are no slow bias are projected out first.
    """
    design = subject.design
    over_c = block_means(design.motion.sensor_c, design.block) - REFERENCE_C
    powers = design.root_weights[:, None] * np.column_stack([over_c, np.square(over_c)])
    powers -= design.fast_vectors @ (design.fast_vectors.T @ powers)
    residuals = design.root_weights * block_residual_dps(subject.cleaned, design)
    slope, square = np.linalg.lstsq(powers, residuals)[0]
    return float(square / slope) if slope else 0.0


def _lean_deg(subjects: Sequence[Subject]) -> float:
    """Direction in which the turn axis leans from the yaw axis, from x to y, degrees; mean over all sessions."""
    leans = [turn_lean(subject.cleaned.recording, subject.design) for subject in subjects]
    return float(np.degrees(np.arctan2(sum(lean.y for lean in leans), sum(lean.x for lean in leans))))


def _power_median(sessions: Sequence[Floats]) -> float:
    """Height of outliers or jumps below which half of the sum of their squares lies; 0 without any.

    So the few large ones determine it, even if there are many small ones from a simulated motion.
    """
    heights = np.sort(np.abs(np.concatenate(sessions)))
    power = np.cumsum(np.square(heights))
    return float(heights[np.searchsorted(power, 0.5 * power[-1])]) if len(heights) else 0.0


def _least_dps(rates_dps: Floats, step: float) -> float:
    """Width of the dead band, deg/s: the device reports zero below this rate. 0 if all rates are zero.

    A level holds all rates within half a step. The dead band truncates the lowest level, so the count of that level
    divided by the count of a level above gives the width. If the result is negative, the lowest level itself is
    returned: that level stands for zero, for example if a bias was subtracted from rates in coarse steps.
    """
    sizes = np.abs(rates_dps)
    sizes = sizes[sizes > 0.0]
    if not len(sizes):
        return 0.0
    level = _smallest_typical(sizes, step)
    steps_above = np.rint((sizes - level) / step)
    in_level = np.count_nonzero(steps_above == 0)
    in_level_above = np.count_nonzero((steps_above > 0) & (steps_above <= LEVELS_ABOVE)) / LEVELS_ABOVE
    passed_share = min(in_level / in_level_above, 1.0) if in_level_above else 1.0
    least = level + (0.5 - passed_share) * step
    return least if least > 0.0 else level


def _smallest_typical(sizes: Floats, step: float) -> float:
    """Smallest number, without up to LEAK − 1 isolated numbers far below, which may be chance."""
    smallest = np.sort(sizes)[:25]
    usual_gap = max(step, float(np.ptp(smallest[LEAK - 1 :])) / len(smallest)) if len(smallest) >= LEAK else step
    gaps = smallest[LEAK - 1 :] - smallest[: len(smallest) - LEAK + 1]
    is_isolated = np.logical_and.accumulate(gaps[: LEAK - 1] > 6.0 * usual_gap)
    return float(smallest[np.count_nonzero(is_isolated)])


def _even_step_of(rates_dps: Floats, finer_dps: float) -> float:
    """Step of the rates near zero; 0 if there is only one level.

    finer_dps
        Step of the rig, to which the levels were rounded afterwards; it bounds the step.
    """
    step_dps = _even_step(rates_dps)
    if not step_dps:
        return 0.0
    least, most = _possible_steps(distinct(rates_dps), step_dps, finer_dps)
    return step_dps if least > most else float(np.clip(step_dps, least, most))


def _possible_steps(levels: Floats, step: float, finer: float) -> tuple[float, float]:
    """Smallest and largest possible step of levels that were rounded to finer steps afterwards.

    A level is within half a finer step of a whole multiple of the step, so it gives an interval for the step. The
    result is the intersection of all intervals. It is a single value if ties were rounded both ways. The smallest is
    above the largest if no step explains all levels.
    """
    multiples = np.abs(np.rint(levels / step))
    is_nonzero = multiples > 0.0
    nearest = finer * np.rint(np.abs(levels[is_nonzero]) / finer)
    least, most = ((nearest + part * finer) / multiples[is_nonzero] for part in (-0.5, 0.5))
    return round(float(least.max(initial=0.0)), DECIMALS), round(float(most.min(initial=np.inf)), DECIMALS)


def _even_step(values: Floats) -> float:
    """Step whose whole multiples are closest to all levels; 0 if there is only one level.

    Levels that were rounded to finer steps are uneven. With a step of 2.5 finer steps, their distances alternate
    between 2 and 3.
    """
    step = step_of(values)
    if not step:
        return 0.0
    levels, near = distinct(values), step * NEAR_STEP
    return float(near[np.abs(np.exp(2j * np.pi * levels / near[:, None]).mean(axis=1)).argmax()])


def _largest(values: Floats) -> float:
    return float(np.abs(values).max(initial=0.0))


def _count_deg(subject: Subject) -> float:
    return 360.0 / max(1, subject.rig.base.encoder_cpr)


def _median(values: Sequence[float] | Floats) -> float:
    return float(np.median(values))


def _near_zero_dps(subject: Subject) -> Floats:
    """Known rates below NEAR_ZERO_DPS, deg/s; all known nonzero rates if these are all zero."""
    rates = subject.cleaned.recording.rate_dps
    near = rates[np.isfinite(rates) & (np.abs(rates) < NEAR_ZERO_DPS)]
    return near if np.any(near != 0.0) else rates[np.isfinite(rates) & (rates != 0.0)]
