"""Levels that wander are told from a sensor's noise, and count for less."""

import pytest

from gyrodrift.filters.restlevel.rate_state import RateWander
from gyrodrift.filters.restlevel.wander import count_agreement, count_break, forget_levels, wander_probability


def followed(blocks: int, breaks_every: int, step_dps: float = 0.5) -> RateWander:
    """After so many blocks, of which every so-manieth breaks with the level."""
    wander = RateWander()
    for number in range(1, blocks + 1):
        if number % breaks_every == 0:
            count_break(wander, step_dps)
        else:
            count_agreement(wander)
    return wander


def test_a_sensor_breaks_seldom_and_a_motion_often() -> None:
    assert wander_probability(RateWander()) == pytest.approx(0.1)
    assert wander_probability(followed(100, 50)) < 0.001
    assert wander_probability(followed(100, 5)) > 0.99


def test_a_noise_that_turns_out_smaller_begins_anew() -> None:
    wander = followed(100, 5)
    forget_levels(wander)
    assert wander == RateWander()


def test_the_typical_step_is_found() -> None:
    assert followed(500, 2).step_dps == pytest.approx(0.5, rel=0.15)
