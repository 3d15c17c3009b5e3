"""The default search: automata look over the whole cube in batches, and local searches race from where they point.

What it takes from CARLA: one automaton a parameter, rewards from the median cost to the least, a density that
remembers. What it adds, since measurement shows that each helps: logarithmic axes and costs, batches that are worked
out side by side, a reward width that adapts from wide to narrow, local searches that follow the ridges which a
product of densities cannot (by the covariance of the `cma` package), a race between several of them so that no single
valley decides, and restarts for as long as there is budget.
"""

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.tune.search.carla import Automaton
from gyrodrift.tune.search.objective import Objective

LOOK_POINTS = 64
"""Points of the first look over the cube, in batches."""

BATCH = 32

WIDTH_FIRST, WIDTH_LAST, WIDTH_SHRINKS = 0.15, 0.03, 0.85
HEIGHT = 1.0
FLOOR = 0.1
"""Rewards reach wide at first and narrower with each batch; a tenth of all choices stays uniform."""

RACERS, RACERS_LATER = 4, 3
APART = 0.25
"""Racers start at the best points that differ from each other by this share of some range."""

HEATS = (10, 15)
"""Generations after which the worse half of the racers drops out."""

SIGMA, SIGMA_POLISH = 0.2, 0.08
POPULATION = 8
"""As many as the kernel walks side by side."""

PATIENCE, PATIENCE_POLISH = 30, 17
GAIN = 1e-4
"""A local search ends when so many generations together have gained less than this share of the cost."""

HOPELESS = 2.0
"""The winner of a race goes on only while its cost is within this factor of the best ever seen."""

LARGEST = 1e300
"""Stands for a cost that is not finite, in methods that calculate with costs."""


class Team:
    """Automata that choose points in batches and are rewarded by the logarithm of the cost."""

    def __init__(self, dimensions: int, rng: np.random.Generator) -> None:
        self.automata = [Automaton() for _ in range(dimensions)]
        self._rng = rng
        self._width = WIDTH_FIRST
        self._logs: list[float] = []

    def ask(self) -> Floats:
        """A batch of points, shape (BATCH, dimensions)."""
        draws = self._rng.random((BATCH, len(self.automata)))
        is_free = self._rng.random(draws.shape) < FLOOR
        columns = [automaton.select(z) for automaton, z in zip(self.automata, draws.T, strict=True)]
        return np.where(is_free, draws, np.column_stack(columns))

    def tell(self, points: Floats, costs: Floats) -> None:
        """What they cost."""
        logs = np.log(np.clip(costs, 1e-300, LARGEST))
        self._logs += logs[np.isfinite(costs)].tolist()
        if self._logs:
            median, least = float(np.median(self._logs)), min(self._logs)
            betas = np.clip((median - logs) / (median - least), 0.0, 1.0) if median > least else np.zeros(len(logs))
            for automaton, actions in zip(self.automata, points.T, strict=True):
                automaton.reinforce(actions, betas, self._width, HEIGHT)
        self._width = max(WIDTH_LAST, self._width * WIDTH_SHRINKS)


class Racer:
    """A local search from a point, which knows when it has come to its end."""

    def __init__(self, start: Floats, sigma: float, patience: int, rng: np.random.Generator) -> None:
        import cma  # noqa: PLC0415 - half a second to import, for who searches

        options = {"bounds": [0.0, 1.0], "popsize": POPULATION, "seed": int(rng.integers(1, 2**31)), "verbose": -9}
        options |= {"tolfun": 0.0, "tolfunhist": 0.0, "tolx": 1e-5}  # when it ends is decided here
        self._strategy = cma.CMAEvolutionStrategy(start, sigma, options)
        self._patience = patience
        self._history: list[float] = []

    @property
    def best(self) -> float:
        """The least cost it has seen."""
        return min(self._history)

    @property
    def is_done(self) -> bool:
        """Whether it gains nothing any more."""
        recent, before = self._history[-self._patience :], self._history[: -self._patience]
        is_stuck = len(before) > self._patience and min(recent) > min(before) * (1.0 - GAIN)
        return is_stuck or bool(self._strategy.stop())

    def ask(self) -> Floats:
        """The points of a generation, shape (POPULATION, dimensions)."""
        return np.array(self._strategy.ask())

    def tell(self, points: Floats, costs: Floats) -> None:
        """What they cost."""
        self._strategy.tell(list(points), np.minimum(costs, LARGEST).tolist())
        self._history.append(float(costs.min()))

    def run(self, objective: Objective) -> None:
        """One generation."""
        points = self.ask()
        self.tell(points, objective(points))


def race(objective: Objective, rng: np.random.Generator, team: Team) -> None:
    """Search until the budget is spent; `team` ends up with what the automata have learnt.

    Raises
    ------
    BudgetSpentError
        At the end.
    """
    racers = RACERS
    while True:
        seen = objective.count
        for _ in range(LOOK_POINTS // BATCH):
            points = team.ask()
            team.tell(points, objective(points))
        starts = _apart(objective.cube[seen:], objective.costs[seen:], racers)
        winner = _heats(objective, [Racer(start, SIGMA, PATIENCE, rng) for start in starts])
        while not winner.is_done and winner.best < HOPELESS * objective.costs.min():
            winner.run(objective)
        polish = Racer(objective.cube[objective.best].copy(), SIGMA_POLISH, PATIENCE_POLISH, rng)
        while not polish.is_done:
            polish.run(objective)
        racers = RACERS_LATER


def _apart(cube: Floats, costs: Floats, count: int) -> list[Floats]:
    """The best points that are not close to a better one."""
    chosen: list[Floats] = []
    for point in cube[np.argsort(costs, kind="stable")]:
        if all(np.abs(point - other).max() > APART for other in chosen):
            chosen.append(point.copy())
        if len(chosen) == count:
            break
    return chosen


def _heats(objective: Objective, racers: list[Racer]) -> Racer:
    """Let them run side by side; the better half goes on to the next heat."""
    for generations in HEATS:
        for _ in range(generations):
            running = [racer for racer in racers if not racer.is_done]
            if not running:
                break
            asked = [racer.ask() for racer in running]
            costs = objective(np.vstack(asked))
            for number, (racer, points) in enumerate(zip(running, asked, strict=True)):
                racer.tell(points, costs[number * POPULATION : (number + 1) * POPULATION])
        racers = sorted(racers, key=lambda racer: racer.best)[: max(1, len(racers) // 2)]
    return racers[0]
