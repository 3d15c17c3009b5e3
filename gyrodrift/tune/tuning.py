"""A tuning from its sessions to its result: search, and proof on what was kept apart."""

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import astuple, dataclass, field, replace
from typing import NamedTuple, Protocol

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.errors import DataError
from gyrodrift.evaluation.cost import Scores
from gyrodrift.evaluation.dataset import About, Split, check_rates
from gyrodrift.evaluation.kernels.hdr import euler
from gyrodrift.evaluation.reference import Course
from gyrodrift.evaluation.space import Axis, params_of
from gyrodrift.evaluation.tunables import HDR_TUNABLE, Tunable
from gyrodrift.filters.registry import Params
from gyrodrift.tune.result import Curve, Pi, Run, SessionScore, Tuning
from gyrodrift.tune.search.journal import Journal
from gyrodrift.tune.search.methods import METHODS, spend
from gyrodrift.tune.search.objective import Objective
from gyrodrift.tune.warnings import bound_caveats, flat_caveats, worse_caveats

FEW_EVALUATIONS = 600
"""Few parameters are found with fewer evaluations than all of them."""

CURVES = 12
CURVE_POINTS = 500


class LeftOut(NamedTuple):
    """A session under parameters tuned on the others: mean absolute error in deg, mean squared error in deg²."""

    e_deg: float
    mean_square: float


Progress = Callable[[str, int, int], None]
"""Told what is being done, how many evaluations of how many are made."""


@dataclass(frozen=True, slots=True)
class Plan:
    """What is asked of a tuning."""

    evaluations: int = 3000
    seeds: tuple[int, ...] = (0,)
    method: str = "race"
    axes: tuple[Axis, ...] = HDR_TUNABLE.axes
    tunable: Tunable = HDR_TUNABLE


class Costs(Protocol):
    """What works out costs, here or on a cluster."""

    def cost(self, params: Floats, sessions: Sequence[int] | None = None) -> Scores:
        """Scores of candidates, shape (c, parameters), over some of the sessions."""
        ...


