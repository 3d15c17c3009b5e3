"""The rate of a device that sends an angle."""

from math import isnan

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gyrodrift.link.clocks.clock import TurningRate


def test_the_rate_is_how_far_the_angle_went_since_the_time_before() -> None:
    turning = TurningRate()
    assert isnan(turning.rate_dps(0.0, 10.0))
    assert turning.rate_dps(0.5, 15.0) == 10.0


@pytest.mark.parametrize(
    ("before", "after", "turned"), [(179.0, -179.0, 2.0), (359.0, 1.0, 2.0), (-179.5, 179.5, -1.0)]
)
def test_an_angle_wraps_at_any_place(before: float, after: float, turned: float) -> None:
    turning = TurningRate()
    turning.rate_dps(0.0, before)
    assert turning.rate_dps(1.0, after) == pytest.approx(turned)


def test_a_repeated_time_gives_no_rate_and_loses_no_angle() -> None:
    turning = TurningRate()
    turning.rate_dps(0.0, 0.0)
    assert isnan(turning.rate_dps(0.0, 1.0))
    assert turning.rate_dps(0.1, 2.0) == pytest.approx(20.0)


def test_an_angle_that_is_set_anew_and_a_clock_that_begins_anew_are_no_turn() -> None:
    turning = TurningRate()
    turning.rate_dps(0.0, 0.0)
    assert isnan(turning.rate_dps(0.01, 120.0))
    assert turning.rate_dps(0.02, 120.1) == pytest.approx(10.0)
    turning.forget()
    assert isnan(turning.rate_dps(0.03, 0.0))


@given(st.lists(st.floats(-170.0, 170.0), min_size=2, max_size=50), st.sampled_from([-180.0, 0.0]))
def test_the_rates_add_up_to_the_angle(turns: list[float], least: float) -> None:
    turning, angle_deg, total_deg = TurningRate(), 0.0, 0.0
    turning.rate_dps(0.0, angle_deg)
    for second, turn in enumerate(turns, 1):
        angle_deg += turn
        total_deg += turning.rate_dps(float(second), (angle_deg - least) % 360.0 + least)
    assert total_deg == pytest.approx(angle_deg, abs=1e-6)
