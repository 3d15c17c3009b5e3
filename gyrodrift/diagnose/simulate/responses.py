"""Responses of the features of a session to candidates, and the null distribution of the session.

All simulations of a session are one task. The inference works on the resulting tables alone.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from firmware_sim.effects.effect import Effect
from gyrodrift.diagnose.features.vector import measure
from gyrodrift.diagnose.recording.outliers import Cleaned
from gyrodrift.diagnose.simulate.candidate import Candidate, Touches
from gyrodrift.diagnose.simulate.recalibration import recalibrated_with
from gyrodrift.diagnose.simulate.response_table import ResponseTable, SimulatedSet, Sized, key
from gyrodrift.diagnose.simulate.twin import BaseRun, Subject, subject_of
from gyrodrift.values.arrays import Floats

NULL_RUNS_TOGETHER, NULL_RUNS_LEAST, NULL_RUNS_MOST = 24, 4, 10
"""Null runs of all sessions together; and the minimum and maximum per session."""

FIRST_NULL_SEED = 1000

REALISATIONS_PER_NULL_RUN, REALISATIONS_LEAST = 2, 4
"""Maximum number of realizations of a random candidate, per null run of a session, and its lower bound. For a few
sessions this is about fifty in all sessions together."""


def null_runs_of(sessions: int) -> int:
    """Number of null runs per session, for a number of sessions."""
    return min(max(-(-NULL_RUNS_TOGETHER // sessions), NULL_RUNS_LEAST), NULL_RUNS_MOST)


def response_table(subject: Subject, tried: Sequence[Candidate], null_runs: int) -> ResponseTable:
    """Simulate a session without and with candidates, with the same random streams."""
    own = subject.measured()
    base = [subject.base_run(seed) for seed in range(4)]
    # Responses at all other phases are combined from these two.
    simulated = [candidate for candidate in tried if candidate.phase_deg in (None, 0.0, 90.0)]
    most = max(REALISATIONS_PER_NULL_RUN * null_runs, REALISATIONS_LEAST)
    responses = {key(candidate): response(subject, _with_fewer(candidate, most), base) for candidate in simulated}
    runs = np.array([run.values for run in base])
    nulls = np.array([null_difference(subject, FIRST_NULL_SEED + number) for number in range(null_runs)])
    return ResponseTable(
        name=subject.cleaned.recording.name,
        difference=own.values - runs.mean(axis=0),
        thresholds=own.thresholds,
        runs=runs,
        nulls=nulls,
        responses=responses,
    )


def _with_fewer(candidate: Candidate, most: int) -> Candidate:
    return replace(candidate, realisations=min(candidate.realisations, most))


def response(subject: Subject, candidate: Candidate, base: Sequence[BaseRun]) -> Floats:
    """Change of the features by a candidate, shape (grid points, realizations, F).

    Realizations use the base runs in rotation.
    """
    used = [(seed, base[seed % len(base)]) for seed in range(candidate.realisations)]
    changes = []
    for size in candidate.grid_points.tolist():
        calibrated = _calibrated(subject, candidate, size)
        changes.append([_features_with(calibrated, candidate, size, run, seed) - run.values for seed, run in used])
    return np.array(changes)


def _calibrated(subject: Subject, candidate: Candidate, size: float) -> Subject:
    """The subject calibrated with an effect of a size, if the effect is simulated again; else unchanged."""
    if candidate.shape is None and candidate.touches in (Touches.VALUES, Touches.EVERYTHING):
        return recalibrated_with(subject, (candidate.applied(size, subject.rig.effects),))
    return subject


def null_difference(subject: Subject, seed: int) -> Floats:
    """Feature difference, shape (F,), of a simulation that is taken for a recording and simulated again."""
    again = subject_of(subject.played((), seed), subject.rig)
    runs = [again.simulated((), FIRST_NULL_SEED + seed + number).values for number in range(2)]  # two runs of the base
    difference: Floats = again.measured().values - np.mean(runs, axis=0)
    return difference


def _features_with(subject: Subject, candidate: Candidate, size: float, base: BaseRun, seed: int) -> Floats:
    """Features with a realization of a candidate, shape (F,); unaffected features are copied from the base run."""
    rig_effects = subject.rig.effects
    if candidate.shape is not None:
        shaped = subject.with_shape(candidate.shape, size, seed, base.cleaned)
        is_slow = candidate.touches is Touches.SLOW_RATE
        features_of = subject.residual_features if is_slow else subject.value_features
        return _with_rest_of(features_of(shaped, base), base.values)
    effects = (candidate.applied(size, rig_effects),)
    match candidate.touches:
        case Touches.SLOW_RATE:
            with_it = subject.with_rate((candidate.added(size, rig_effects),), base, seed)
            return _with_rest_of(subject.residual_features(with_it, base), base.values)
        case Touches.RATE:
            with_it = subject.with_rate((candidate.added(size, rig_effects),), base, seed)
            return _with_rest_of(subject.value_features(subject.in_counts(with_it), base), base.values)
        case Touches.TIMES:
            times = subject.time_features(effects, base.seed)
            return np.concatenate([base.values[: -len(times)], times])
        case Touches.VALUES:
            return _with_rest_of(subject.value_features(subject.replayed(effects, base.seed), base), base.values)
        case Touches.EVERYTHING:
            simulated = subject.replayed(effects, base.seed)
            return measure(simulated, subject.design_for(simulated, base), subject.facts).values


def _with_rest_of(first_features: Floats, base_features: Floats) -> Floats:
    """The first features, completed with those of a run without the candidate."""
    return np.concatenate([first_features, base_features[len(first_features) :]])


def change_of(effects: Sequence[Sized], subjects: Sequence[Subject], tables: Sequence[ResponseTable]) -> SimulatedSet:
    """Change of the features by a set of candidates that act together, in all sessions."""
    pairs = enumerate(zip(subjects, tables, strict=True))
    return together([change_in(effects, index, subject, table) for index, (subject, table) in pairs])


def together(sessions: Sequence[SimulatedSet]) -> SimulatedSet:
    """Simulated sets of single sessions as one set."""
    changes = np.array([session.change for session in sessions])
    variances = np.array([session.variance for session in sessions])
    return SimulatedSet(changes, variances, sessions[0].runs)


def change_in(effects: Sequence[Sized], index: int, subject: Subject, table: ResponseTable) -> SimulatedSet:
    """Change of the features by a set of candidates that act together, in session `index`."""
    catalog_effects = tuple(
        in_session(effect, index, subject) for effect in effects if not effect.candidate.is_out_of_catalogue
    )
    calibrated = recalibrated_with(subject, catalog_effects)
    is_random = any(effect.is_random for effect in effects)
    # Several runs, even of a deterministic set: rebuilding the motion changes slow features at random.
    runs = table.runs[: 4 if is_random else 3]
    changes = np.array([
        _features(effects, subject, calibrated.replayed(catalog_effects, seed), seed, run) - run
        for seed, run in enumerate(runs)
    ])  # fmt: skip
    return SimulatedSet(changes.mean(axis=0), changes.var(axis=0, ddof=1), len(changes))


def _features(effects: Sequence[Sized], subject: Subject, simulated: Cleaned, seed: int, run: Floats) -> Floats:
    """Features of a set, shape (F,); unaffected features are copied from a run without the set.

    simulated
        Simulation with those effects of the set that are in the catalog.
    """
    for effect in effects:
        if effect.candidate.shape is not None:
            simulated = subject.with_shape(effect.candidate.shape, effect.size, seed, simulated)
    if any(effect.candidate.touches in (Touches.TIMES, Touches.EVERYTHING) for effect in effects):
        return subject.measured_again(simulated).values
    return _with_rest_of(subject.values_measured_again(simulated), run)


def in_session(sized: Sized, index: int, subject: Subject) -> Effect:
    """The effect with the phase of session `index`."""
    effect = sized.candidate.applied(sized.size, subject.rig.effects)
    if sized.phases_deg is None:
        return effect
    return effect.model_copy(update={"phase_deg": float(sized.phases_deg[index])})
