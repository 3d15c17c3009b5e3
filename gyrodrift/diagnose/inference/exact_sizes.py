"""Sizes between those of the grid, by what simulations at these very sizes leave unexplained.

A fit decides between sizes a tenth apart. A strong cause stands out by more than its size is known to that way: adopted
a percent off, it would be found again. Gauss-Newton steps with the weights of the likelihood go on from there; slopes
come from the tables at first, and from what the simulations on the way show (C. G. Broyden, A class of methods for
solving nonlinear simultaneous equations, 1965).
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.inference.likelihood import DEGREES_OF_FREEDOM, log_likelihood
from gyrodrift.diagnose.inference.surrogate import Cause, Surrogate
from gyrodrift.diagnose.simulate.response_table import SimulatedSet

SimulateAt = Callable[[Sequence[Cause], Sequence[float]], SimulatedSet]
"""What causes do to the features at sizes of no grid, by the simulator itself."""

ROUNDS = 2
"""Simulations at most; what the last one leaves is a step too, which needs no further one."""

WORTH_A_ROUND = 0.5
"""In standard errors: smaller steps need no simulation."""

AS_GOOD = 6.0
"""Log-likelihood: a size that scores less by no more is as good, since it is the mean of a few simulations. The step to
it was led by all features."""

REWEIGHTINGS = 20
"""Until the weights of a Student density no longer change."""


class ExactSize(NamedTuple):
    """Of a cause, with its standard error by what chance leaves."""

    size: float
    error: float


class _State(NamedTuple):
    """Sizes, (k,), what causes do at these, (sessions, F), and by how much more with each size, (k, sessions, F)."""

    sizes: Floats
    change: Floats
    slopes: Floats


def exact_sizes(surrogate: Surrogate, causes: Sequence[Cause], simulate_at: SimulateAt) -> dict[str, ExactSize]:
    """Of each cause whose size can be any, by its name: random ones and those of a single size stay as they are."""
    free = [number for number, cause in enumerate(causes) if not cause.is_random and len(_beside(cause)) > 1]
    if not free:
        return {}
    prediction, evidence = surrogate.prediction(causes), surrogate.evidence
    variance = evidence.sigma**2 + prediction.variance
    own = np.array([cause.size for cause in causes])
    bounds = np.array([_bounds(causes[number]) for number in free]).T
    is_simulated = not all(causes[number].candidate.grid_points[0] < 0.0 for number in free)

    def change_at(sizes: Floats) -> Floats:
        every = own.copy()
        every[free] = sizes
        return simulate_at(causes, every.tolist()).change

    slopes = np.array([_slope(surrogate, causes, number) for number in free])
    state = _State(own[free], prediction.change, slopes)
    for _ in range(ROUNDS if is_simulated else 0):
        step, error = _step(evidence.difference - state.change, state.slopes, variance)
        sizes = np.clip(state.sizes + step, *bounds)
        if (np.abs(sizes - state.sizes) < WORTH_A_ROUND * error).all():
            break
        change = change_at(sizes)
        before, after = (_score(evidence.difference - each, variance) for each in (state.change, change))
        if after < before - AS_GOOD:
            return _named(causes, free, state.sizes, error)
        state = _State(sizes, change, _learned(state, sizes - state.sizes, change, error))
    step, error = _step(evidence.difference - state.change, state.slopes, variance)
    return _named(causes, free, np.clip(state.sizes + step, *bounds), error)


def _named(causes: Sequence[Cause], free: Sequence[int], sizes: Floats, error: Floats) -> dict[str, ExactSize]:
    found = zip(free, sizes, error, strict=True)
    return {causes[number].name: ExactSize(float(size), float(off)) for number, size, off in found}


def _beside(cause: Cause) -> list[int]:
    """Numbers of a size and of its neighbours on the same side of zero."""
    sizes = cause.candidate.sizes
    near = range(max(cause.at - 1, 0), min(cause.at + 2, len(sizes)))
    return [at for at in near if sizes[at] * cause.size > 0.0]


def _bounds(cause: Cause) -> tuple[float, float]:
    near = cause.candidate.sizes[_beside(cause)]
    return float(near[0]), float(near[-1])


def _slope(surrogate: Surrogate, causes: Sequence[Cause], number: int) -> Floats:
    """(sessions, F) by which the change grows with the size of one of the causes."""
    cause = causes[number]
    near = _beside(cause)
    changes, sizes = [], cause.candidate.sizes
    for at in (near[0], near[-1]):
        beside = [*causes[:number], Cause(cause.response, at), *causes[number + 1 :]]
        changes.append(surrogate.prediction(beside).change)
    slope: Floats = (changes[1] - changes[0]) / (sizes[near[-1]] - sizes[near[0]])
    return slope


def _score(left: Floats, variance: Floats) -> float:
    return float(log_likelihood(left, variance, np.zeros_like(left)).sum())


def _step(left: Floats, slopes: Floats, variance: Floats) -> tuple[Floats, Floats]:
    """(k,) each: by how much sizes change to explain the most of what is left, and the standard errors of that."""
    columns = (slopes / np.sqrt(variance)).reshape(len(slopes), -1).T
    wanted, weights = (left / np.sqrt(variance)).ravel(), np.ones(left.size)
    step = np.zeros(len(slopes))
    for _ in range(REWEIGHTINGS):
        inverse = np.linalg.pinv((columns * weights[:, None]).T @ columns)
        step = inverse @ (columns.T @ (weights * wanted))
        squares = np.square(wanted - columns @ step)
        weights = (DEGREES_OF_FREEDOM + 1.0) / (DEGREES_OF_FREEDOM + squares)
    return step, np.sqrt(np.diag(inverse))


def _learned(state: _State, moved: Floats, change: Floats, error: Floats) -> Floats:
    """Slopes that would have foretold this change; they turn the least where sizes were not moved."""
    along = moved / np.square(error)
    missing = change - state.change - np.tensordot(moved, state.slopes, axes=1)
    slopes: Floats = state.slopes + along[:, None, None] * missing / float(along @ moved)
    return slopes
