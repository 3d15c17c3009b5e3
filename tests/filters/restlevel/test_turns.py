"""Mean turns weigh hypotheses about the bias, by no more than they are worth."""

import numpy as np
import pytest

from gyrodrift.filters.restlevel.bias_state import Hypothesis
from gyrodrift.filters.restlevel.model import RestlevelParams, RestlevelState
from gyrodrift.filters.restlevel.rate_state import TURN_SLOTS, MeanTurns
from gyrodrift.filters.restlevel.step import coefficients, step
from gyrodrift.filters.restlevel.turns import add_mean_rate, follow_turns, forget_turns, weigh_turns
from gyrodrift.values.arrays import Floats


def observed(rates_dps: list[float]) -> MeanTurns:
    """After these mean rates."""
    turns = MeanTurns()
    for dps in rates_dps:
        add_mean_rate(turns, dps)
    return turns


@pytest.mark.parametrize("count", [5, 8, TURN_SLOTS, 3 * TURN_SLOTS + 7])
def test_the_median_is_that_of_the_latest(count: int) -> None:
    rates_dps = np.round(np.random.default_rng(count).normal(0.3, 2.0, count), 1).tolist()
    latest = rates_dps[-TURN_SLOTS:]
    turns = observed(rates_dps)
    assert turns.median_dps == pytest.approx(np.median(latest))
    assert [turn.dps for turn in turns.ordered[: len(latest)]] == sorted(latest)


def test_the_spread_is_that_of_a_median() -> None:
    dice = np.random.default_rng(3)
    result = [observed(dice.normal(0.0, 4.0, TURN_SLOTS).tolist()).median_var for _ in range(300)]
    assert np.sqrt(np.median(result)) == pytest.approx(2.0 * 1.2533 * 4.0 / np.sqrt(TURN_SLOTS), rel=0.1)


def test_a_rate_is_the_mean_of_ten_seconds() -> None:
    """Blocks of 4 s: the third fills it, and the next begins with nothing."""
    turns = MeanTurns()
    for angle_deg in (2.0, 8.0, 14.0, 6.0):
        follow_turns(turns, angle_deg, 4.0)
    assert (turns.count, turns.latest[0].dps, turns.seconds, turns.angle_deg) == (1, 2.0, 4.0, 6.0)
    forget_turns(turns)
    assert (turns.count, turns.seconds, turns.angle_deg) == (0, 0.0, 0.0)


def test_what_turns_to_and_fro_about_a_bias_speaks_for_it() -> None:
    """A true bias gains on one that makes everything a turn to one side, and no more than even odds of that allow."""
    s = RestlevelState()
    s.turns = observed([0.1, -0.1] * 16)
    s.hypotheses[0] = Hypothesis(weight=0.1, bias_var=1e-6)
    s.hypotheses[1] = Hypothesis(weight=0.9, bias_dps=3.0, bias_var=1e-6)
    weigh_turns(s)
    gain = s.hypotheses[0].weight / s.hypotheses[1].weight * 9.0
    most = 1.0 + 1.0 / (np.sqrt(2.0 * np.pi) * 0.05) / 0.03
    assert 50.0 < gain < most
    weigh_turns(s)  # the same rates are no news
    assert s.hypotheses[0].weight / s.hypotheses[1].weight * 9.0 == pytest.approx(gain)


def confirmed_and_seen(rate_dps: Floats) -> tuple[int, int]:
    """Constant-rate segments that were confirmed, and mean turns that were seen, at 100 Hz."""
    c, s = coefficients(RestlevelParams()), RestlevelState()
    confirmed = before = 0
    for n, dps in enumerate(rate_dps.tolist()):
        step(c, s, n / 100.0, dps)
        confirmed += s.segment.blocks == 5 != before
        before = s.segment.blocks
    return confirmed, s.turns.count


def test_a_gentle_curve_is_one_turn_however_many_segments_it_falls_into() -> None:
    """Ten levels, 0.08 deg/s apart, are a few turns, as chance makes some steps abrupt; with jolts they are ten."""
    t_s = np.arange(0.0, 40.0, 0.01)
    rate_dps = 3.0 + 0.08 * np.floor(t_s / 4.0) + np.random.default_rng(4).normal(0.0, 0.03, len(t_s))
    confirmed, turns = confirmed_and_seen(rate_dps)
    assert confirmed == 10
    assert turns < 7
    jolts_dps = np.where(t_s % 4.0 < 0.3, 20.0, 0.0)
    assert confirmed_and_seen(rate_dps + jolts_dps) == (10, 11)


def test_too_few_say_nothing() -> None:
    s = RestlevelState()
    s.turns = observed([5.0] * 4)
    s.hypotheses[0], s.hypotheses[1] = Hypothesis(weight=0.25), Hypothesis(weight=0.75, bias_dps=5.0)
    weigh_turns(s)
    assert [h.weight for h in s.hypotheses[:2]] == [0.25, 0.75]
