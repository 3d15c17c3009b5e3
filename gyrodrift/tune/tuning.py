"""Tune one filter: search, then score on held-out sessions."""

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np

from gyrodrift.evaluation.cost import Scores
from gyrodrift.evaluation.dataset import LoadedSession, SessionSummary, Split, YawCurves, check_rates, yaw_curves
from gyrodrift.evaluation.kernels.kernel import kernel_of
from gyrodrift.evaluation.score import Score
from gyrodrift.evaluation.space import Axis, axes_of, candidates_of, params_record, row_of, values_of
from gyrodrift.filters.filter import Filter, FilterParams
from gyrodrift.filters.registry import PUBLISHED
from gyrodrift.io.progress import OnProgress, ignore_progress
from gyrodrift.tune.result import Pi, Run, SessionScore, Tuning
from gyrodrift.tune.search.journal import Journal
from gyrodrift.tune.search.methods import METHODS, run_to_budget
from gyrodrift.tune.search.objective import Objective
from gyrodrift.tune.warnings import (
    SCAN_POINTS,
    bound_warnings,
    held_out_warnings,
    identifiability_warnings,
    slice_candidates,
)
from gyrodrift.values.arrays import Floats
from gyrodrift.values.errors import DataError

REDUCED_EVALUATIONS = 600
"""Most evaluations for the reduced model: chosen."""

PLOTTED = 12
CURVE_POINTS = 500


@dataclass(frozen=True, slots=True)
class Plan:
    """Plan of a tuning of one filter."""

    evaluations: int = 3000
    seeds: tuple[int, ...] = (0,)
    method: str = "race"
    axes: tuple[Axis, ...] = axes_of(PUBLISHED)
    filter: Filter = PUBLISHED


class Costs(Protocol):
    """Source of costs, on this machine or on a cluster."""

    def cost(self, params: Floats, sessions: Sequence[int] | None = None) -> Scores:
        """Scores of candidates, shape (c, parameters), over some or all sessions."""
        ...

    def for_filter(self, chosen: Filter) -> "Costs":
        """Cost of another filter over the same sessions."""
        ...


