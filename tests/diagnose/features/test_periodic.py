"""Periodic components over angle, of sines of known size."""

import numpy as np
import pytest
from features_support import SECONDS, TRUE_DEG, TRUE_DPS, observed, white

from gyrodrift.diagnose.features.wander import angle_periodic_component, angle_shares


def test_a_sine_of_the_angle_is_found_in_its_order() -> None:
    """Five times per turn: the third of the six pairs from three on takes nearly all."""
    design = observed(TRUE_DPS).design
    error = (0.2 * np.sin(5.0 * np.deg2rad(TRUE_DEG))).reshape(SECONDS, 100).mean(axis=1)
    pairs = angle_shares(error, design.turn_basis).reshape(-1, 2).sum(axis=1)
    assert int(np.argmax(pairs)) == 5 - 3
    assert pairs.sum() == pytest.approx(1.0, abs=0.05)


def test_chance_gives_each_vector_its_share() -> None:
    vectors = observed(TRUE_DPS).design.turn_basis
    result = [angle_periodic_component(white(0.3, seed, SECONDS), vectors) for seed in range(100)]
    assert np.mean(result) == pytest.approx(np.log(2.0), abs=0.08)


def test_no_error_has_no_component_of_the_angle() -> None:
    assert angle_periodic_component(np.zeros(SECONDS), observed(TRUE_DPS).design.turn_basis) == 0.0
