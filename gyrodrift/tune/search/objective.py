"""What every search method asks: the cost at points of the unit cube, counted, cached, and never over budget."""

from collections.abc import Callable, Sequence

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.evaluation.space import Axis, values_of


class BudgetSpentError(Exception):
    """All evaluations have been made; a search ends here."""


class Objective:
    """Counts evaluations and keeps them.

    An earlier run with the same seed asks the same points in the same order: known costs are taken from a cache
    and not worked out anew, and so any method can be resumed.

    Parameters
    ----------
    pi
        From values of the axes, shape (c, axes), to costs in deg², shape (c,).
    axes
        What the unit cube stands for.
    evaluations
        How many there are in all.
    known
        Points, shape (k, axes), and costs, shape (k,), of an earlier run.
    on_batch
        Called after each batch.
    """

    def __init__(
        self,
        pi: Callable[[Floats], Floats],
        axes: Sequence[Axis],
        evaluations: int,
        known: tuple[Floats, Floats] | None = None,
        on_batch: Callable[["Objective"], None] = lambda _objective: None,
    ) -> None:
        self.axes = axes
        self.evaluations = evaluations
        self.count = 0
        self._pi = pi
        self._known = known or (np.empty((0, len(axes))), np.empty(0))
        self._on_batch = on_batch
        self._cube = np.empty((evaluations, len(axes)))
        self._costs = np.empty(evaluations)

    @property
    def dimensions(self) -> int:
        """How many parameters."""
        return len(self.axes)

    @property
    def left(self) -> int:
        """Evaluations that are left."""
        return self.evaluations - self.count

    @property
    def cube(self) -> Floats:
        """The points so far, shape (count, dimensions)."""
        return self._cube[: self.count]

    @property
    def costs(self) -> Floats:
        """Their costs, deg², shape (count,); infinite where one left the floats."""
        return self._costs[: self.count]

    @property
    def best(self) -> int:
        """Which evaluation was the cheapest."""
        return int(np.argmin(self.costs))

    def __call__(self, cube: Floats) -> Floats:
        """Costs at points of the unit cube, shapes (c, dimensions) and (c,).

        Raises
        ------
        BudgetSpentError
            Where there are more points than evaluations left; the first ones are still worked out.
        """
        inside = np.clip(cube, 0.0, 1.0)[: self.left]
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
        self._known = (points[:start], costs[:start])  # from here on this run is another one
        found = self._pi(values_of(self.axes, self._cube[start:end]))
        return np.where(np.isfinite(found), found, np.inf)
