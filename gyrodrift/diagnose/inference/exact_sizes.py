"""Sizes and phases between those of the grid, by what simulations at these very values leave unexplained.

A fit decides between sizes a tenth apart, and phases a twelfth of a turn. A strong cause stands out by more than it is
known to that way: adopted a percent off, it would be found again. Gauss-Newton steps with the weights of the likelihood
go on from there; slopes come from the tables at first, and from what the simulations on the way show (C. G. Broyden, A
class of methods for solving nonlinear simultaneous equations, 1965).
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.inference.likelihood import DEGREES_OF_FREEDOM, log_likelihood
from gyrodrift.diagnose.inference.surrogate import Cause, Surrogate
from gyrodrift.diagnose.simulate.candidate import PHASE_STEP_DEG
from gyrodrift.diagnose.simulate.response_table import SimulatedSet


class Placed(NamedTuple):
    """A cause at a size, and perhaps at a phase in degrees, of no grid."""

    cause: Cause
    size: float
    phase_deg: float | None = None


SimulateAt = Callable[[Sequence[Placed]], SimulatedSet]
"""What causes do to the features there, by the simulator itself."""

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
    """Of a cause, with its standard error by what chance leaves; its phase likewise, degrees, where it has one."""

    size: float
    error: float
    phase_deg: float | None = None
    phase_error_deg: float = 0.0


class _Unknown(NamedTuple):
    """A size or a phase: whose it is in a set, what it is by the grid, and the same cause to either side of it."""

    number: int
    is_phase: bool
    own: float
    below: Cause
    above: Cause
    bounds: tuple[float, float]


class _State(NamedTuple):
    """Values, (k,), what causes do at these, (sessions, F), and by how much more with each value, (k, sessions, F)."""

    values: Floats
    change: Floats
    slopes: Floats


def exact_sizes(surrogate: Surrogate, causes: Sequence[Cause], simulate_at: SimulateAt) -> dict[str, ExactSize]:
    """Of each cause whose size can be any, by its name: random ones and those of a single size stay as they are."""
    unknowns = _unknowns(surrogate, causes)
    if not unknowns:
        return {}
    prediction, evidence = surrogate.prediction(causes), surrogate.evidence
    variance = evidence.variance_with(prediction.variance)
    bounds = np.array([one.bounds for one in unknowns]).T
    is_simulated = not all(causes[one.number].candidate.grid_points[0] < 0.0 for one in unknowns)
    slopes = np.array([_slope(surrogate, causes, one) for one in unknowns])
    state = _State(np.array([one.own for one in unknowns]), prediction.change, slopes)
    for _ in range(ROUNDS if is_simulated else 0):
        step, error = _step(evidence.difference - state.change, state.slopes, variance)
        values = np.clip(state.values + step, *bounds)
        if (np.abs(values - state.values) < WORTH_A_ROUND * error).all():
            break
        change = simulate_at(_placed(causes, unknowns, values)).change
        before, after = (_score(evidence.difference - each, variance) for each in (state.change, change))
        if after < before - AS_GOOD:
            return _named(causes, unknowns, state.values, error)
        state = _State(values, change, _learned(state, values - state.values, change, error))
    step, error = _step(evidence.difference - state.change, state.slopes, variance)
    return _named(causes, unknowns, np.clip(state.values + step, *bounds), error)


def _unknowns(surrogate: Surrogate, causes: Sequence[Cause]) -> list[_Unknown]:
    found = []
    for number, cause in enumerate(causes):
        near = _beside(cause)
        if cause.is_random or len(near) == 1:
            continue
        below, above = (Cause(cause.response, at) for at in (near[0], near[-1]))
        found.append(_Unknown(number, False, cause.size, below, above, (below.size, above.size)))
        phase_deg = cause.candidate.phase_deg
        if phase_deg is not None and not cause.candidate.is_phase_free:
            bounds = phase_deg - PHASE_STEP_DEG, phase_deg + PHASE_STEP_DEG
            before, behind = (_turned(surrogate, cause, bound_deg) for bound_deg in bounds)
            found.append(_Unknown(number, True, phase_deg, before, behind, bounds))
    return found


def _beside(cause: Cause) -> list[int]:
    """Numbers of a size and of its neighbours on the same side of zero."""
    sizes = cause.candidate.sizes
    near = range(max(cause.at - 1, 0), min(cause.at + 2, len(sizes)))
    return [at for at in near if sizes[at] * cause.size > 0.0]


def _turned(surrogate: Surrogate, cause: Cause, phase_deg: float) -> Cause:
    """The same cause at another phase of the grid."""
    variants = surrogate.evidence.variants(cause.name)
    return Cause(next(one for one in variants if one.candidate.phase_deg == phase_deg % 360.0), cause.at)


def _placed(causes: Sequence[Cause], unknowns: Sequence[_Unknown], values: Floats) -> list[Placed]:
    placed = [Placed(cause, cause.size) for cause in causes]
    for one, value in zip(unknowns, values.tolist(), strict=True):
        changed = {"phase_deg": value} if one.is_phase else {"size": value}
        placed[one.number] = placed[one.number]._replace(**changed)
    return placed


def _named(
    causes: Sequence[Cause], unknowns: Sequence[_Unknown], values: Floats, errors: Floats
) -> dict[str, ExactSize]:
    found: dict[str, ExactSize] = {}
    for one, value, error in zip(unknowns, values.tolist(), errors.tolist(), strict=True):
        name = causes[one.number].name
        if one.is_phase:
            found[name] = found[name]._replace(phase_deg=value % 360.0, phase_error_deg=error)
        else:
            found[name] = ExactSize(value, error)
    return found


def _slope(surrogate: Surrogate, causes: Sequence[Cause], one: _Unknown) -> Floats:
    """(sessions, F) by which the change grows with an unknown."""
    below, above = (
        surrogate.prediction([*causes[: one.number], beside, *causes[one.number + 1 :]]).change
        for beside in (one.below, one.above)
    )
    slope: Floats = (above - below) / (one.bounds[1] - one.bounds[0])
    return slope


def _score(left: Floats, variance: Floats) -> float:
    return float(log_likelihood(left, variance, np.zeros_like(left)).sum())


def _step(left: Floats, slopes: Floats, variance: Floats) -> tuple[Floats, Floats]:
    """(k,) each: by how much values change to explain the most of what is left, and the standard errors of that."""
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
    """Slopes that would have foretold this change; they turn the least where values were not moved."""
    along = moved / np.square(error)
    missing = change - state.change - np.tensordot(moved, state.slopes, axes=1)
    slopes: Floats = state.slopes + along[:, None, None] * missing / float(along @ moved)
    return slopes
