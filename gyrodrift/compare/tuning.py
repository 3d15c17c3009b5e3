"""Tune every method on the same sessions, with the same search and budget; read what `tune` says of a config."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from gyrodrift.compare.methods.method import Method, Params
from gyrodrift.compare.methods.registry import by_key
from gyrodrift.evaluation.dataset import LoadedSession, Split
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


@dataclass(frozen=True, slots=True)
class TunedSession:
    """A training or test session of a tuning, with the SHA-256 of its content."""

    name: str
    split: Split
    sha256: str


@dataclass(frozen=True, slots=True)
class TuningProvenance:
    """Provenance of the parameters of a config.

    filter
        Name of the tuned filter.
    command, seed, iterations
        As they were given; empty and None if the file does not say.
    is_default
        The parameters are the filter's defaults, which no tuned parameters beat on held-out sessions.
    """

    filter: str
    sessions: tuple[TunedSession, ...]
    command: str = ""
    seed: int | None = None
    iterations: int | None = None
    is_default: bool = False

    @property
    def training(self) -> tuple[TunedSession, ...]:
        """Sessions that the parameters depend on: the training sessions, or none for defaults."""
        if self.is_default:
            return ()
        return tuple(session for session in self.sessions if session.split is Split.TRAIN)


def read_provenance(path: Path) -> TuningProvenance | None:
    """Provenance of a checked config file; None without a tuning."""
    content = yaml.safe_load(path.read_text(encoding="utf-8"))
    block = content.get("provenance") if isinstance(content, dict) else None
    if not isinstance(block, dict):
        return None
    sessions = tuple(filter(None, map(_session, _list(block.get("sessions")))))
    named = block.get("filter", content.get("filter"))
    if not sessions or not isinstance(named, str):
        return None
    seed, iterations = block.get("seed"), block.get("iterations")
    return TuningProvenance(
        filter=named,
        sessions=sessions,
        command=str(block.get("command", "")),
        seed=seed if isinstance(seed, int) else None,
        iterations=iterations if isinstance(iterations, int) else None,
        is_default=block.get("parameters") == "defaults",
    )


def _list(value: Any) -> list[Any]:
    return value if isinstance(value, list) else []


def _session(entry: Any) -> TunedSession | None:
    """A session entry; None if it has another form."""
    if not isinstance(entry, Mapping) or entry.get("split") not in {split.value for split in Split}:
        return None
    return TunedSession(str(entry.get("name", "")), Split(entry["split"]), str(entry.get("sha256", "")))


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
