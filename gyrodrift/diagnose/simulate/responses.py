"""How features respond to each candidate: a session's own figures, its null distribution, and simulated responses.

Everything that a session contributes is worked out by itself, in one task; what follows works on the tables alone.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from firmware_sim.effects.effect import Effect
from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features.vector import measure
from gyrodrift.diagnose.recording.outliers import Cleaned
from gyrodrift.diagnose.simulate.candidate import Candidate, Touches
from gyrodrift.diagnose.simulate.noise_beneath import with_noise_beneath
from gyrodrift.diagnose.simulate.response_table import ResponseTable, SimulatedSet, Sized, key
from gyrodrift.diagnose.simulate.twin import BaseRun, Subject, subject_of

NULL_RUNS_TOGETHER, NULL_RUNS_LEAST, NULL_RUNS_MOST = 24, 4, 10
"""Null runs of all sessions together, and of each."""

FIRST_NULL_SEED = 1000


REALISATIONS_PER_NULL_RUN, REALISATIONS_LEAST = 2, 4
"""Realisations of a random candidate in a session: some fifty in all sessions together, as long as these are few."""


def null_runs_of(sessions: int) -> int:
    """How many each of so many sessions takes."""
    return min(max(-(-NULL_RUNS_TOGETHER // sessions), NULL_RUNS_LEAST), NULL_RUNS_MOST)


def response_table(subject: Subject, tried: Sequence[Candidate], null_runs: int) -> ResponseTable:
    """Simulate all that is to be known of a session; the same random streams with and without an effect."""
    own = subject.measured()
    base = [subject.base_run(seed) for seed in range(4)]
    # Other phases are composed of these two.
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
    """(grid points, realisations, F) what a candidate changes; realisations take the base runs in turn."""
    used = [(seed, base[seed % len(base)]) for seed in range(candidate.realisations)]
    changes = []
    for size in candidate.grid_points.tolist():
        calibrated = _calibrated(subject, candidate, size)
        changes.append([_features_with(calibrated, candidate, size, run, seed) - run.values for seed, run in used])
    return np.array(changes)


def _calibrated(subject: Subject, candidate: Candidate, size: float) -> Subject:
    """The rig calibrated beside an effect of a size, where the effect is played again."""
    if candidate.shape is None and candidate.touches in (Touches.VALUES, Touches.EVERYTHING):
        return with_noise_beneath(subject, (candidate.applied(size, subject.rig.effects),))
    return subject


def null_difference(subject: Subject, seed: int) -> Floats:
    """(F,) the difference that is left when the rig is taken for a recording, and driven through itself."""
    again = subject_of(subject.played((), seed), subject.rig)
    runs = [again.simulated((), FIRST_NULL_SEED + seed + number).values for number in range(2)]  # two runs of the base
    left: Floats = again.measured().values - np.mean(runs, axis=0)
    return left


def _features_with(subject: Subject, candidate: Candidate, size: float, base: BaseRun, seed: int) -> Floats:
    """(F,) features with a realisation of a candidate; those of what it does not touch are taken over."""
    stands = subject.rig.effects
    if candidate.shape is not None:
        shaped = subject.with_shape(candidate.shape, size, seed, base.cleaned)
        is_slow = candidate.touches is Touches.SLOW_RATE
        features_of = subject.residual_features if is_slow else subject.value_features
        return _first(features_of(shaped, base), base.values)
    effects = (candidate.applied(size, stands),)
    match candidate.touches:
        case Touches.SLOW_RATE:
            with_it = subject.with_rate((candidate.added(size, stands),), base, seed)
            return _first(subject.residual_features(with_it, base), base.values)
        case Touches.RATE:
            with_it = subject.with_rate((candidate.added(size, stands),), base, seed)
            return _first(subject.value_features(subject.in_counts(with_it), base), base.values)
        case Touches.TIMES:
            times = subject.time_features(effects, base.seed)
            return np.concatenate([base.values[: -len(times)], times])
        case Touches.VALUES:
            return _first(subject.value_features(subject.replayed(effects, base.seed), base), base.values)
        case Touches.EVERYTHING:
            seen = subject.replayed(effects, base.seed)
            return measure(seen, subject.design_for(seen, base), subject.facts).values


def _first(features: Floats, others: Floats) -> Floats:
    """The first features, and behind them those of a run without the candidate."""
    return np.concatenate([features, others[len(features) :]])


def change_of(effects: Sequence[Sized], subjects: Sequence[Subject], tables: Sequence[ResponseTable]) -> SimulatedSet:
    """Change of the features by a whole set of candidates, in all sessions."""
    pairs = enumerate(zip(subjects, tables, strict=True))
    return together([change_in(effects, number, subject, table) for number, (subject, table) in pairs])


def together(sessions: Sequence[SimulatedSet]) -> SimulatedSet:
    """One simulated set of all sessions."""
    changes, variances = np.array([one.change for one in sessions]), np.array([one.variance for one in sessions])
    return SimulatedSet(changes, variances, sessions[0].runs)


def change_in(effects: Sequence[Sized], number: int, subject: Subject, table: ResponseTable) -> SimulatedSet:
    """Change of the features by a whole set of candidates in session `number`."""
    known = tuple(in_session(one, number, subject) for one in effects if not one.candidate.is_out_of_catalogue)
    calibrated = with_noise_beneath(subject, known)
    is_random = any(one.is_random for one in effects)
    runs = table.runs[: 4 if is_random else 3]  # the motion is rebuilt in each, which moves slow features by chance
    changes = np.array([
        _features(effects, subject, calibrated.replayed(known, seed), seed, run) - run for seed, run in enumerate(runs)
    ])  # fmt: skip
    return SimulatedSet(changes.mean(axis=0), changes.var(axis=0, ddof=1), len(changes))


def _features(effects: Sequence[Sized], subject: Subject, seen: Cleaned, seed: int, run: Floats) -> Floats:
    """(F,) of a set whose known effects were played; those that it does not touch are taken over from a run without."""
    for one in effects:
        if one.candidate.shape is not None:
            seen = subject.with_shape(one.candidate.shape, one.size, seed, seen)
    if any(one.candidate.touches in (Touches.TIMES, Touches.EVERYTHING) for one in effects):
        return subject.measured_again(seen).values
    values = subject.values_measured_again(seen)
    return np.concatenate([values, run[len(values) :]])


def in_session(one: Sized, number: int, subject: Subject) -> Effect:
    """The effect as it is in session `number`."""
    effect = one.candidate.applied(one.size, subject.rig.effects)
    if one.phases_deg is None:
        return effect
    return effect.model_copy(update={"phase_deg": float(one.phases_deg[number])})
