"""Tune every method on the same sessions, with the same search and budget."""

from collections.abc import Mapping, Sequence

import numpy as np

from gyrodrift.compare.methods.method import Method, Params
from gyrodrift.compare.methods.registry import by_key
from gyrodrift.evaluation.dataset import LoadedSession
from gyrodrift.evaluation.score import score_of
from gyrodrift.evaluation.space import values_of
from gyrodrift.io.parallel import Workers, workers
from gyrodrift.io.progress import OnProgress
from gyrodrift.tune.search.methods import METHODS as SEARCHES
from gyrodrift.tune.search.methods import run_to_budget
from gyrodrift.tune.search.objective import Objective
from gyrodrift.values.arrays import Floats

SEARCH = "race"
"""Search method: the default of `tune`."""

Pool = Workers[Sequence[LoadedSession]]
"""Processes that inherit the training sessions."""


def tuned(
    chosen: Sequence[Method],
    train: Sequence[LoadedSession],
    iterations: int,
    seed: int,
    jobs: int,
    progress: OnProgress,
) -> dict[str, Params]:
    """Parameters by method, for methods with axes: the best of `iterations` evaluations, or the defaults.

    A search with many parameters and few evaluations may find nothing better than the defaults. It then returns the
    defaults, so tuning makes no method worse on the training sessions.
    """
    with workers(jobs, train) as pool:
        return {method.key: _tuned(method, pool, iterations, seed, progress) for method in chosen if method.axes}


def _tuned(method: Method, pool: Pool, iterations: int, seed: int, progress: OnProgress) -> Params:
    names = [axis.name for axis in method.axes]

    def pi(params: Floats) -> Floats:
        rows = [(method.key, dict(zip(names, row, strict=True))) for row in params.tolist()]
        return np.array(list(pool.map(_pi, rows)))

    def note(objective: Objective) -> None:
        progress(f"tuning {method.title}", objective.count, objective.evaluations)

    objective = Objective(pi, method.axes, iterations, on_batch=note)
    note(objective)
    run_to_budget(SEARCHES[SEARCH](), objective, seed)
    default = float(pi(np.array([[method.defaults[name] for name in names]]))[0])
    if not objective.costs.min() < default:
        return method.defaults
    best_values = values_of(method.axes, objective.cube[objective.best][np.newaxis])[0]
    best = dict(zip(names, best_values.tolist(), strict=True))
    return best if _is_better_on_all_axes(method, best, pool) else method.defaults


def _is_better_on_all_axes(method: Method, best: Params, pool: Pool) -> bool:
    """Whether parameters found on the rate of the heading are better where the method takes three axes, too."""
    if method.with_axes is None or all(session.reference.axes is None for session in pool.inherited):
        return True
    found_pi, default_pi = pool.map(_pi_on_all_axes, [(method.key, best), (method.key, method.defaults)])
    return found_pi < default_pi


def _pi(training: Sequence[LoadedSession], row: tuple[str, Mapping[str, float]]) -> float:
    """PI on the rate of the heading over the training sessions, deg²."""
    key, params = row
    method = by_key()[key]
    return _mean_pi(training, [method.on(None, session.reference.auxiliary) for session in training], params)


def _pi_on_all_axes(training: Sequence[LoadedSession], row: tuple[str, Mapping[str, float]]) -> float:
    """PI over the training sessions as they are scored, deg²."""
    key, params = row
    method = by_key()[key]
    return _mean_pi(training, [method.on(s.reference.axes, s.reference.auxiliary) for s in training], params)


def _mean_pi(training: Sequence[LoadedSession], methods: Sequence[Method], params: Params) -> float:
    pairs = zip(methods, training, strict=True)
    scores = [score_of(s.reference, method.run(s.t_s, s.reference.rate_dps, params)) for method, s in pairs]
    return float(np.mean([score.pi_deg2 for score in scores]))
