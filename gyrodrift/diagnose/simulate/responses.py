"""How features respond to each candidate: a session's own figures, its null distribution, and simulated responses.

Everything that a session contributes is worked out by itself, in one task; what follows works on the tables alone.
"""

from collections.abc import Sequence

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.simulate.candidate import Candidate, Touches
from gyrodrift.diagnose.simulate.response_table import ResponseTable, key
from gyrodrift.diagnose.simulate.twin import BaseRun, Subject, subject_of

BASE_RUNS = 4
NULL_RUNS = 5
NULL_BASE_RUNS = 2
FIRST_NULL_SEED = 1000

SIMULATED_PHASES_DEG = (0.0, 90.0)
"""Every other phase is composed of these two."""


def response_table(subject: Subject, tried: Sequence[Candidate]) -> ResponseTable:
    """Simulate all that is to be known of a session; the same random streams with and without an effect."""
    own = subject.measured()
    base = [subject.base_run(seed) for seed in range(BASE_RUNS)]
    simulated = [candidate for candidate in tried if candidate.phase_deg in (None, *SIMULATED_PHASES_DEG)]
    responses = {key(candidate): response(subject, candidate, base) for candidate in simulated}
    runs = np.array([run.values for run in base])
    nulls = np.array([null_difference(subject, FIRST_NULL_SEED + number) for number in range(NULL_RUNS)])
    name = subject.seen.recording.name
    return ResponseTable(name, own.values - runs.mean(axis=0), own.thresholds, runs, nulls, responses)


def response(subject: Subject, candidate: Candidate, base: Sequence[BaseRun]) -> Floats:
    """(grid points, realisations, F) what a candidate changes; there is a base run for each realisation."""
    used = base[: candidate.realisations]
    changes = [
        [_features_with(subject, candidate, float(size), run) - run.values for run in used]
        for size in candidate.grid_points
    ]
    return np.array(changes)


def null_difference(subject: Subject, seed: int) -> Floats:
    """(F,) the difference that is left when the rig is taken for a recording, and driven through itself."""
    played = subject.replayed((), seed)
    again = subject_of(played.recording, subject.rig)
    runs = [again.simulated((), number).values for number in range(NULL_BASE_RUNS)]
    left: Floats = again.measured().values - np.mean(runs, axis=0)
    return left


def _features_with(subject: Subject, candidate: Candidate, size: float, base: BaseRun) -> Floats:
    """(F,) features with a candidate; those of what it does not touch are taken over."""
    if candidate.shape is not None:
        shaped = subject.with_shape(candidate.shape, size, base.seed, base.seen)
        return _first(subject.residual_features(shaped), base.values)
    effects = (candidate.make(size),)
    match candidate.touches:
        case Touches.SLOW_RATE:
            return _first(subject.residual_features(subject.with_rate(effects, base.seed, base.seen)), base.values)
        case Touches.TIMES:
            times = subject.time_features(effects, base.seed)
            return np.concatenate([base.values[: -len(times)], times])
        case Touches.VALUES:
            calibrated = subject.with_noise(candidate.noise_share)
            return _first(calibrated.value_features(calibrated.replayed(effects, base.seed)), base.values)
        case Touches.EVERYTHING:
            return subject.with_noise(candidate.noise_share).simulated(effects, base.seed).values


def _first(features: Floats, others: Floats) -> Floats:
    """The first features, and behind them those of a run without the candidate."""
    return np.concatenate([features, others[len(features) :]])
