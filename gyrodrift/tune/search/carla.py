"""CARLA as published: continuous action reinforcement learning automata, one for each parameter, with one cost.

Sources: M. N. Howell, G. P. Frost, T. J. Gordon and Q. H. Wu, "Continuous action reinforcement learning applied to
vehicle suspension control", Mechatronics 7(3), 1997; M. N. Howell and M. C. Best, "On-line PID tuning for engine idle
speed control using continuous action reinforcement learning automata", Control Engineering Practice 8, 2000.
"""

from collections import deque
from dataclasses import dataclass, field

import numpy as np

from gyrodrift.values.arrays import Floats

WIDTH = 0.02
"""g_w: width of a reward around an action, in shares of the range; published."""

HEIGHT = 0.3
"""g_h: height of a full reward; with this width 1.5 % of the total mass. Published."""

MEMORY = 200
"""R: number of recent costs for median and minimum; published."""

GRID = 501
"""Points of the density, some ten per width of a reward: chosen."""


@dataclass(slots=True)
class Automaton:
    """Probability density over the unit interval that rises at rewarded actions.

    density
        Values at `GRID` even points, shape (GRID,); the integral by the trapezoidal rule is 1.
    """

    density: Floats = field(default_factory=lambda: np.ones(GRID))

    def select(self, z: Floats) -> Floats:
        """The actions x with CDF(x) = z, of the shape of z."""
        steps = 0.5 * (self.density[1:] + self.density[:-1])
        cdf = np.concatenate([[0.0], np.cumsum(steps)])
        actions: Floats = np.interp(z * cdf[-1], cdf, POINTS)
        return actions

    def reinforce(self, actions: Floats, betas: Floats, width: float = WIDTH, height: float = HEIGHT) -> None:
        """Raise the density around actions by their rewards, shapes (k,), and normalize it."""
        if betas.any():
            bells = np.exp(-0.5 * ((POINTS - actions[:, np.newaxis]) / width) ** 2)
            self.density = self.density + height * (betas @ bells)
            self.density /= np.trapezoid(self.density, POINTS)

    @property
    def mode(self) -> float:
        """Mode of the density."""
        return float(POINTS[np.argmax(self.density)])


POINTS: Floats = np.linspace(0.0, 1.0, GRID)


class Memory:
    """Recent costs, which give the reward of a new cost."""

    def __init__(self, size: int = MEMORY) -> None:
        self._costs: deque[float] = deque(maxlen=size)

    def judge(self, cost: float) -> float:
        """The reward β of a cost, from 0 at the median to 1 at the minimum; then the cost is stored.

        A cost that is not finite has no reward and is not stored.
        """
        if not np.isfinite(cost):
            return 0.0
        beta = 0.0
        if len(self._costs) == self._costs.maxlen:
            median, least = float(np.median(self._costs)), min(self._costs)
            beta = float(np.clip((median - cost) / (median - least), 0.0, 1.0)) if median > least else 0.0
        self._costs.append(cost)
        return beta


class Carla:
    """One automaton for each parameter, with a common memory of costs."""

    def __init__(self, dimensions: int, rng: np.random.Generator, memory: int = MEMORY) -> None:
        self.automata = [Automaton() for _ in range(dimensions)]
        self._memory = Memory(memory)
        self._rng = rng

    def ask(self) -> Floats:
        """Choose a point of the unit cube, shape (1, dimensions)."""
        draws = self._rng.random((1, len(self.automata)))
        return np.column_stack([automaton.select(z) for automaton, z in zip(self.automata, draws.T, strict=True)])

    def tell(self, point: Floats, costs: Floats) -> None:
        """Learn from the cost of a point, shape (1,)."""
        betas = np.array([self._memory.judge(float(costs[0]))])
        for automaton, actions in zip(self.automata, point.T, strict=True):
            automaton.reinforce(actions, betas)