@dataclass(slots=True)
class TuningRun:
    """A tuning while it runs; an interrupt ends the search and leaves the best so far to be judged.

    costs, abouts, splits
        The sessions in one order: their costs, what is known of them, what each is used for.
    course
        Gives one of them to draw.
    """

    plan: Plan
    costs: Costs
    abouts: Sequence[About]
    splits: Sequence[Split]
    course: Callable[[int], Course]
    journal: Journal
    progress: Progress = lambda _what, _done, _all: None
    was_interrupted: bool = False
    _begun_s: float = field(default_factory=time.monotonic)

    def run(self) -> Tuning:
        """Search, and judge what was found.

        Raises
        ------
        DataError
            Where every parameter vector that was tried makes yaw leave the floats.
        """
        train, axes, tunable = self._used_for(Split.TRAIN), self.plan.axes, self.plan.tunable
        runs: list[Run] = []
        for seed in self.plan.seeds:
            runs += [self._search(f"seed {seed}", seed, axes, train, self.plan.evaluations)]
            if self.was_interrupted:
                break
        best = min(runs, key=lambda run: run.pi.train)
        if not np.isfinite(best.pi.train):
            raise DataError("every parameter vector that was tried gives an infinite cost; are the rates deg/s?")
        some = tuple(axis for axis in axes if axis.name in tunable.few)
        evaluations = min(FEW_EVALUATIONS, self.plan.evaluations)
        few = best if self.was_interrupted else self._search(tunable.few_title, best.seed, some, train, evaluations)
        left_out = {} if self._used_for(Split.TEST) or self.was_interrupted else self._leave_one_out(best.seed)
        return self._judge(best, tuple(run for run in runs if run is not best), few, left_out)

    def _used_for(self, split: Split) -> list[int]:
        return [at for at, one in enumerate(self.splits) if one is split]

    def _search(self, name: str, seed: int, axes: tuple[Axis, ...], sessions: Sequence[int], evaluations: int) -> Run:
        """One search over some sessions."""
        method = METHODS[self.plan.method]()
        tunable, searched = self.plan.tunable, method.axes(axes)

        def note(objective: Objective) -> None:
            self.journal.note(name, objective)
            self.progress(name, objective.count, objective.evaluations)

        def pi(params: Floats) -> Floats:
            return self.costs.cost(tunable.full(searched, params), sessions).pi

        objective = Objective(pi, searched, evaluations, self.journal.known(name), note)
        try:
            spend(method, objective, seed)
        except KeyboardInterrupt:
            if not objective.count:
                raise
            self.was_interrupted = True
        best = tunable.full(searched, params_of(searched, objective.cube[objective.best][np.newaxis]))
        densities = [automaton.density for automaton in method.automata()]
        return Run(
            seed=seed,
            history=objective.costs.copy(),
            cube=objective.cube.copy(),
            params=tunable.params(best[0]),
            pi=self._pi_of(best)[0],
            densities=np.array(densities) if densities else None,
        )

    def _pi_of(self, params: Floats) -> list[Pi]:
        """PI of candidates on both splits."""
        train, test = self._used_for(Split.TRAIN), self._used_for(Split.TEST)
        on_train = self.costs.cost(params, train).pi.tolist()
        on_test = self.costs.cost(params, test).pi.tolist() if test else [None] * len(params)
        return [Pi(*both) for both in zip(on_train, on_test, strict=True)]

    def _leave_one_out(self, seed: int) -> dict[str, LeftOut]:
        """Each session under parameters that were tuned on all others."""
        found: dict[str, LeftOut] = {}
        everyone = list(range(len(self.abouts)))
        for at, about in enumerate(self.abouts):
            others = [other for other in everyone if other != at]
            run = self._search(f"without {about.name}", seed, self.plan.axes, others, self.plan.evaluations)
            scores = self.costs.cost(_row(run.params), [at])
            found[about.name] = LeftOut(float(scores.mean_absolutes[0, 0]), float(scores.mean_squares[0, 0]))
            if self.was_interrupted:
                return {}
        return found

    def _judge(self, best: Run, others: tuple[Run, ...], few: Run, left_out: dict[str, LeftOut]) -> Tuning:
        nothing = np.array([self.plan.tunable.nothing])
        rows = np.vstack([nothing, _row(best.params), _row(few.params)])
        scores = self._scores(self.costs.cost(rows))
        euler_pi = self._pi_of(nothing)[0]
        if left_out:
            left_out_pi = float(np.mean([one.mean_square for one in left_out.values()]))
            best = replace(best, pi=replace(best.pi, test=left_out_pi))
            euler_pi = replace(euler_pi, test=euler_pi.train)
        axes = METHODS[self.plan.method]().axes(self.plan.axes)
        caveats = tuple(self._caveats(axes, best, euler_pi))
        return Tuning(
            tunable=self.plan.tunable,
            method=self.plan.method,
            evaluations=self.plan.evaluations,
            axes=axes,
            run=best,
            euler=euler_pi,
            few=few.pi,
            few_params=few.params,
            scores=scores,
            sample_rate_hz=float(np.median([about.sample_rate_hz for about in self.abouts])),
            seconds=time.monotonic() - self._begun_s,
            others=others,
            curves=self._curves(scores, best.params),
            left_out={name: one.e_deg for name, one in left_out.items()},
            warnings=caveats,
        )

    def _scores(self, scores: Scores) -> tuple[SessionScore, ...]:
        return tuple(
            SessionScore(about.name, split, about.minutes, euler_deg, tuned_deg, few_deg, about.digest)
            for about, split, (euler_deg, tuned_deg, few_deg) in zip(
                self.abouts, self.splits, scores.mean_absolutes.tolist(), strict=True
            )
        )

    def _caveats(self, axes: Sequence[Axis], best: Run, euler: Pi) -> Iterator[str]:
        """What to know before believing it, in sentences."""
        train = self._used_for(Split.TRAIN)
        yield from (odd for about in self.abouts for odd in about.odd)
        if self.plan.tunable.filter.counts_samples:
            yield from check_rates(self.abouts)
        if self.was_interrupted:
            yield "it was interrupted: these are the best parameters so far; go on with --resume"
        yield from bound_caveats(self.plan.tunable, axes, best.params)
        yield from flat_caveats(
            self.plan.tunable, self.plan.axes, best.params, lambda params: self.costs.cost(params, train).pi
        )
        yield from worse_caveats(best.pi, euler)

    def _curves(self, scores: Sequence[SessionScore], params: Params) -> tuple[Curve, ...]:
        """Yaw errors over time of the sessions that are drawn, the worst of each split."""
        chosen: list[int] = []
        for split in Split:
            worst = sorted(self._used_for(split), key=lambda at: -scores[at].e_tuned_deg)
            chosen += sorted(worst[:CURVES])
        return tuple(_curve(self.plan.tunable, self.course(at), self.splits[at], params) for at in chosen)


def _row(params: Params) -> Floats:
    return np.array([astuple(params)])


def _curve(tunable: Tunable, course: Course, split: Split, params: Params) -> Curve:
    at = course.drawn_at(CURVE_POINTS)
    reference_deg = course.reference_deg[at]
    return Curve(
        name=course.name,
        split=split,
        minutes=np.cumsum(course.dt_s)[at] / 60.0,
        euler_deg=euler(course.dt_s, course.rate_dps)[at] - reference_deg,
        tuned_deg=tunable.kernel.yaw(course.dt_s, course.rate_dps, _row(params)[0])[at] - reference_deg,
    )
