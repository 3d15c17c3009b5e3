"""A recording as a device would speak it, whatever stands in it."""

from math import inf, nan

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_sim.wire.registry import ENCODERS
from gyrodrift.session.session import Session
from gyrodrift.simulation.replay import PlayedSession, base_of
from gyrodrift.values.errors import DataError

any_floats = st.lists(st.floats(width=64), min_size=6, max_size=6)


@given(any_floats, any_floats, any_floats, any_floats)
def test_any_numbers_are_played_as_far_as_a_device_can_say_them(
    times: list[float], rates: list[float], angles: list[float], temps: list[float]
) -> None:
    t_s, rate_dps, encoder_deg, temp_c = map(np.array, (times, rates, angles, temps))
    session = Session("s", t_s, rate_dps, encoder_deg=encoder_deg, temp_c=temp_c)
    if not any(abs(t_s) < 1e12 for t_s in times):
        with pytest.raises(DataError, match="no sample has a possible device time"):
            PlayedSession(session, is_looping=False)
        return
    recording = PlayedSession(session, is_looping=False)
    base = base_of(recording, 0.01)
    for encoder in ENCODERS.values():
        assert sum(frame.rows for frame in encoder.recorded(recording, base)) <= 6


def test_samples_without_a_time_are_holes() -> None:
    session = Session("s", np.array([nan, 1.0, 1e300, 1.2, 1.3, inf]), np.arange(6.0))
    played = list(PlayedSession(session, is_looping=False))
    assert [(m.t_us, m.rate_dps) for m in played] == [(1_000_000, 1.0), (1_200_000, 3.0), (1_300_000, 4.0)]
    assert [round(m.due_s, 6) for m in played] == [0.0, 0.2, 0.3]
