"""The encoder: angles to counts."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_sim import encoder
from firmware_sim.rig import ENCODER_CPR_MOST

cprs = st.integers(1, ENCODER_CPR_MOST)


@given(st.floats(-1e6, 1e6), cprs)
def test_a_count_is_never_a_whole_count_off(angle_deg: float, cpr: int) -> None:
    """Counts times 360 over the counts of a turn is the angle, to the resolution of the encoder."""
    (count,) = encoder.counts(np.array([angle_deg]), cpr).tolist()
    assert abs(count - angle_deg / 360.0 * cpr) < 1.0


@given(st.integers(-1000, 1000), cprs)
def test_whole_turns_are_whole_turns_of_counts(turns: int, cpr: int) -> None:
    """The angle is unwrapped: the tenth turn has ten times the counts of one."""
    assert encoder.counts(np.array([turns * 360.0]), cpr).tolist() == [turns * cpr]


@given(st.lists(st.floats(-1e5, 1e5), min_size=2, max_size=20), cprs)
def test_counts_rise_with_the_angle(angles_deg: list[float], cpr: int) -> None:
    """Turning counter-clockwise never counts down."""
    assert (np.diff(encoder.counts(np.sort(np.array(angles_deg)), cpr)) >= 0).all()


@pytest.mark.parametrize("angle_deg", [-720.0, 0.0, 123.4])
def test_a_rig_without_encoder_counts_nothing(angle_deg: float) -> None:
    """Zero counts per turn are zeros at every angle."""
    assert encoder.counts(np.full(3, angle_deg), 0).tolist() == [0, 0, 0]


def test_every_count_is_as_wide_as_the_others() -> None:
    """There is no wider step at zero, as rounding towards zero would make one."""
    counts = encoder.counts(np.arange(-3600, 3600) / 10.0 + 0.05, 360)
    _, widths = np.unique(counts, return_counts=True)
    assert set(widths[1:-1].tolist()) == {10}
