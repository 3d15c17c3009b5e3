"""The objective of a search: cost at points of the unit cube, counted, cached and within the budget."""

from collections.abc import Callable, Sequence

import numpy as np

from gyrodrift.evaluation.space import Axis, values_of
from gyrodrift.values.arrays import Floats


class BudgetSpentError(Exception):
    """All evaluations of the budget are used."""


class Objective:
    """Counts and stores the evaluations of a search.

    A run with the same seed evaluates the same points in the same order. Costs of an earlier run come from a cache, so
    any method can be resumed.

    Parameters
    ----------
    pi
        Function from values of the axes, shape (c, axes), to costs in deg², shape (c,).
    axes
        Axes of the unit cube.
    evaluations
        Budget.
    cached
        Points, shape (k, axes), and costs, shape (k,), of an earlier run.
    on_batch
        Called after each batch.
    """

    def __init__(
        self,
        pi: Callable[[Floats], Floats],
        axes: Sequence[Axis],
        evaluations: int,
        cached: tuple[Floats, Floats] | None = None,
        on_batch: Callable[["Objective"], None] = lambda _objective: None,
    ) -> None:
        self.axes = axes
        self.evaluations = evaluations
        self.count = 0
        self._pi = pi
        self._known = cached or (np.empty((0, len(axes))), np.empty(0))
        self._on_batch = on_batch
        self._cube = np.empty((evaluations, len(axes)))
        self._costs = np.empty(evaluations)

    @property
    def dimensions(self) -> int:
        """Number of parameters."""
        return len(self.axes)

    @property
    def remaining(self) -> int:
        """Remaining evaluations."""
        return self.evaluations - self.count

    @property
    def cube(self) -> Floats:
        """Points so far, shape (count, dimensions)."""
        return self._cube[: self.count]

    @property
    def costs(self) -> Floats:
        """Costs so far, deg², shape (count,); inf if yaw overflows."""
        return self._costs[: self.count]

    @property
    def best(self) -> int:
        """Index of the evaluation with the least cost."""
        return int(np.argmin(self.costs))

    def __call__(self, cube: Floats) -> Floats:
        """Costs at points of the unit cube, shapes (c, dimensions) and (c,).

        Raises
        ------
        BudgetSpentError
            If the points exceed the remaining evaluations; the first points are still evaluated.
        """
        inside = np.clip(cube, 0.0, 1.0)[: self.remaining]
        if len(inside):
            start, end = self.count, self.count + len(inside)
            self._cube[start:end] = inside
            self._costs[start:end] = self._costs_of(start, end)
            self.count = end
            self._on_batch(self)
        if len(inside) < len(cube):
            raise BudgetSpentError
        return self._costs[start:end].copy()

    def _costs_of(self, start: int, end: int) -> Floats:
        points, costs = self._known
        if end <= len(costs) and np.array_equal(points[start:end], self._cube[start:end]):
            return costs[start:end]
        self._known = (points[:start], costs[:start])  # the runs differ from here on
        costs = self._pi(values_of(self.axes, self._cube[start:end]))
        return np.where(np.isfinite(costs), costs, np.inf)
