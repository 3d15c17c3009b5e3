"""Hints: what recordings show by themselves of the second parameters of candidates."""

from collections.abc import Sequence

import numpy as np

from firmware_sim.effects.environment import REFERENCE_C, SELF_HEATING_C
from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features.axes import turn_lean
from gyrodrift.diagnose.features.block_means import block_means
from gyrodrift.diagnose.features.block_residuals import block_residual_dps
from gyrodrift.diagnose.features.sample_values import LEAK, NEAR_ZERO_DPS
from gyrodrift.diagnose.features.spectral_line import spectral_line
from gyrodrift.diagnose.recording.order_statistics import DECIMALS, distinct
from gyrodrift.diagnose.recording.outliers import step_of
from gyrodrift.diagnose.simulate.bunches import bunches_of
from gyrodrift.diagnose.simulate.candidate_kind import Hints
from gyrodrift.diagnose.simulate.twin import Subject

NEAR_STEP = np.linspace(0.98, 1.02, 401)
"""Multiples of a step that its levels are held against."""

SWEEP_C = 2.0 * SELF_HEATING_C
"""Change of the temperature from which on a curve is read off, °C. Over self-heating alone, a curve and a warm-up look
alike."""

LEVELS_ABOVE = 4
"""Levels of a rate that occur about equally often."""


def hints_of(subjects: Sequence[Subject]) -> Hints:
    """Second parameters of the candidates as all sessions show them, or usual ones."""
    recordings = [subject.cleaned.recording for subject in subjects]
    bunches = [bunches_of(recording) for recording in recordings]
    slow_dps = [_near_zero_dps(subject) for subject in subjects]
    lsb_dps = [subject.rig.base.dps_per_lsb for subject in subjects]
    pairs = zip(slow_dps, lsb_dps, strict=True)
    step_dps = _median([_even_step_of(rates_dps, lsb) or _most(rates_dps) or lsb for rates_dps, lsb in pairs])
    return Hints(
        line_hz=_median([spectral_line(subject.cleaned, subject.design).frequency_hz for subject in subjects]) or 20.0,
        spike_dps=_usual([subject.cleaned.spikes_dps for subject in subjects]) or 20.0,
        slip_deg=_usual([subject.cleaned.slips_deg for subject in subjects]) or 0.5,
        rate_step_dps=step_dps,
        angle_step_deg=_median(
            [step_of(subject.cleaned.recording.encoder_deg) or _count_deg(subject) for subject in subjects]
        ),
        least_dps=_least_dps(np.concatenate(slow_dps), step_dps) or _median(lsb_dps),
        largest_dps=max(1.0, *(_most(subject.cleaned.rate_dps) for subject in subjects)),
        sample_period_s=min(recording.period_s for recording in recordings),
        bunch_s=_median([one.distance_s for one in bunches]),
        bunch_spread=_median([one.spread for one in bunches]),
        handover_s=_median([one.handover_s for one in bunches]),
        dps_per_lsb=_median(lsb_dps),
        lean_deg=_lean_deg(subjects),
        curve_per_c=_curve_per_c(subjects),
    )


def _curve_per_c(subjects: Sequence[Subject]) -> float:
    """Curve of the bias over the temperature about the reference, relative to its slope there; 0 without a sweep."""
    curves = [_parabola_curve_per_c(subject) for subject in subjects if _sweeps(subject)]
    return _median(curves) if curves else 0.0


def _sweeps(subject: Subject) -> bool:
    return float(np.ptp(subject.design.motion.sensor_c)) > SWEEP_C


def _parabola_curve_per_c(subject: Subject) -> float:
    """Least squares of the block residuals on temperature and its square, beside all that is no slow bias."""
    design = subject.design
    over_c = block_means(design.motion.sensor_c, design.block) - REFERENCE_C
    powers = design.root_weights[:, None] * np.column_stack([over_c, np.square(over_c)])
    powers -= design.fast_vectors @ (design.fast_vectors.T @ powers)
    residuals = design.root_weights * block_residual_dps(subject.cleaned, design)
    slope, square = np.linalg.lstsq(powers, residuals)[0]
    return float(square / slope) if slope else 0.0


def _lean_deg(subjects: Sequence[Subject]) -> float:
    """Direction of the mean lean of the turn in the sensor, from x to y."""
    leans = [turn_lean(subject.cleaned.recording, subject.design) for subject in subjects]
    return float(np.degrees(np.arctan2(sum(lean.y for lean in leans), sum(lean.x for lean in leans))))


def _usual(every: Sequence[Floats]) -> float:
    """Height of the outliers or jumps of all sessions that half of their power lies below; 0 without any.

    Many small ones that a simulator of the motion makes hide no few large ones.
    """
    heights = np.sort(np.abs(np.concatenate(every)))
    power = np.cumsum(np.square(heights))
    return float(heights[np.searchsorted(power, 0.5 * power[-1])]) if len(heights) else 0.0


def _least_dps(rates_dps: Floats, step: float) -> float:
    """Rate below which zero is put out; 0 where all rates are zero.

    A level stands for all rates within half a step. The lowest level that occurs is truncated; its count beside the
    counts of the levels above gives the lowest rate. Where this level stands for zero itself, as where a bias was
    subtracted from rates in coarse steps, it is the lowest rate.
    """
    sizes = np.abs(rates_dps)
    sizes = sizes[sizes > 0.0]
    if not len(sizes):
        return 0.0
    level = _first_of_many(sizes, step)
    at = np.rint((sizes - level) / step)
    here, above = np.count_nonzero(at == 0), np.count_nonzero((at > 0) & (at <= LEVELS_ABOVE)) / LEVELS_ABOVE
    let_through = min(here / above, 1.0) if above else 1.0
    least = level + (0.5 - let_through) * step
    return least if least > 0.0 else level


def _first_of_many(sizes: Floats, step: float) -> float:
    """The smallest of some numbers, but for a few that lie far below all others and may be chance."""
    few = np.sort(sizes)[:25]
    usual = max(step, float(np.ptp(few[LEAK - 1 :])) / len(few)) if len(few) >= LEAK else step
    apart = few[LEAK - 1 :] - few[: len(few) - LEAK + 1]
    # A few sizes that lie far below all others may be chance.
    alone = np.logical_and.accumulate(apart[: LEAK - 1] > 6.0 * usual)
    return float(few[np.count_nonzero(alone)])


def _even_step_of(rates_dps: Floats, finer_dps: float) -> float:
    """Step of rates near zero, within the bounds that the rig's finer steps give; 0 where there is one level."""
    step_dps = _even_step(rates_dps)
    if not step_dps:
        return 0.0
    least, most = _possible_steps(distinct(rates_dps), step_dps, finer_dps)
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
    rates = subject.cleaned.recording.rate_dps
    near = rates[np.isfinite(rates) & (np.abs(rates) < NEAR_ZERO_DPS)]
    return near if np.any(near != 0.0) else rates[np.isfinite(rates) & (rates != 0.0)]
