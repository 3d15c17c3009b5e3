"""Responses of the features of a session to candidates, and the null distribution of the session.

All simulations of a session are one task. The inference works on the resulting tables alone.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from firmware_sim.effects.effect import Effect
from gyrodrift.diagnose.features.design_matrix import DesignMatrix
from gyrodrift.diagnose.features.vector import measure
from gyrodrift.diagnose.recording.outliers import Cleaned
from gyrodrift.diagnose.simulate.candidate import Candidate, Touches
from gyrodrift.diagnose.simulate.recalibration import recalibrated_with
from gyrodrift.diagnose.simulate.response_table import ENOUGH, ResponseTable, SimulatedSet, Sized, key
from gyrodrift.diagnose.simulate.twin import BaseRun, Subject, subject_of
from gyrodrift.values.arrays import Floats

NULL_RUNS_TOGETHER, NULL_RUNS_LEAST, NULL_RUNS_MOST = 18, 3, 10
"""Null runs of all sessions together; and the minimum and maximum per session. Chosen: speed."""

FIRST_NULL_SEED = 1000
"""First seed of the null runs. Chosen: far from those of base runs and realizations, which begin at 0."""

REALISATIONS_PER_NULL_RUN, NULL_RUNS_OF_FEW = 2, 6
"""Maximum number of realizations of a random candidate, per null run of a session. Chosen: for a few sessions about
fifty in all sessions together. The realizations of a candidate with less than ENOUGH are pooled. Up to three sessions,
which have so many null runs, each have them all; more sessions have about as many together."""


def null_runs_of(sessions: int) -> int:
    """Number of null runs per session, for a number of sessions."""
    return min(max(-(-NULL_RUNS_TOGETHER // sessions), NULL_RUNS_LEAST), NULL_RUNS_MOST)


RULED_OUT = 30.0
"""Norm of all features, in standard deviations, by which a size lies further from a recording than no effect does.
Larger sizes are not simulated. Chosen: a chi-squared of 900 and more, so that no error of a standard deviation from
three null runs matters."""

ADDED = (Touches.SLOW_RATE, Touches.RATE)
"""Parts that are changed by effects that only add to the rate."""

Compared = Callable[[ResponseTable, DesignMatrix], ResponseTable]
"""Function that subtracts a baseline from the differences of a table."""


def response_table(
    subject: Subject,
    tried: Sequence[Candidate],
    null_runs: int,
    points: Mapping[str, int] | None = None,
    compared: Compared | None = None,
) -> ResponseTable:
    """Simulate a session without and with candidates, with the same random streams.

    points
        Number of grid points to simulate, by key of the candidate; a candidate with 0 is left out. None simulates
        rising sizes up to the first one that this session rules out.
    compared
        Function that subtracts a baseline, so that a size is judged by the remaining difference.
    """
    own = subject.measured()
    base = [subject.base_run(seed) for seed in range(4)]
    runs = np.array([run.values for run in base])
    nulls = np.array([null_difference(subject, FIRST_NULL_SEED + number) for number in range(null_runs)])
    table = ResponseTable(
        name=subject.cleaned.recording.name,
        difference=own.values - runs.mean(axis=0),
        thresholds=own.thresholds,
        runs=runs,
        nulls=nulls,
        responses={},
    )
    judge = _SizeJudge(table if compared is None else compared(table, subject.design))
    # Responses at all other phases are combined from these two.
    simulated = [candidate for candidate in tried if candidate.phase_deg in (None, 0.0, 90.0)]
    for candidate in simulated:
        count = len(candidate.grid_points) if points is None else points[key(candidate)]
        if not count:
            continue
        is_stopped = judge.rules_out if points is None and _may_stop(candidate) else _never
        few = replace(candidate.up_to(count), realisations=_realisations_of(candidate, null_runs))
        table.responses[key(candidate)] = response(subject, few, base, is_stopped)
    return table


def points_of(table: ResponseTable) -> dict[str, int]:
    """Number of simulated grid points, by key of the candidate."""
    return {name: len(changes) for name, changes in table.responses.items()}


def plausible(tried: Sequence[Candidate], tables: Sequence[ResponseTable]) -> list[Candidate]:
    """Candidates at the sizes that were simulated; the first recording rules out all larger ones."""
    points = points_of(tables[0])
    return [candidate.up_to(points.get(key(candidate), len(candidate.grid_points))) for candidate in tried]


def _realisations_of(candidate: Candidate, null_runs: int) -> int:
    """Number of realizations in a session that has so many null runs."""
    count = candidate.realisations
    if count < ENOUGH:
        return min(count, -(-count * null_runs // NULL_RUNS_OF_FEW))
    return min(count, REALISATIONS_PER_NULL_RUN * null_runs)


def _may_stop(candidate: Candidate) -> bool:
    """Whether each size is a stronger effect than the one before, and takes a simulation of its own."""
    return candidate.in_rig is None and candidate.grid_points[0] > 0.0 and candidate.shape is None


class _SizeJudge:
    """Judges whether a session rules out a size, from the differences and the null runs of a table."""

    def __init__(self, table: ResponseTable) -> None:
        chance = table.nulls.var(axis=0) + table.runs.var(axis=0)
        sigma = np.sqrt(np.square(table.thresholds) + chance)
        self._weight = np.divide(1.0, sigma, out=np.zeros_like(sigma), where=sigma > 0.0)
        self._difference = table.difference - table.nulls.mean(axis=0)
        self._table = table

    def rules_out(self, change: Floats) -> bool:
        """Whether a change of the features, (realizations, F), is far from the difference, and no effect is nearer."""
        without, with_it = (
            float(np.linalg.norm(values * self._weight))
            for values in (self._difference, self._difference - self._table.in_device(change).mean(axis=0))
        )
        return with_it > without + RULED_OUT


def _never(_: Floats) -> bool:
    return False


def response(
    subject: Subject,
    candidate: Candidate,
    base: Sequence[BaseRun],
    is_stopped: Callable[[Floats], bool] = _never,
) -> Floats:
    """Change of the features by a candidate, shape (grid points, realizations, F).

    Realizations use the base runs in rotation. Sizes after one at which `is_stopped` are not simulated.
    """
    used = [(seed, base[seed % len(base)]) for seed in range(candidate.realisations)]
    added_dps = {seed: _added_dps(subject, candidate, run, seed) for seed, run in used} if _is_scaled(candidate) else {}
    changes: list[Floats] = []
    for size in candidate.grid_points.tolist():
        calibrated = _calibrated(subject, candidate, size)
        features = [
            _features_of_rate(subject, candidate, run, run.cleaned.rate_dps + size * added_dps[seed])
            if added_dps
            else _features_with(calibrated, candidate, size, run, seed)
            for seed, run in used
        ]
        changes.append(np.array([values - run.values for values, (_, run) in zip(features, used, strict=True)]))
        # An interpolation needs two sizes.
        if len(changes) > 1 and is_stopped(changes[-1]):
            break
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


def _is_scaled(candidate: Candidate) -> bool:
    """Whether a candidate adds a realization to the rate in proportion to its size, so that one holds for all sizes."""
    return candidate.shape is not None or (candidate.realisations > 1 and candidate.touches in ADDED)


def _added_dps(subject: Subject, candidate: Candidate, base: BaseRun, seed: int) -> Floats:
    """Rate that a realization of a candidate adds at size 1, deg/s, shape (n,)."""
    if candidate.shape is not None:
        return subject.shape_dps(candidate.shape, seed)
    largest = float(candidate.grid_points[-1])
    effect = candidate.added(largest, subject.rig.effects)
    return (subject.rate_with(effect, base, seed) - base.cleaned.rate_dps) / largest


def _features_of_rate(subject: Subject, candidate: Candidate, base: BaseRun, rate_dps: Floats) -> Floats:
    """Features of a base run with another rate, shape (F,); unaffected features are copied from the base run."""
    simulated = replace(base.cleaned, rate_dps=rate_dps)
    if candidate.touches is Touches.SLOW_RATE:
        return _with_rest_of(subject.residual_features(simulated, base), base.values)
    if candidate.touches is Touches.RATE:
        simulated = subject.in_counts(simulated)
    return _with_rest_of(subject.value_features(simulated, base), base.values)


def _features_with(subject: Subject, candidate: Candidate, size: float, base: BaseRun, seed: int) -> Floats:
    """Features with a realization of an effect, shape (F,); unaffected features are copied from the base run."""
    rig_effects = subject.rig.effects
    effects = (candidate.applied(size, rig_effects),)
    match candidate.touches:
        case Touches.SLOW_RATE | Touches.RATE:
            rate_dps = subject.rate_with(candidate.added(size, rig_effects), base, seed)
            return _features_of_rate(subject, candidate, base, rate_dps)
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
    changes = table.in_device(np.array([
        _features(effects, subject, calibrated.replayed(catalog_effects, seed), seed, run) - run
        for seed, run in enumerate(runs)
    ]))  # fmt: skip
    return SimulatedSet(changes.mean(axis=0), changes.var(axis=0, ddof=1), len(changes))


def _features(effects: Sequence[Sized], subject: Subject, simulated: Cleaned, seed: int, run: Floats) -> Floats:
    """Features of a set, shape (F,); unaffected features are copied from a run without the set.

    simulated
        Simulation with those effects of the set that are in the catalog.
    """
    for effect in effects:
        if effect.candidate.shape is not None:
            added_dps = effect.size * subject.shape_dps(effect.candidate.shape, seed)
            simulated = replace(simulated, rate_dps=simulated.rate_dps + added_dps)
    if any(effect.candidate.touches in (Touches.TIMES, Touches.EVERYTHING) for effect in effects):
        return subject.measured_again(simulated).values
    return _with_rest_of(subject.values_measured_again(simulated), run)


def in_session(sized: Sized, index: int, subject: Subject) -> Effect:
    """The effect with the phase of session `index`."""
    effect = sized.candidate.applied(sized.size, subject.rig.effects)
    if sized.phases_deg is None:
        return effect
    return effect.model_copy(update={"phase_deg": float(sized.phases_deg[index])})
