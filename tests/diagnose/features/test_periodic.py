"""Periodic components over time and angle, of sines of known size."""

import numpy as np
import pytest
from features_support import SECONDS, TRUE_DEG, TRUE_DPS, observed, white

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features.wander import angle_periodic_component, angle_shares, periodic_component

S: Floats = np.arange(400.0) + 0.5


def test_a_sine_is_found_with_its_period() -> None:
    """Alone it takes all: ln(1.02 / 0.02) is the most there is."""
    # It lies evenly about the middle, so that it has no trend.
    log_ratio, period_s = periodic_component(0.1 * np.cos(2.0 * np.pi * (S - 200.0) / 80.0))
    assert period_s == pytest.approx(80.0, rel=0.03)
    assert log_ratio == pytest.approx(np.log(1.02 / 0.02), abs=0.3)


def test_a_sine_in_as_much_noise_takes_half() -> None:
    """Means of 5 s scatter by as much as the sine: the logarithm of the ratio is 0."""
    found = [
        periodic_component(0.2 * np.sin(2.0 * np.pi * S / 100.0) + white(np.sqrt(5.0 * 0.02), seed, 400))[0]
        for seed in range(20)
    ]
    assert np.mean(found) == pytest.approx(0.0, abs=0.25)


def test_a_trend_is_no_period() -> None:
    """It is taken out before."""
    assert periodic_component(0.01 * S)[0] == pytest.approx(np.log(0.02 / 1.02), abs=1e-6)


@pytest.mark.parametrize("values", [np.zeros(0), np.ones(1), np.ones(300)])
def test_nothing_has_no_period(values: Floats) -> None:
    """Empty, one block, and constant give numbers."""
    assert periodic_component(values)[0] <= 0.0


def test_a_sine_of_the_angle_is_found_in_its_order() -> None:
    """Five times per turn: the third of the six pairs from three on takes nearly all."""
    design = observed(TRUE_DPS).design
    error = (0.2 * np.sin(5.0 * np.deg2rad(TRUE_DEG))).reshape(SECONDS, 100).mean(axis=1)
    pairs = angle_shares(error, design.turn_basis).reshape(-1, 2).sum(axis=1)
    assert int(np.argmax(pairs)) == 5 - 3
    assert pairs.sum() == pytest.approx(1.0, abs=0.05)


def test_chance_gives_each_vector_its_share() -> None:
    """Of white noise each takes as much as each other dimension: ln(1 + 1)."""
    vectors = observed(TRUE_DPS).design.turn_basis
    found = [angle_periodic_component(white(0.3, seed, SECONDS), vectors) for seed in range(100)]
    assert np.mean(found) == pytest.approx(np.log(2.0), abs=0.08)


def test_no_error_has_no_component_of_the_angle() -> None:
    """Zeros give a zero."""
    assert angle_periodic_component(np.zeros(SECONDS), observed(TRUE_DPS).design.turn_basis) == 0.0