@dataclass(slots=True)
class TuningRun:
    """A running tuning; after an interrupt the best result so far is scored.

    costs, sessions, splits
        Costs, descriptions and uses of the sessions, in one order.
    loaded
        Function that loads a session again, for its figure.
    prefix
        Prefix of the names of searches, in the journal and in the progress.
    """

    plan: Plan
    costs: Costs
    sessions: Sequence[SessionSummary]
    splits: Sequence[Split]
    loaded: Callable[[int], LoadedSession]
    journal: Journal
    progress: OnProgress = ignore_progress
    prefix: str = ""
    was_interrupted: bool = False
    _begun_s: float = field(default_factory=time.monotonic)

    def run(self) -> Tuning:
        """Search, and score the result.

        Raises
        ------
        DataError
            If yaw overflows for every parameter vector.
        """
        train, axes = self._used_for(Split.TRAIN), self.plan.axes
        runs: list[Run] = []
        for seed in self.plan.seeds:
            runs += [self._search(f"seed {seed}", seed, axes, train, self.plan.evaluations)]
            if self.was_interrupted:
                break
        best = min(runs, key=lambda run: float(run.history.min()))
        if not np.isfinite(best.pi.train):
            raise DataError("every parameter vector has an infinite cost; are the rates in deg/s?")
        reduced = self._reduced(best, train)
        is_cross_validated = not self._used_for(Split.TEST) and not self.was_interrupted
        cross_validation = self._cross_validated(best.seed) if is_cross_validated else {}
        return self._judge(best, tuple(run for run in runs if run is not best), reduced, cross_validation)

    def _reduced(self, best: Run, train: Sequence[int]) -> Run:
        """Search for the reduced model; the best run if the model is not reduced or after an interrupt."""
        model = self.plan.filter.reduced_model
        axes = tuple(axis for axis in self.plan.axes if axis.name in model.names)
        if self.was_interrupted or axes == self.plan.axes:
            return best
        evaluations = min(REDUCED_EVALUATIONS, self.plan.evaluations)
        return self._search(model.title, best.seed, axes, train, evaluations)

    def _used_for(self, split: Split) -> list[int]:
        return [index for index, split_used in enumerate(self.splits) if split_used is split]

    def _search(self, name: str, seed: int, axes: tuple[Axis, ...], sessions: Sequence[int], evaluations: int) -> Run:
        """Run a search over some sessions."""
        method = METHODS[self.plan.method]()
        chosen, searched, name = self.plan.filter, method.axes(axes), f"{self.prefix}{name}"

        def note(objective: Objective) -> None:
            self.journal.note(name, objective)
            self.progress(name, objective.count, objective.evaluations)

        def loss(params: Floats) -> Floats:
            return self._loss(candidates_of(chosen, searched, params), sessions)

        objective = Objective(loss, searched, evaluations, self.journal.cached(name), note)
        self.progress(name, 0, evaluations)
        try:
            run_to_budget(method, objective, seed)
        except KeyboardInterrupt:
            if not objective.count:
                raise
            self.was_interrupted = True
        best = candidates_of(chosen, searched, values_of(searched, objective.cube[objective.best][np.newaxis]))
        densities = [automaton.density for automaton in method.automata()]
        return Run(
            seed=seed,
            history=objective.costs.copy(),
            cube=objective.cube.copy(),
            params=params_record(chosen, best[0]),
            pi=self._pi_of(best)[0],
            densities=np.array(densities) if densities else None,
        )

    def _loss(self, params: Floats, sessions: Sequence[int]) -> Floats:
        """Cost of candidates, deg², with the sigma of drift alone: no search changes the scale error."""
        chosen = self.plan.filter
        scaled = [row_of(chosen.scaled(params_record(chosen, row), 0.0)) for row in params]
        return self.costs.cost(np.vstack(scaled), sessions).loss

    def _pi_of(self, params: Floats) -> list[Pi]:
        """PI of candidates on both splits."""
        train, test = self._used_for(Split.TRAIN), self._used_for(Split.TEST)
        on_train = self.costs.cost(params, train).pi.tolist()
        on_test = self.costs.cost(params, test).pi.tolist() if test else [None] * len(params)
        return [Pi(*means) for means in zip(on_train, on_test, strict=True)]

    def _cross_validated(self, seed: int) -> dict[str, Score]:
        """Score of each session with parameters tuned on all other sessions."""
        scores: dict[str, Score] = {}
        everyone = list(range(len(self.sessions)))
        for index, session in enumerate(self.sessions):
            training = [number for number in everyone if number != index]
            run = self._search(f"without {session.name}", seed, self.plan.axes, training, self.plan.evaluations)
            scores[session.name] = self.costs.cost(row_of(run.params), [index]).score(0, 0, session.minutes)
            if self.was_interrupted:
                return {}
        return scores

    def _judge(
        self, best: Run, other_runs: tuple[Run, ...], reduced: Run, cross_validation: dict[str, Score]
    ) -> Tuning:
        baseline, default = row_of(self.plan.filter.baseline), row_of(self.plan.filter.params())
        rows = [baseline, row_of(best.params), row_of(reduced.params), default]
        scores = self._scores(self.costs.cost(np.vstack(rows)))
        euler_pi = self._pi_of(baseline)[0]
        if cross_validation:
            held_out_pi = float(np.mean([score.pi_deg2 for score in cross_validation.values()]))
            best = replace(best, pi=replace(best.pi, test=held_out_pi))
            euler_pi = replace(euler_pi, test=euler_pi.train)
        axes = METHODS[self.plan.method]().axes(self.plan.axes)
        slices = self._slices(best.params)
        warnings = tuple(self._warnings(axes, best, euler_pi, slices))
        return Tuning(
            filter=self.plan.filter,
            method=self.plan.method,
            evaluations=self.plan.evaluations,
            axes=axes,
            run=best,
            euler=euler_pi,
            reduced=reduced.pi,
            reduced_params=reduced.params,
            scores=self._with_curves(scores, best.params),
            sample_rate_hz=float(np.median([session.sample_rate_hz for session in self.sessions])),
            seconds=time.monotonic() - self._begun_s,
            other_runs=other_runs,
            cross_validation=cross_validation,
            warnings=warnings,
            slices=slices,
            slice_axes=self.plan.axes,
        )

    def _slices(self, params: FilterParams) -> Floats:
        """Cost on the training sessions along each axis through these parameters, deg², shape (axes, SCAN_POINTS)."""
        rows = slice_candidates(self.plan.filter, self.plan.axes, params)
        return self._loss(rows, self._used_for(Split.TRAIN)).reshape(len(self.plan.axes), SCAN_POINTS)

    def _scores(self, scores: Scores) -> list[SessionScore]:
        """Scores by session; the candidates are in the order of `SessionScore`, then the defaults."""
        rows = []
        for index, (session, split) in enumerate(zip(self.sessions, self.splits, strict=True)):
            plain, tuned, reduced, default = (scores.score(index, row, session.minutes) for row in range(4))
            rows.append(SessionScore(session, split, plain, tuned, reduced, default=default))
        return rows

    def _warnings(self, axes: Sequence[Axis], best: Run, euler_pi: Pi, slices: Floats) -> Iterator[str]:
        """Sentences to read before the result is used."""
        chosen = self.plan.filter
        yield from (warning for session in self.sessions for warning in session.warnings)
        if chosen.counts_samples:
            yield from check_rates(self.sessions, chosen.sample_counted)
        if self.was_interrupted:
            yield "interrupted: these are the best parameters so far; continue with --resume"
        yield from bound_warnings(chosen, axes, best.params)
        yield from identifiability_warnings(chosen, self.plan.axes, slices)
        yield from held_out_warnings(best.pi, euler_pi)

    def _with_curves(self, scores: Sequence[SessionScore], params: FilterParams) -> tuple[SessionScore, ...]:
        """Scores, with curves for the worst sessions of each split."""
        plotted: set[int] = set()
        for split in Split:
            plotted |= set(sorted(self._used_for(split), key=lambda index: -scores[index].tuned.e_deg)[:PLOTTED])
        return tuple(
            replace(score, curves=_curves(self.plan.filter, self.loaded(index), params)) if index in plotted else score
            for index, score in enumerate(scores)
        )


def _curves(chosen: Filter, loaded: LoadedSession, params: FilterParams) -> YawCurves:
    """Yaw of plain integration, as the filter integrates, and of the tuned filter."""
    reference, run = loaded.reference, kernel_of(chosen).yaw
    rows = (row_of(chosen.baseline)[0], row_of(params)[0])
    yaws_deg = [run(reference.dt_s, reference.rate_dps, row, reference.auxiliary) for row in rows]
    return yaw_curves(loaded, yaws_deg, CURVE_POINTS)
