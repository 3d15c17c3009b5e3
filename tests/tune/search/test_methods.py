"""Every search method: it spends its budget and no more, can be resumed, and finds what there is to find."""

from collections.abc import Callable

import numpy as np
import pytest

from gyrodrift.evaluation.space import Axis, axes_of
from gyrodrift.filters.hdr_filter import HDR
from gyrodrift.tune.search.methods import METHODS, run_to_budget
from gyrodrift.tune.search.objective import BudgetSpentError, Objective
from gyrodrift.values.arrays import Floats

AXES = axes_of(HDR)

UNIT = tuple(Axis(axis.name, 0.0, 1.0) for axis in AXES)
TARGET = np.array([0.3, 0.8, 0.45, 0.6, 0.15])
Pi = Callable[[Floats], Floats]


def ridge(params: Floats) -> Floats:
    """A long valley across the axes, as i_c, c1 and c2 make one, with ripples on its ground."""
    away = params - TARGET
    across = away[:, 0] + away[:, 3] - away[:, 4]
    ripples = 0.002 * np.sum(np.sin(40.0 * away) ** 2, axis=1)
    return np.asarray(1.0 + 100.0 * across**2 + np.sum(away**2, axis=1) + ripples)


def two_valleys(params: Floats) -> Floats:
    """The deeper one is the narrower one, and off the middle."""
    wide = np.sum((params - 0.6) ** 2, axis=1) + 0.3
    return np.asarray(np.minimum(wide, 2.0 * np.sum((params - 0.2) ** 2, axis=1) + 0.01))


def half_infinite(params: Floats) -> Floats:
    return np.where(params[:, 1] > 0.5, np.inf, ridge(params))


def searched(method: str, pi: Pi, evaluations: int, seed: int = 0) -> Objective:
    objective = Objective(pi, UNIT, evaluations)
    run_to_budget(METHODS[method](), objective, seed)
    return objective


@pytest.mark.parametrize("method", METHODS)
def test_it_spends_its_budget_and_no_more(method: str) -> None:
    request = []

    def pi(params: Floats) -> Floats:
        request.append(len(params))
        return ridge(params)

    objective = searched(method, pi, 301)
    assert sum(request) == objective.count == len(objective.costs) == 301
    assert objective.costs[objective.best] == objective.costs.min()


@pytest.mark.parametrize("method", METHODS)
def test_the_same_seed_asks_the_same_and_another_seed_something_else(method: str) -> None:
    first, again, second = (searched(method, ridge, 200, seed).cube for seed in (1, 1, 2))
    assert np.array_equal(first, again)
    assert not np.array_equal(first, second)


@pytest.mark.parametrize("method", METHODS)
def test_it_goes_on_where_an_earlier_run_ended(method: str) -> None:
    whole = searched(method, ridge, 400)
    fresh: list[int] = []

    def pi(params: Floats) -> Floats:
        fresh.append(len(params))
        return ridge(params)

    objective = Objective(pi, UNIT, 400, cached=(whole.cube[:250].copy(), whole.costs[:250].copy()))
    run_to_budget(METHODS[method](), objective, 0)
    assert np.array_equal(objective.cube, whole.cube)
    assert np.array_equal(objective.costs, whole.costs)
    assert sum(fresh) < 250


def test_what_was_known_of_another_run_is_not_believed() -> None:
    """Points that differ are worked out."""
    expected = (np.full((50, 5), 0.5), np.zeros(50))
    objective = Objective(ridge, UNIT, 100, cached=expected)
    run_to_budget(METHODS["random"](), objective, 0)
    assert objective.costs.min() >= 1.0


@pytest.mark.parametrize("method", METHODS)
def test_costs_that_are_not_finite_are_survived(method: str) -> None:
    objective = searched(method, half_infinite, 600)
    assert np.isfinite(objective.costs[objective.best])


@pytest.mark.parametrize("method", METHODS)
def test_where_every_cost_is_infinite_it_still_ends(method: str) -> None:
    assert searched(method, lambda params: np.full(len(params), np.inf), 150).count == 150


def test_the_default_follows_a_ridge() -> None:
    bests = {name: np.median([searched(name, ridge, 600, seed).costs.min() for seed in range(5)]) for name in METHODS}
    assert bests["race"] < 1.1
    assert bests["race"] < min(bests["random"], bests["carla"])


def test_the_default_finds_the_narrow_valley() -> None:
    bests = [searched("race", two_valleys, 900, seed).costs.min() for seed in range(8)]
    assert np.median(bests) < 0.05


def test_points_outside_the_cube_are_brought_inside() -> None:
    objective = Objective(ridge, UNIT, 3)
    with pytest.raises(BudgetSpentError):
        objective(np.full((5, 5), 1.5))
    assert objective.cube.tolist() == [[1.0] * 5] * 3
