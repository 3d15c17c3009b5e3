"""Evidence about the bias from mean rates, without any rest.

The mean rates of a device that turns left as often as right scatter about the bias. Their median is weak evidence,
because some devices turn to one side only. It changes the probabilities of the hypotheses by a bounded factor, and
moves no bias.
"""

from math import exp, pi, sqrt

from gyrodrift.filters.beliefs import SPINS_PER_DPS
from gyrodrift.filters.restlevel.bias_state import Hypothesis
from gyrodrift.filters.restlevel.mixture import normalise
from gyrodrift.filters.restlevel.model import RestlevelState
from gyrodrift.filters.restlevel.rate_state import TURN_SLOTS, MeanTurns

TURN_S = 10.0
"""Time outside of constant-rate segments in a mean rate, s. Chosen."""

LEAST_TURNS = 5
"""Smallest number of mean rates for a median. Chosen."""

CORRELATED_RATES = 4.0
"""Number of consecutive mean rates that count as a single rate. Derived: bends last up to forty seconds, four times
`TURN_S`."""

LEAST_SPREAD_DPS = 0.05
"""Smallest sigma of the median, deg/s. Chosen: no motion is balanced to better than three degrees per minute."""

SIDED = 0.5
"""Share of devices that turn more to one side. Chosen: the true share is unknown, so the odds are even."""


def follow_turns(turns: MeanTurns, angle_deg: float, seconds: float) -> None:
    """Add a block outside of constant-rate segments to the present mean rate; angle in deg, length in s."""
    turns.angle_deg += angle_deg
    turns.seconds += seconds
    if turns.seconds >= TURN_S:
        add_mean_rate(turns, turns.angle_deg / turns.seconds)
        turns.angle_deg = turns.seconds = 0.0


def add_mean_rate(turns: MeanTurns, mean_dps: float) -> None:
    """Update the median by the mean rate of ten seconds of motion, or of a constant-rate segment, deg/s.

    The sigma of the median follows from order statistics: the number of n values below it has a mean of n/2 and a
    standard deviation of √n/2.
    """
    slot, last = turns.count % TURN_SLOTS, min(turns.count, TURN_SLOTS - 1)
    if turns.count >= TURN_SLOTS:
        _forget(turns, turns.latest[slot].dps)
    k = last
    while k > 0 and turns.ordered[k - 1].dps > mean_dps:
        turns.ordered[k].dps = turns.ordered[k - 1].dps
        k -= 1
    turns.ordered[k].dps = turns.latest[slot].dps = mean_dps
    turns.count += 1
    if turns.count < LEAST_TURNS:
        return
    middle, sigma = 0.5 * last, 0.5 * sqrt(last + 1.0)
    spread_dps = 0.5 * (_value_at(turns, middle + sigma) - _value_at(turns, middle - sigma))
    turns.median_dps = _value_at(turns, middle)
    turns.median_var = CORRELATED_RATES * spread_dps * spread_dps + LEAST_SPREAD_DPS * LEAST_SPREAD_DPS


def forget_turns(turns: MeanTurns) -> None:
    """Forget all mean rates."""
    turns.seconds = turns.angle_deg = 0.0
    turns.count = 0


def weigh_turns(s: RestlevelState) -> None:
    """Weigh each hypothesis by the distance of its bias from the median; this replaces the earlier weight."""
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
    """Remove the oldest mean rate from the order."""
    k = 0
    while k < TURN_SLOTS - 1 and turns.ordered[k].dps != oldest_dps:
        k += 1
    while k < TURN_SLOTS - 1:
        turns.ordered[k].dps = turns.ordered[k + 1].dps
        k += 1


def _value_at(turns: MeanTurns, rank: float) -> float:
    """Mean rate at a rank, counted from 0, interpolated linearly between two ordered values."""
    below = int(rank)
    low_dps, high_dps = turns.ordered[below].dps, turns.ordered[below + 1].dps
    return low_dps + (rank - below) * (high_dps - low_dps)
