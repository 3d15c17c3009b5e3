"""Mean turns: how far the device turned in each ten seconds or so, which says a little of the bias without any rest.

A device that turns to and fro, to the left as often as to the right, has mean rates that scatter about the bias. Their
median, with the spread that its order statistics give it, is a doubtful witness of the bias: a vehicle on a roundabout
turns to one side alone.
"""

from math import exp, pi, sqrt

from gyrodrift.filters.restlevel.model import RestlevelState
from gyrodrift.filters.restlevel.state import TURN_PLACES, Hypothesis
from gyrodrift.filters.restlevel.wander import SPINS_PER_DPS

TURN_S = 10.0
LEAST_TURNS = 5
SIDED = 0.1


def follow_turns(s: RestlevelState, turned_deg: float, seconds: float) -> None:
    turns = s.turns
    turns.turned_deg += turned_deg
    turns.seconds += seconds
    if turns.seconds >= TURN_S:
        see_turn(s, turns.turned_deg / turns.seconds)
        turns.turned_deg = turns.seconds = 0.0


def see_turn(s: RestlevelState, mean_dps: float) -> None:
    """One more mean rate; the median and its variance follow."""
    turns = s.turns
    place = turns.seen % TURN_PLACES
    if turns.seen >= TURN_PLACES:  # the oldest leaves the order
        oldest = turns.latest[place].dps
        k = 0
        while turns.ordered[k].dps != oldest:
            k += 1
        while k < TURN_PLACES - 1:
            turns.ordered[k].dps = turns.ordered[k + 1].dps
            k += 1
    known = min(turns.seen, TURN_PLACES - 1)
    turns.latest[place].dps = mean_dps
    k = known
    while k > 0 and turns.ordered[k - 1].dps > mean_dps:
        turns.ordered[k].dps = turns.ordered[k - 1].dps
        k -= 1
    turns.ordered[k].dps = mean_dps
    turns.seen += 1
    known += 1
    if known < LEAST_TURNS:
        return
    half = 0.5 * sqrt(known)
    middle = 0.5 * (known - 1)
    turns.middle_dps = _quantile(s, middle)
    spread_dps = 0.5 * (_quantile(s, middle + half) - _quantile(s, middle - half))
    turns.middle_var = 4.0 * spread_dps * spread_dps + 0.0025


def _quantile(s: RestlevelState, rank: float) -> float:
    below = int(rank)
    low_dps, high_dps = s.turns.ordered[below].dps, s.turns.ordered[below + 1].dps
    return low_dps + (rank - below) * (high_dps - low_dps)


def weigh_turns(s: RestlevelState) -> None:
    """Each hypothesis by how well its bias fits."""
    if s.turns.seen < LEAST_TURNS:
        return
    total = 0.0
    for h in s.hypotheses:
        if h.weight > 0.0:
            odds = turn_odds(s, h)
            h.weight *= odds / h.turn_odds
            h.turn_odds = odds
            total += h.weight
    for h in s.hypotheses:
        h.weight /= total


def turn_odds(s: RestlevelState, h: Hypothesis) -> float:
    return SIDED * SPINS_PER_DPS + (1.0 - SIDED) * even_density(s, h)


def even_density(s: RestlevelState, h: Hypothesis) -> float:
    variance = h.bias_var + s.turns.middle_var
    away_dps = s.turns.middle_dps - h.bias_dps
    return exp(-0.5 * away_dps * away_dps / variance) / sqrt(2.0 * pi * variance)
