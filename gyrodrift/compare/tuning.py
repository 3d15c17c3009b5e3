"""Every method tuned on the same sessions, by the same search with the same budget."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.compare.methods.method import Method, Params
from gyrodrift.compare.methods.registry import BY_KEY
from gyrodrift.evaluation.score import score_of
from gyrodrift.evaluation.space import params_of
from gyrodrift.evaluation.timed_reference import TimedReference
from gyrodrift.parallel import LocalWorkers, workers
from gyrodrift.tune.search.methods import METHODS as SEARCHES
from gyrodrift.tune.search.methods import spend
from gyrodrift.tune.search.objective import Objective

SEARCH = "race"
"""What `tune` uses where nothing is said."""

Progress = Callable[[str, int, int], None]

_known: list[TimedReference] = []
"""The training sessions, where the processes that are forked find them."""


def tuned(
    chosen: Sequence[Method], train: Sequence[TimedReference], iterations: int, seed: int, jobs: int, progress: Progress
) -> dict[str, Params]:
    """Parameters by method, of those that have axes: the best of `iterations` evaluations, or the defaults.

    A search may end above the defaults, with many parameters and few evaluations; then they are kept, so that no
    method is worse off on the training sessions for having been tuned.
    """
    with _told(train), workers(jobs) as hands:
        return {method.key: _tuned(method, hands, iterations, seed, progress) for method in chosen if method.axes}


@contextmanager
def _told(train: Sequence[TimedReference]) -> Iterator[None]:
    _known[:] = train
    try:
        yield
    finally:
        _known.clear()


def _tuned(method: Method, hands: LocalWorkers, iterations: int, seed: int, progress: Progress) -> Params:
    names = [axis.name for axis in method.axes]

    def pi(params: Floats) -> Floats:
        rows = [(method.key, dict(zip(names, row, strict=True))) for row in params.tolist()]
        return np.array(list(hands.map(_pi, rows)))

    def note(objective: Objective) -> None:
        progress(f"tuning {method.title}", objective.count, objective.evaluations)

    objective = Objective(pi, method.axes, iterations, on_batch=note)
    spend(SEARCHES[SEARCH](), objective, seed)
    default = float(pi(np.array([[method.defaults[name] for name in names]]))[0])
    if not objective.costs.min() < default:
        return method.defaults
    best = params_of(method.axes, objective.cube[objective.best][np.newaxis])[0]
    return dict(zip(names, best.tolist(), strict=True))


def _pi(row: tuple[str, Mapping[str, float]]) -> float:
    """Equation 9 of the README over the training sessions, deg²."""
    key, params = row
    run = BY_KEY[key].run
    return float(np.mean([score_of(one.course, run(one.t_s, one.course.rate_dps, params)).pi_deg2 for one in _known]))
