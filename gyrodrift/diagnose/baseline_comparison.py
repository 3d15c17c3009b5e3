"""Comparison of recordings with a baseline, earlier recordings of the same device.

The causes that the baseline names go into the rig, so the simulator comes near the device as it was. The remaining
difference between the baseline and that rig is then subtracted from the recordings to be diagnosed.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.special import ndtri

from firmware_sim.rig import Rig
from gyrodrift.diagnose.features.vector import FEATURES, NOT_OF_STEPS, SLOW
from gyrodrift.diagnose.inference.baseline import Baseline, against, baseline_of
from gyrodrift.diagnose.inference.conclusion import SURELY_UNKNOWN
from gyrodrift.diagnose.inference.verdict import NamedCause
from gyrodrift.diagnose.recording.facts import contradictions
from gyrodrift.diagnose.recording.lacking import SAME_RATE, is_same_rate, rates_hz
from gyrodrift.diagnose.recording.levels import LEAST_GAPS, has_steps, levels_of
from gyrodrift.diagnose.recording.recording import Recording
from gyrodrift.diagnose.recording.reference_response import ReferenceResponse, reference_response_of
from gyrodrift.diagnose.simulate.candidate import Touches
from gyrodrift.diagnose.simulate.distribute import SimulationPlan, response_tables
from gyrodrift.diagnose.simulate.response_table import ResponseTable, Sized
from gyrodrift.diagnose.simulate.twin import Subject, subject_of
from gyrodrift.diagnose.stages import (
    DiagnosisRequest,
    adopted,
    inferred_of,
    recordings_of,
    simulated_of,
    with_facts,
    with_recorded_axes,
)
from gyrodrift.values.arrays import Mask

SLOW_ONLY = "single samples are not compared, only rate errors second by second"

CALM = 0.75
"""Share of the second differences that count as noise. Chosen: the quarter with the most motion is left out."""

ALL = np.ones(len(FEATURES), bool)
"""(F,) all features."""


def compared_of(first: Sequence[Recording], second: Sequence[Recording]) -> tuple[Mask, list[str]]:
    """(F,) features that both sets determine, and remarks on the remaining features."""
    compared, remarks = _of_rates(first, second)
    by_steps, of_steps = _of_steps(first, second)
    return compared & by_steps, [*remarks, *of_steps]


def _of_rates(first: Sequence[Recording], second: Sequence[Recording]) -> tuple[Mask, list[str]]:
    """(F,) features that both sample rates determine, and remarks."""
    if is_same_rate(first, second):
        return ALL, []
    before, now = (f"{round(rate_hz, 1):g}" for rate_hz in rates_hz(first, second))
    return SLOW, [f"the baseline has {before} samples a second, these recordings {now}: {SLOW_ONLY}"]


def _of_steps(first: Sequence[Recording], second: Sequence[Recording]) -> tuple[Mask, list[str]]:
    """(F,) features that the steps of both sets determine, and remarks.

    Coarser steps may be an effect. Steps that are coarser by a power of two are not: the ranges of a gyro double.
    """
    before, now = (_steps_dps(recordings) for recordings in (first, second))
    if before is None or now is None or before == now or (not before and _hide_noise(second, now)):
        return ALL, []
    if not before or not now:
        have, have_not = ("the baseline", "these recordings") if before else ("these recordings", "the baseline")
        words = f"the rates of {have} come in steps of {before or now:.4g} deg/s, those of {have_not} in none"
        return NOT_OF_STEPS, [f"{words}: what depends on steps is not compared"]
    octaves = float(np.log2(now / before))
    if abs(octaves) <= np.log2(1.0 + SAME_RATE):
        return ALL, []
    if octaves > 0.0 and abs(octaves - round(octaves)) > 0.03:  # ranges of one gyro double
        return ALL, []
    words = f"rates come in steps of {before:.4g} deg/s, in these recordings in steps of {now:.4g}"
    return SLOW, [f"{words}: is it the same device with the same range? {SLOW_ONLY}"]


def _hide_noise(recordings: Sequence[Recording], step_dps: float) -> bool:
    """Whether steps round the noise away, because it is less than half a step: a mean of many samples is biased then.

    Finer steps add white noise (B. Widrow, Statistical analysis of amplitude-quantized sampled-data systems, 1961).
    Noise of half a step and rounding have a standard deviation of 1/√3 of a step together.
    """
    return bool(np.median([_scatter_dps(recording) for recording in recordings]) < step_dps / np.sqrt(3.0))


def _scatter_dps(recording: Recording) -> float:
    """Standard deviation of the noise of a sample, from second differences without the quarter with the most motion."""
    bends_dps = np.abs(np.diff(recording.rate_dps[np.isfinite(recording.rate_dps)], 2)) / np.sqrt(6.0)
    kept = np.sort(bends_dps)[: max(1, int(CALM * len(bends_dps)))]
    limit = float(ndtri(0.5 + 0.5 * CALM))
    density = np.exp(-0.5 * limit**2) / np.sqrt(2.0 * np.pi)
    return float(np.sqrt(np.mean(np.square(kept)) / (1.0 - 2.0 * limit * density / CALM)))


def _steps_dps(recordings: Sequence[Recording]) -> float | None:
    """Median step of the rates; 0 if they have no steps, None if there are too few different rates."""
    levels_of_each = [
        levels
        for levels in (levels_of(recording.rate_dps) for recording in recordings)
        if len(levels.values) > LEAST_GAPS
    ]
    steps = [levels.step for levels in levels_of_each if levels.step is not None]
    if not levels_of_each:
        return None
    if 2 * len(steps) > len(levels_of_each):
        return float(np.median(steps))
    decimal = float(np.median([levels.text for levels in levels_of_each]))
    # Decimals that round the noise away are steps, whoever rounds.
    return decimal if decimal > 0.0 and _hide_noise(recordings, decimal) else 0.0


ADOPTED_FROM, TIMES_ADOPTED_FROM = 0.8, 0.5
"""Probability from which on a cause of the baseline goes into the rig, and the same for effects on times alone. Chosen:
a less probable cause stays in the difference that is subtracted. An effect on times alone changes no other feature, so
it goes into the rig as soon as it is more probable than not."""


class ExplainedBaseline(NamedTuple):
    """The result of diagnosing the baseline.

    rig
        The rig with the causes of the baseline.
    baseline
        The difference between the baseline and this rig.
    subjects
        Recordings of the baseline, calibrated to this rig.
    least_noise_dps_rthz
        Least noise that a recording of this device is calibrated to.
    remarks
        Sentences about the baseline for the report.
    background
        Random effects of its most probable set that are not in the rig: what the device does without a name.
    response
        Response from reference to gyro in both sets; None if the reference is not corrected.
    """

    rig: Rig
    baseline: Baseline
    subjects: list[Subject]
    least_noise_dps_rthz: float
    remarks: list[str]
    background: tuple[Sized, ...] = ()
    response: ReferenceResponse | None = None


def explained_baseline(request: DiagnosisRequest, recordings: Sequence[Recording]) -> ExplainedBaseline:
    """Diagnose the baseline by itself, and store the difference that its causes do not explain.

    recordings
        The recordings that will be compared with the baseline.

    Raises
    ------
    DataError
        If no recording of the baseline can be used.
    """
    of_baseline, remarks = recordings_of(request.baseline, request.progress, request.baseline_reading)
    temp_c = _constant_temp_c(of_baseline, recordings)
    of_baseline = [recording if temp_c is None else recording.at_temperature(temp_c) for recording in of_baseline]
    response = _response_of(of_baseline, recordings)
    of_baseline = with_corrected_reference(response, of_baseline)
    base = request.rig.base
    rig = with_facts(request.rig, contradictions(of_baseline, base.dps_per_lsb, base.encoder_cpr))
    rig = with_recorded_axes(rig, [*of_baseline, *recordings])
    own = request._replace(rig=rig)
    simulated = simulated_of(own, of_baseline)
    inferred = inferred_of(simulated, request.jobs, request.progress)
    # A random cause beside something unknown may only stand for its scatter, so it stays in the background.
    is_clear = inferred.explanation.posterior.unknown < SURELY_UNKNOWN
    causes = [
        cause
        for cause in inferred.verdict.causes
        if cause.probability >= _adopted_from(cause) and (is_clear or not cause.cause.is_random)
    ]
    in_rig = {cause.effect.name for cause in causes}
    best = inferred.explanation.posterior.most_probable.placed
    background = [item.sized for item in best if item.sized.is_random and item.template.name not in in_rig]
    rig = adopted(rig, causes)
    subjects, tables = simulated.subjects, simulated.tables
    if causes:
        subjects = [subject_of(recording, rig) for recording in of_baseline]
        tables = response_tables(SimulationPlan(tuple(subjects), ()), request.jobs, request.progress)
    if request.rig.base.three_axes is not None and rig.base.three_axes is None:
        remarks.append("its recordings have one axis: the yaw rate alone is compared")
    remarks = [f"baseline: {remark}" for remark in remarks] + _remarks(causes, len(of_baseline), response)
    compared, differ = compared_of(of_baseline, recordings)
    baseline = baseline_of(tables, [subject.design for subject in subjects], compared)
    # If a device has less than half of the noise of its baseline, that is a gap, and it is not calibrated away.
    noise = min(subject.rig.base.noise_dps_rthz for subject in subjects) / 2.0
    least_noise = noise if is_same_rate(of_baseline, recordings) else 0.0
    return ExplainedBaseline(rig, baseline, subjects, least_noise, [*remarks, *differ], tuple(background), response)


def _remarks(causes: Sequence[NamedCause], recordings: int, response: ReferenceResponse | None) -> list[str]:
    """Sentences on the effects and the reference of the baseline."""
    names = ", ".join(cause.effect.name for cause in causes)
    shows = f"it already shows {names}, which the rig lacks; only changes since then are reported"
    shows_nothing = f"no cause is named in its {recordings} recordings; changes since then are reported"
    remarks = [f"baseline: {shows if causes else shows_nothing}"]
    if response is not None:
        gain, delay_ms = round(response.gain, 3), round(1e3 * response.delay_s, 1)
        differs = [
            *[f"{response.gain:.4g} times as far as its reference"] * (gain != 1.0),
            *[f"{abs(delay_ms):.1f} ms {'later' if delay_ms > 0.0 else 'earlier'} than its reference"]
            * (delay_ms != 0.0),
        ]
        if differs:
            turns = f"the gyro turns {' and '.join(differs)}"
            remarks.append(f"baseline: {turns}; the references of both sets are corrected for that")
    return remarks


def _constant_temp_c(of_baseline: Sequence[Recording], recordings: Sequence[Recording]) -> float | None:
    """Median temperature of the recordings, if they have one and the baseline, such as a simulator, has none."""
    temps_c = [recording.temp_c for recording in recordings if recording.temp_c is not None]
    if len(temps_c) < len(recordings) or all(recording.temp_c is not None for recording in of_baseline):
        return None
    return float(np.nanmedian(np.concatenate(temps_c)))


def _response_of(of_baseline: Sequence[Recording], recordings: Sequence[Recording]) -> ReferenceResponse | None:
    """The response of the baseline, if the references of both sets can be corrected by it."""
    if any(has_steps(recording.encoder_deg) for recording in recordings) or not is_same_rate(of_baseline, recordings):
        return None
    return reference_response_of(of_baseline)


def with_corrected_reference(response: ReferenceResponse | None, recordings: list[Recording]) -> list[Recording]:
    """Recordings with a corrected reference; unchanged without a response."""
    return recordings if response is None else [response.applied(item) for item in recordings]


def _adopted_from(cause: NamedCause) -> float:
    return TIMES_ADOPTED_FROM if cause.cause.candidate.touches is Touches.TIMES else ADOPTED_FROM


def without_baseline(
    tables: Sequence[ResponseTable], subjects: Sequence[Subject], baseline: Baseline
) -> tuple[ResponseTable, ...]:
    """Tables of recordings with the common difference of the baseline subtracted."""
    return tuple(against(tables, [subject.design for subject in subjects], baseline))
