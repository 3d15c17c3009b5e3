"""Yaw of a sensor that hangs: nobody knows when in the meantime the device stopped."""

import pytest

from gyrodrift.filters.restlevel.frozen import widen_yaw
from gyrodrift.filters.restlevel.model import RestlevelState


def test_the_turns_of_a_sensor_that_hangs_add_up() -> None:
    """Two blocks of 3° leave yaw uncertain by 6°, not by the root of the sum of their squares."""
    state = RestlevelState()
    state.noise.is_frozen = True
    first = state.hypotheses[0]
    first.weight, first.yaw_var = 1.0, 0.0
    for _ in range(2):
        state.block.angle_deg = 3.0
        widen_yaw(state, 1.0)
    assert first.yaw_var == pytest.approx(36.0)
