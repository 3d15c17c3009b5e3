"""Noise in the units of data sheets."""

from math import log, pi, sqrt

from gyrodrift.values.noise import FLICKER_FLOOR, hourly_rate_text, random_walk_text


def test_noise_stands_in_the_units_of_data_sheets() -> None:
    """An hour has 3600 s, its root 60."""
    assert random_walk_text(0.005) == "0.3 °/√h (0.005 deg/√s)"
    assert hourly_rate_text(0.005) == "18 °/h (0.005 deg/s)"
    assert hourly_rate_text(-0.561) == "-2,020 °/h (-0.561 deg/s)"


def test_the_floor_of_flicker_noise_is_the_published_factor() -> None:
    """IEEE Std 952-1997 rounds √(2 ln 2/π) to three digits."""
    assert round(sqrt(2.0 * log(2.0) / pi), 3) == FLICKER_FLOOR
