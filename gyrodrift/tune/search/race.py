"""The default search: automata explore the cube in batches, then several local searches compete.

From CARLA: one automaton for each parameter, rewards between the median cost and the least, a density with memory.
Additions, each better by measurement (`benchmark/bench/test_search.py`):

- logarithmic axes and costs
- batches of points, which are evaluated in parallel
- a reward width that shrinks during the search
- local searches by CMA-ES (package `cma`), which follow ridges across parameters
- several competing local searches, so that no single valley decides
- restarts while the budget lasts
"""

import sys
from typing import Any

import numpy as np

from gyrodrift.tune.search.carla import Automaton
from gyrodrift.tune.search.objective import Objective
from gyrodrift.values.arrays import Floats
from gyrodrift.values.errors import UsageError

LOOK_POINTS = 64
"""Points of the exploration, evaluated in batches."""

BATCH = 32

WIDTH_FIRST, WIDTH_LAST, WIDTH_SHRINKS = 0.15, 0.03, 0.85
HEIGHT = 1.0
FLOOR = 0.1
"""First and last width of a reward, its factor per batch, its height, and the share of uniform choices: measured."""

RACERS, RACERS_LATER = 4, 3
APART = 0.25
"""Least distance between the starts of racers, in shares of a range."""

HEATS = (10, 15)
"""Generations after which the worse half of the racers is dropped."""

SIGMA, SIGMA_POLISH = 0.2, 0.08
POPULATION = 8
"""Points of a generation: one group of the kernel."""

PATIENCE, PATIENCE_POLISH = 30, 17
GAIN = 1e-4
"""A local search ends if PATIENCE generations gain less than this share of the cost."""

HOPELESS = 2.0
"""Largest ratio of the winner's cost to the best cost so far; above it the winner stops."""

LARGEST = 1e300
"""Replacement for an infinite cost in methods that compute with costs."""


class Team:
    """Automata that choose points in batches, with rewards by the logarithm of the cost."""

    def __init__(self, dimensions: int, rng: np.random.Generator) -> None:
        self.automata = [Automaton() for _ in range(dimensions)]
        self._rng = rng
        self._width = WIDTH_FIRST
        self._logs: list[float] = []

    def ask(self) -> Floats:
        """Choose a batch of points, shape (BATCH, dimensions)."""
        draws = self._rng.random((BATCH, len(self.automata)))
        is_free = self._rng.random(draws.shape) < FLOOR
        columns = [automaton.select(z) for automaton, z in zip(self.automata, draws.T, strict=True)]
        return np.where(is_free, draws, np.column_stack(columns))

    def tell(self, points: Floats, costs: Floats) -> None:
        """Learn from the costs of the points."""
        logs = np.log(np.clip(costs, 1e-300, LARGEST))
        self._logs += logs[np.isfinite(costs)].tolist()
        if self._logs:
            median, least = float(np.median(self._logs)), min(self._logs)
            betas = np.clip((median - logs) / (median - least), 0.0, 1.0) if median > least else np.zeros(len(logs))
            for automaton, actions in zip(self.automata, points.T, strict=True):
                automaton.reinforce(actions, betas, self._width, HEIGHT)
        self._width = max(WIDTH_LAST, self._width * WIDTH_SHRINKS)


def cma_package() -> Any:
    """The package cma.

    Raises
    ------
    UsageError
        Python runs with -OO, which removes the docstrings that cma builds on.
    """
    if sys.flags.optimize > 1:
        raise UsageError("the search needs the package cma, which does not run under python -OO: use -O, or neither")
    import cma

    return cma


class Racer:
    """A local search from a point, with a stopping rule."""

    def __init__(self, start: Floats, sigma: float, patience: int, rng: np.random.Generator) -> None:
        cma = cma_package()
        options = {"bounds": [0.0, 1.0], "popsize": POPULATION, "seed": int(rng.integers(1, 2**31)), "verbose": -9}
        options |= {"tolfun": 0.0, "tolfunhist": 0.0, "tolx": 1e-5}  # this class decides when to stop
        self._strategy = cma.CMAEvolutionStrategy(start, sigma, options)
        self._patience = patience
        self._history: list[float] = []

    @property
    def best(self) -> float:
        """Least cost so far."""
        return min(self._history)

    @property
    def is_done(self) -> bool:
        """Whether it no longer improves."""
        recent, before = self._history[-self._patience :], self._history[: -self._patience]
        is_stuck = len(before) > self._patience and min(recent) > min(before) * (1.0 - GAIN)
        return is_stuck or bool(self._strategy.stop())

    def ask(self) -> Floats:
        """Choose the points of a generation, shape (POPULATION, dimensions)."""
        return np.array(self._strategy.ask())

    def tell(self, points: Floats, costs: Floats) -> None:
        """Learn from the costs of the points."""
        self._strategy.tell(list(points), np.minimum(costs, LARGEST).tolist())
        self._history.append(float(costs.min()))

    def run(self, objective: Objective) -> None:
        """Run one generation."""
        points = self.ask()
        self.tell(points, objective(points))


def race(objective: Objective, rng: np.random.Generator, team: Team) -> None:
    """Search until the budget is spent; `team` keeps its automata.

    Raises
    ------
    BudgetSpentError
        When the budget is spent.
    """
    racers = RACERS
    while True:
        begun = objective.count
        for _ in range(LOOK_POINTS // BATCH):
            points = team.ask()
            team.tell(points, objective(points))
        starts = _apart(objective.cube[begun:], objective.costs[begun:], racers)
        winner = _heats(objective, [Racer(start, SIGMA, PATIENCE, rng) for start in starts])
        while not winner.is_done and winner.best < HOPELESS * objective.costs.min():
            winner.run(objective)
        polish = Racer(objective.cube[objective.best].copy(), SIGMA_POLISH, PATIENCE_POLISH, rng)
        while not polish.is_done:
            polish.run(objective)
        racers = RACERS_LATER


def _apart(cube: Floats, costs: Floats, count: int) -> list[Floats]:
    """Best points that are not close to a better point."""
    chosen: list[Floats] = []
    for point in cube[np.argsort(costs, kind="stable")]:
        if all(np.abs(point - start).max() > APART for start in chosen):
            chosen.append(point.copy())
        if len(chosen) == count:
            break
    return chosen


def _heats(objective: Objective, racers: list[Racer]) -> Racer:
    """Run the racers side by side, and drop the worse half after each heat."""
    for generations in HEATS:
        for _ in range(generations):
            running = [racer for racer in racers if not racer.is_done]
            if not running:
                break
            generations_points = [racer.ask() for racer in running]
            costs = objective(np.vstack(generations_points))
            for number, (racer, points) in enumerate(zip(running, generations_points, strict=True)):
                racer.tell(points, costs[number * POPULATION : (number + 1) * POPULATION])
        racers = sorted(racers, key=lambda racer: racer.best)[: max(1, len(racers) // 2)]
    return racers[0]
