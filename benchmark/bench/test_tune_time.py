"""A whole search of the twin set beside scipy's differential evolution on the same kernel, with as many evaluations."""

import time
from collections.abc import Callable
from pathlib import Path
from statistics import median

import numpy as np
import pytest
from recordings_support import DATA
from scipy.optimize import differential_evolution

from bench.harness import show
from firmware_sim.rig import load_rig
from gyrodrift.evaluation.cost import Cost
from gyrodrift.evaluation.dataset import Source, load_with_reference
from gyrodrift.evaluation.space import axes_of, values_of
from gyrodrift.filters.hdr_filter import HDR
from gyrodrift.simulation.published_set import read_rows, write_twins
from gyrodrift.tune.search.methods import METHODS, run_to_budget
from gyrodrift.tune.search.objective import Objective
from gyrodrift.values.arrays import Floats

AXES = axes_of(HDR)

pytestmark = pytest.mark.timeout(3600)

EVALUATIONS = 3000
POPULATION = 15 * len(AXES)
"""scipy's own."""
ROUNDS = 3


def race(cost: Cost, seed: int) -> None:
    """The default of tune."""
    run_to_budget(METHODS["race"](), Objective(cost.pi, AXES, EVALUATIONS), seed)


def evolution(cost: Cost, seed: int, *, is_vectorized: bool) -> None:
    """As its manual calls it, one candidate at a time, or a generation at a time."""

    def squares(cube: Floats) -> Floats:
        found: Floats = cost.pi(values_of(AXES, np.atleast_2d(cube.T)))
        return found if is_vectorized else found[0]

    generations = EVALUATIONS // POPULATION - 1
    options = {"vectorized": True, "updating": "deferred"} if is_vectorized else {}
    differential_evolution(
        squares, [(0.0, 1.0)] * len(AXES), maxiter=generations, rng=seed, polish=False, tol=0.0, **options
    )


def seconds(work: Callable[[], None]) -> float:
    begun_s = time.perf_counter()
    work()
    return time.perf_counter() - begun_s


def test_a_whole_search_beside_differential_evolution(tmp_path: Path) -> None:
    """All sixteen sessions, one after the other in each round; medians and ratios to the default."""
    twins = write_twins(read_rows(DATA / "published_tables.csv"), load_rig(None), tmp_path, seed=1)
    with Cost(load_with_reference(Source(twin.path)).reference for twin in twins) as cost:
        cost.pi(values_of(AXES, np.full((16, len(AXES)), 0.5)))  # compiled once, for all
        works = {
            "race": lambda seed: race(cost, seed),
            "scipy, a generation at a time": lambda seed: evolution(cost, seed, is_vectorized=True),
            "scipy, as its manual calls it": lambda seed: evolution(cost, seed, is_vectorized=False),
        }
        found: dict[str, list[float]] = {name: [] for name in works}
        for seed in range(ROUNDS):
            for name, work in works.items():
                found[name].append(seconds(lambda work=work, seed=seed: work(seed)))  # type: ignore[misc]  # bound now
    ratios = {name: median(np.divide(times, found["race"])) for name, times in found.items()}
    rows = [(name, f"{median(times):.1f} s, {ratios[name]:.2f} of race") for name, times in found.items()]
    show(f"{EVALUATIONS} evaluations of {len(AXES)} parameters over 16 sessions, {ROUNDS} rounds", rows)
