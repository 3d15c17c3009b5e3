"""CARLA as published: densities, rewards and memory, against the equations worked out by hand."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gyrodrift.tune.search.carla import GRID, HEIGHT, MEMORY, POINTS, WIDTH, Automaton, Carla, Memory
from gyrodrift.values.arrays import Floats

FULL = np.array([1.0])


def mass(automaton: Automaton, low: float, high: float) -> float:
    inside = (low <= POINTS) & (high >= POINTS)
    return float(np.trapezoid(automaton.density[inside], POINTS[inside]))


def test_it_begins_without_a_preference() -> None:
    """f(x) = 1/d, and the action is z itself."""
    z = np.random.default_rng(1).random(100)
    assert Automaton().select(z) == pytest.approx(z)


def test_a_full_reward_adds_one_and_a_half_percent_of_mass() -> None:
    """g_h·√(2π)·g_w, before the integral is brought back to 1."""
    automaton = Automaton()
    automaton.reinforce(np.array([0.5]), FULL)
    added = HEIGHT * np.sqrt(2.0 * np.pi) * WIDTH
    assert added == pytest.approx(0.015, rel=0.01)
    assert mass(automaton, 0.4, 0.6) == pytest.approx((0.2 + added) / (1.0 + added), rel=1e-4)


@given(st.lists(st.tuples(st.floats(0, 1), st.floats(0, 1)), min_size=1, max_size=20))
def test_whatever_is_rewarded_the_density_stays_one(rewards: list[tuple[float, float]]) -> None:
    automaton = Automaton()
    for action, beta in rewards:
        automaton.reinforce(np.array([action]), np.array([beta]))
    assert automaton.density.min() > 0.0
    assert np.trapezoid(automaton.density, POINTS) == pytest.approx(1.0)


def test_actions_follow_the_density() -> None:
    """The share of choices in an interval is the mass over it."""
    automaton = Automaton()
    for _ in range(50):
        automaton.reinforce(np.array([0.3]), FULL)
    chosen = automaton.select(np.random.default_rng(2).random(20_000))
    for low, high in ((0.0, 0.26), (0.26, 0.34), (0.34, 1.0)):
        share = float(np.mean((chosen >= low) & (chosen <= high)))
        assert share == pytest.approx(mass(automaton, low, high), abs=0.015)
    assert automaton.mode == pytest.approx(0.3, abs=1.0 / GRID)


def test_rewards_run_from_the_median_to_the_least_once_the_memory_is_full() -> None:
    memory = Memory(5)
    assert [memory.judge(cost) for cost in (1.0, 2.0, 3.0, 4.0, 5.0)] == [0.0] * 5
    assert memory.judge(2.0) == pytest.approx(0.5)  # of 1 2 3 4 5
    assert memory.judge(0.5) == 1.0  # of 2 3 4 5 2
    assert memory.judge(4.0) == 0.0


def test_a_cost_that_is_not_finite_is_bad_and_forgotten() -> None:
    memory = Memory(3)
    for cost in (1.0, np.inf, 2.0, np.nan, 3.0):
        assert memory.judge(cost) == 0.0
    assert memory.judge(1.5) == pytest.approx(0.5)


def test_equal_costs_are_worth_nothing() -> None:
    memory = Memory(3)
    assert [memory.judge(1.0) for _ in range(6)] == [0.0] * 6


def bowl(point: Floats) -> Floats:
    return np.asarray(np.sum((point - np.array([0.2, 0.7])) ** 2, axis=1))


def test_automata_that_share_a_cost_find_a_minimum_together() -> None:
    carla = Carla(2, np.random.default_rng(3))
    for _ in range(10 * MEMORY):
        point = carla.ask()
        carla.tell(point, bowl(point))
    assert [automaton.mode for automaton in carla.automata] == pytest.approx([0.2, 0.7], abs=0.06)
