"""The search methods, each as one class that asks an `Objective` until its evaluations are made."""

import warnings
from typing import Protocol

import numpy as np

from gyrodrift.evaluation.space import Axis, linear
from gyrodrift.tune.search.carla import Automaton, Carla
from gyrodrift.tune.search.objective import BudgetSpentError, Objective
from gyrodrift.tune.search.race import BATCH, LARGEST, Team, cma_package, race
from gyrodrift.values.arrays import Floats


class SearchMethod(Protocol):
    """A search method."""

    def axes(self, axes: tuple[Axis, ...]) -> tuple[Axis, ...]:
        """Axes to search, given the axes of the plan."""
        ...

    def search(self, objective: Objective, rng: np.random.Generator) -> None:
        """Search until the budget is spent or the method ends; then it is started again.

        Raises
        ------
        BudgetSpentError
            At the end.
        """
        ...

    def automata(self) -> list[Automaton]:
        """Automata at the end of the search; empty for a method without automata."""
        ...


class _AsMeant:
    """A method with the axes of the plan and without automata."""

    def axes(self, axes: tuple[Axis, ...]) -> tuple[Axis, ...]:
        """Axes to search."""
        return axes

    def automata(self) -> list[Automaton]:
        """Automata at the end of the search."""
        return []


class Race(_AsMeant):
    """Default method: automata in batches, then local searches that compete."""

    def __init__(self) -> None:
        self._team: Team | None = None

    def search(self, objective: Objective, rng: np.random.Generator) -> None:
        """Search until the budget is spent."""
        self._team = Team(objective.dimensions, rng)
        race(objective, rng, self._team)

    def automata(self) -> list[Automaton]:
        """Automata at the end of the search."""
        return self._team.automata if self._team else []


class PublishedCarla:
    """CARLA as published: linear axes, one point at a time, fixed width."""

    def __init__(self) -> None:
        self._carla: Carla | None = None

    def axes(self, axes: tuple[Axis, ...]) -> tuple[Axis, ...]:
        """Axes to search."""
        return linear(axes)

    def search(self, objective: Objective, rng: np.random.Generator) -> None:
        """Search until the budget is spent."""
        self._carla = carla = Carla(objective.dimensions, rng)
        while True:
            point = carla.ask()
            carla.tell(point, objective(point))

    def automata(self) -> list[Automaton]:
        """Automata at the end of the search."""
        return self._carla.automata if self._carla else []


class RandomSearch(_AsMeant):
    """Random points."""

    def search(self, objective: Objective, rng: np.random.Generator) -> None:
        """Search until the budget is spent."""
        while True:
            objective(rng.random((BATCH, objective.dimensions)))


class CmaEs(_AsMeant):
    """CMA-ES by the `cma` package, from the center of the cube, and its restarts with growing populations (IPOP)."""

    SIGMA = 0.3

    def search(self, objective: Objective, rng: np.random.Generator) -> None:
        """Search until the budget is spent."""
        cma = cma_package()
        size = 4 + int(3 * np.log(objective.dimensions))
        start: Floats = np.full(objective.dimensions, 0.5)
        while True:
            options = {"bounds": [0.0, 1.0], "popsize": size, "seed": int(rng.integers(1, 2**31)), "verbose": -9}
            strategy = cma.CMAEvolutionStrategy(start, self.SIGMA, options)
            while not strategy.stop():
                points = strategy.ask()
                strategy.tell(points, np.minimum(objective(np.array(points)), LARGEST).tolist())
            size *= 2
            start = rng.random(objective.dimensions)


class DifferentialEvolution(_AsMeant):
    """scipy's differential evolution with its default settings, a generation at a time."""

    def search(self, objective: Objective, rng: np.random.Generator) -> None:
        """Search until the budget is spent."""
        from scipy.optimize import differential_evolution  # noqa: PLC0415 - half a second, for who asks for it

        def costs(points: Floats) -> Floats:
            return np.minimum(objective(points.T), LARGEST)

        bounds = [(0.0, 1.0)] * objective.dimensions
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # scipy warns that a vectorized search updates by generation
            differential_evolution(costs, bounds, maxiter=10**6, rng=rng, vectorized=True, polish=False)


METHODS: dict[str, type[SearchMethod]] = {
    "race": Race,
    "carla": PublishedCarla,
    "cma": CmaEs,
    "de": DifferentialEvolution,
    "random": RandomSearch,
}


def run_to_budget(method: SearchMethod, objective: Objective, seed: int) -> None:
    """Search until all evaluations are used; a method that ends earlier is started again."""
    rng = np.random.default_rng(seed)
    try:
        while objective.remaining:
            method.search(objective, rng)
    except BudgetSpentError:
        return
