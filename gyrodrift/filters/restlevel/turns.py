"""Mean turns: what a device that turns to and fro says of its bias without any rest.

One that turns to the left as often as to the right has mean rates over some seconds that scatter about the bias. Their
median is a doubtful witness of it, since some devices turn to one side alone: it weighs the hypotheses against each
other, by no more than that doubt allows, and moves none of them.
"""

from math import exp, pi, sqrt

from gyrodrift.filters.restlevel.bias_state import Hypothesis
from gyrodrift.filters.restlevel.durations import SPINS_PER_DPS
from gyrodrift.filters.restlevel.mixture import normalise
from gyrodrift.filters.restlevel.model import RestlevelState
from gyrodrift.filters.restlevel.rate_state import TURN_SLOTS, MeanTurns

TURN_S = 10.0
"""Time outside of constant-rate segments that a mean rate is taken over."""

LEAST_TURNS = 5
"""Mean rates that a median and its spread are taken from."""

CORRELATED_RATES = 4.0
"""Bends last up to forty seconds, so that of so many mean rates in a row one is news."""

LEAST_SPREAD_DPS = 0.05
"""The median is no better than this, however alike the mean rates: three degrees a minute to one side."""

SIDED = 0.5
"""Share of devices that turn to one side more than to the other, at any rate: even odds, since nobody knows."""


def follow_turns(turns: MeanTurns, angle_deg: float, seconds: float) -> None:
    """Take a block outside of constant-rate segments into the present mean rate."""
    turns.angle_deg += angle_deg
    turns.seconds += seconds
    if turns.seconds >= TURN_S:
        add_mean_rate(turns, turns.angle_deg / turns.seconds)
        turns.angle_deg = turns.seconds = 0.0


def add_mean_rate(turns: MeanTurns, mean_dps: float) -> None:
    """Take one more mean rate into the median: of some seconds of motion, or of a constant-rate segment.

    The spread of the median is that of its order statistics: of n values n/2 lie below it, give or take √n/2.
    """
    place, others = turns.count % TURN_SLOTS, min(turns.count, TURN_SLOTS - 1)
    if turns.count >= TURN_SLOTS:
        _forget(turns, turns.latest[place].dps)
    k = others
    while k > 0 and turns.ordered[k - 1].dps > mean_dps:
        turns.ordered[k].dps = turns.ordered[k - 1].dps
        k -= 1
    turns.ordered[k].dps = turns.latest[place].dps = mean_dps
    turns.count += 1
    if turns.count < LEAST_TURNS:
        return
    middle, sigma = 0.5 * others, 0.5 * sqrt(others + 1.0)
    spread_dps = 0.5 * (_value_at(turns, middle + sigma) - _value_at(turns, middle - sigma))
    turns.median_dps = _value_at(turns, middle)
    turns.median_var = CORRELATED_RATES * spread_dps * spread_dps + LEAST_SPREAD_DPS * LEAST_SPREAD_DPS


def forget_turns(turns: MeanTurns) -> None:
    """All of them."""
    turns.seconds = turns.angle_deg = 0.0
    turns.count = 0


def weigh_turns(s: RestlevelState) -> None:
    """Weigh each hypothesis by how far its bias lies from the median, in place of what it was weighed by before."""
    if s.turns.count < LEAST_TURNS:
        return
    for h in s.hypotheses:
        if h.weight > 0.0:
            density = _median_density(s.turns, h)
            h.weight *= density / h.turn_density
            h.turn_density = density
    normalise(s)


def _median_density(turns: MeanTurns, h: Hypothesis) -> float:
    """Probability density of the median under a hypothesis, 1/(deg/s)."""
    away_dps, variance = turns.median_dps - h.bias_dps, h.bias_var + turns.median_var
    both_sides = exp(-0.5 * away_dps * away_dps / variance) / sqrt(2.0 * pi * variance)
    return SIDED * SPINS_PER_DPS + (1.0 - SIDED) * both_sides


def _forget(turns: MeanTurns, oldest_dps: float) -> None:
    """The oldest leaves the order."""
    k = 0
    while k < TURN_SLOTS - 1 and turns.ordered[k].dps != oldest_dps:
        k += 1
    while k < TURN_SLOTS - 1:
        turns.ordered[k].dps = turns.ordered[k + 1].dps
        k += 1


def _value_at(turns: MeanTurns, rank: float) -> float:
    """Between two of the ordered values, counted from 0."""
    below = int(rank)
    low_dps, high_dps = turns.ordered[below].dps, turns.ordered[below + 1].dps
    return low_dps + (rank - below) * (high_dps - low_dps)
