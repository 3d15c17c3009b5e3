"""Tune one filter or several, and choose the filter and the parameters that are best on held-out sessions."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from math import sqrt

import numpy as np

from gyrodrift.evaluation.attitude import filter_history
from gyrodrift.evaluation.dataset import LoadedSession, Split
from gyrodrift.evaluation.score import Score, score_of
from gyrodrift.evaluation.space import row_of
from gyrodrift.filters.filter import Filter, FilterParams
from gyrodrift.filters.registry import SHIPPED
from gyrodrift.filters.restlevel_filter import RESTLEVEL
from gyrodrift.io.progress import COMPILING, TOTAL, OnProgress, ignore_progress
from gyrodrift.tune.result import Alternative, Pi, Tuning
from gyrodrift.tune.search.journal import Journal
from gyrodrift.tune.tuning import REDUCED_EVALUATIONS, Plan, TuningRun
from gyrodrift.tune.tuning_set import TuningSet
from gyrodrift.values.errors import DataError

WORSE_CRPS = 1.1
"""Ratio of the CRPS of tuned parameters to that of the defaults from which they are refused: chosen, above the scatter
between sessions."""

CHECKED = 3
"""Sessions that are compared: 3 of 30 min at 100 Hz take some minutes. Chosen."""


def worse_on_three_axes(params: FilterParams, sessions: Sequence[LoadedSession]) -> str:
    """Warning if restlevel is worse with these parameters than with its defaults, on three axes or with second sources.

    The search uses the rate of the heading alone. Empty if the parameters are better, or if no session has more.
    """
    with_more = [session for session in sessions if session.reference.axes is not None or session.reference.aids]
    if not with_more:
        return ""
    tuned_deg, default_deg = (_rms_deg(candidate, with_more) for candidate in (params, RESTLEVEL.params()))
    if tuned_deg < default_deg:
        return ""
    has_axes = any(session.reference.axes is not None for session in with_more)
    case = "on three axes" if has_axes else "with the second sources"
    return (
        f"the parameters found on the rate of the heading are worse {case}: {tuned_deg:.3g} against "
        f"{default_deg:.3g} deg RMS; the config has the defaults"
    )


def _rms_deg(params: FilterParams, sessions: Sequence[LoadedSession]) -> float:
    """Root of the mean PI over the sessions, deg."""
    return sqrt(float(np.mean([_pi_deg2(params, session) for session in sessions])))


def _pi_deg2(params: FilterParams, session: LoadedSession) -> float:
    reference = session.reference
    columns = (session.t_s, reference.rate_dps, reference.axes, reference.auxiliary)
    history = filter_history(*columns, params, reference.aids)
    return float(score_of(reference, history.yaw_deg).pi_deg2)


WEIGHTS = {"hdr": 1, "restlevel": 3}
"""Duration of an evaluation relative to HDR by CARLA: measured, `gyrodrift tune` on 6 sessions of 10 minutes."""


class TotalProgress:
    """Passes on the progress of each search, and adds the total of all searches.

    Parameters
    ----------
    sessions
        Number of sessions if each is held out in turn, else 0.
    """

    def __init__(self, plans: tuple[Plan, ...], sessions: int, progress: OnProgress) -> None:
        self._progress = progress
        self._total = sum(_weight(plan) * _evaluations(plan, sessions) for plan in plans)
        self._done: dict[tuple[str, str], int] = {}

    def of_plan(self, plan: Plan) -> OnProgress:
        """Progress for the searches of a plan."""

        def report(search: str, done: int, total: int) -> None:
            self._progress(search, done, total)
            self._done[plan.filter.name, search] = _weight(plan) * done
            self._progress(TOTAL, min(sum(self._done.values()), self._total), self._total)

        return report


def _weight(plan: Plan) -> int:
    return WEIGHTS.get(plan.filter.name, max(WEIGHTS.values()))


def _evaluations(plan: Plan, sessions: int) -> int:
    """Evaluations of all searches: of each seed, of the reduced model, and without each session."""
    model = plan.filter.reduced_model
    is_reduced = {axis.name for axis in plan.axes} != set(model.names)
    reduced = min(REDUCED_EVALUATIONS, plan.evaluations) if is_reduced else 0
    return (len(plan.seeds) + sessions) * plan.evaluations + reduced


def tune_filters(
    plans: Sequence[Plan], sessions: TuningSet, journal: Journal, progress: OnProgress = ignore_progress
) -> tuple[Tuning, bool]:
    """Result of the best filter, and whether the tuning was interrupted.

    After an interrupt the best of the filters tuned so far is returned.

    Raises
    ------
    DataError
        If every parameter vector of every filter has an infinite cost.
    """
    is_cross_validated = Split.TEST not in sessions.splits
    total = TotalProgress(tuple(plans), len(sessions.sessions) * is_cross_validated, progress)
    tunings: list[Tuning] = []
    errors: list[DataError] = []
    is_alone = len(plans) == 1
    for plan in plans:
        try:
            _compile(plan, sessions, progress)
            run = _run_of(plan, sessions, journal, total.of_plan(plan), is_alone=is_alone)
            tunings.append(run.run())
        except DataError as error:  # another filter may have a finite cost
            errors.append(error)
            continue
        except KeyboardInterrupt:
            if not tunings:
                raise
            return chosen(tunings, sessions, is_alone=is_alone), True
        if run.was_interrupted:
            return chosen(tunings, sessions, is_alone=is_alone), True
    if not tunings:
        raise errors[0]
    return chosen(tunings, sessions, is_alone=is_alone), False


def _compile(plan: Plan, sessions: TuningSet, progress: OnProgress) -> None:
    """Compile the filter, by its first evaluation."""
    progress(COMPILING, 0, 0)
    sessions.costs.for_filter(plan.filter).cost(row_of(plan.filter.params()), [0])


def _run_of(plan: Plan, sessions: TuningSet, journal: Journal, progress: OnProgress, *, is_alone: bool) -> TuningRun:
    costs, prefix = sessions.costs.for_filter(plan.filter), "" if is_alone else f"{plan.filter.name}, "
    return TuningRun(plan, costs, sessions.sessions, sessions.splits, sessions.loaded, journal, progress, prefix=prefix)


def chosen(tunings: Sequence[Tuning], sessions: TuningSet, *, is_alone: bool) -> Tuning:
    """The best tuning with all alternatives.

    A filter that was named is written tuned, whatever its defaults reach, unless its sigma of yaw is worse than none.
    On three axes restlevel is written tuned only if the attitude filter is better with the parameters, too.
    """
    by_name = {tuning.filter.name: tuning for tuning in tunings}
    untuned = list(_untuned(tunings, sessions))
    every = tuple(way for default in untuned for way in (default, *_tuned_of(default, by_name)))
    refused = refused_sets(every)
    candidates = [
        way for way in every if way.key in by_name and (not is_alone if not way.is_tuned else way.key not in refused)
    ]
    candidates = candidates or [way for way in every if way.key in by_name and not way.is_tuned]
    best = min(candidates, key=_rank)
    result = by_name[best.key]
    kept = result.warnings if best.is_tuned else filter(partial(_is_of_sessions, result), result.warnings)
    warnings = (*kept, *refused.values(), *(() if is_alone and refused else default_warnings(best, every)))
    worse = _worse_on_three_axes(best, sessions)
    is_default_written = not best.is_tuned or bool(worse)
    warnings = (*warnings, worse) if worse else warnings
    return replace(result, alternatives=every, is_default_written=is_default_written, warnings=warnings)


def refused_sets(ways: Sequence[Alternative]) -> dict[str, str]:
    """Warnings by filter about tuned parameters whose sigma of yaw is worse than none and than that of the defaults."""
    defaults = {way.key: way for way in ways if not way.is_tuned}
    return {
        way.key: f"the tuned parameters of {way.key} are refused: the stated sigma of yaw does not fit the errors, "
        f"CRPS {way.judged_crps_deg:.3g} deg at an error of {way.e_deg.judged:.3g} deg; defaults: "
        f"CRPS {defaults[way.key].judged_crps_deg:.3g} deg, error {defaults[way.key].e_deg.judged:.3g} deg"
        for way in ways
        if way.is_tuned and way.judged_crps_deg > max(way.e_deg.judged, WORSE_CRPS * defaults[way.key].judged_crps_deg)
    }


def _worse_on_three_axes(best: Alternative, sessions: TuningSet) -> str:
    """Warning if tuned parameters of restlevel are worse than its defaults on three axes; else empty."""
    if not best.is_tuned or best.params is None or best.filter is not RESTLEVEL:
        return ""
    indices = range(min(CHECKED, len(sessions.sessions)))
    return worse_on_three_axes(best.params, [sessions.loaded(index) for index in indices])


def _is_of_sessions(tuning: Tuning, warning: str) -> bool:
    """Whether a warning is not about a tuned parameter, with whose name it would begin."""
    return warning.partition(" ")[0] not in tuning.filter.names


def _tuned_of(default: Alternative, tunings: Mapping[str, Tuning]) -> Iterator[Alternative]:
    if default.key in tunings:
        yield tuned_alternative(tunings[default.key])


def _rank(alternative: Alternative) -> tuple[float, bool]:
    """Least PI first; of equal ones the tuned one."""
    return (alternative.judged_pi, not alternative.is_tuned)


def default_warnings(written: Alternative, alternatives: Sequence[Alternative]) -> Iterator[str]:
    """A warning if the config has defaults, and one for each alternative without tuning that is better.

    Plain integration is left out: `held_out_warnings` has it.
    """
    if not written.is_tuned:
        yield (
            f"no tuned filter is better on held-out sessions than {written.title}: "
            "the config has these defaults; record more sessions to tune on"
        )
    for better in alternatives:
        if not better.is_tuned and better.key != "euler" and better.judged_pi < written.judged_pi:
            advice = f"; use filter: {better.key} without parameters" if better.filter else ""
            yield (
                f"{better.title} is better than {written.title}: {sqrt(better.judged_pi):.3g} against "
                f"{sqrt(written.judged_pi):.3g} deg RMS{advice}"
            )


def tuned_alternative(tuning: Tuning) -> Alternative:
    """The tuned filter as an alternative."""
    scores, held_out = [score.tuned for score in tuning.scores], list(tuning.cross_validation.values())
    e_deg, crps_deg = _split_mean(tuning, [score.e_deg for score in scores]), _crps(tuning, scores)
    if held_out:
        e_deg = replace(e_deg, test=float(np.mean([score.e_deg for score in held_out])))
        crps_deg = crps_deg and replace(crps_deg, test=_mean_crps(held_out))
    title, name = tuning.filter.title or tuning.filter.name, tuning.filter.name
    return Alternative(
        name,
        f"{title}, tuned",
        tuning.run.pi,
        e_deg,
        tuning.filter,
        tuning.run.params,
        is_tuned=True,
        crps_deg=crps_deg,
    )


def _crps(tuning: Tuning, scores: Sequence[Score]) -> Pi | None:
    """Mean CRPS on both splits, deg; None without sigma."""
    values = [score.crps_deg for score in scores if score.crps_deg is not None]
    return _split_mean(tuning, values) if len(values) == len(scores) else None


def _mean_crps(scores: Sequence[Score]) -> float:
    return float(np.mean([score.crps_deg for score in scores if score.crps_deg is not None]))


def _untuned(tunings: Sequence[Tuning], sessions: TuningSet) -> Iterator[Alternative]:
    """Plain integration, start calibration, and the filters at their defaults."""
    first = tunings[0]
    plain, start = ([getattr(session, name) for session in sessions.sessions] for name in ("plain", "start"))
    yield _alternative(first, "euler", "plain integration", plain)
    yield _alternative(first, "start", "start calibration", start)
    for kind in dict.fromkeys([*SHIPPED, *(tuning.filter for tuning in tunings)]):
        yield _alternative(
            first, kind.name, f"{kind.title or kind.name}, defaults", _default_scores(kind, sessions), kind
        )


def _default_scores(kind: Filter, sessions: TuningSet) -> list[Score]:
    scores = sessions.costs.for_filter(kind).cost(row_of(kind.params()))
    return [scores.score(index, 0, session.minutes) for index, session in enumerate(sessions.sessions)]


def _alternative(
    tuning: Tuning, key: str, title: str, scores: Sequence[Score], kind: Filter | None = None
) -> Alternative:
    pi = _split_mean(tuning, [score.pi_deg2 for score in scores])
    e_deg = _split_mean(tuning, [score.e_deg for score in scores])
    params = None if kind is None else kind.params()
    return Alternative(key, title, pi, e_deg, kind, params, crps_deg=_crps(tuning, scores))


def _split_mean(tuning: Tuning, values: Sequence[float]) -> Pi:
    """Means over the training and over the test sessions; in a cross-validation both over all."""
    by_split = {
        split: [value for value, score in zip(values, tuning.scores, strict=True) if score.split is split]
        for split in Split
    }
    train = float(np.mean(by_split[Split.TRAIN]))
    if tuning.cross_validation:
        return Pi(train, train)
    return Pi(train, float(np.mean(by_split[Split.TEST])) if by_split[Split.TEST] else None)
