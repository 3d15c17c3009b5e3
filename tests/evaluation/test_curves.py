"""Curves of a session for figures."""

import numpy as np

from gyrodrift.evaluation.dataset import LoadedSession, SessionSummary, yaw_curves
from gyrodrift.evaluation.reference import timed_reference_of
from gyrodrift.session.session import Session


def loaded() -> LoadedSession:
    """A turn of 2 deg/s that begins 100 s after power-on, with a missing encoder value at the second minute."""
    t_s = np.linspace(100.0, 340.0, 5)
    encoder_deg = np.linspace(10.0, 490.0, 5)
    encoder_deg[2] = np.nan
    times_s, reference = timed_reference_of(Session("turn", t_s, np.full(5, 2.0), encoder_deg=encoder_deg))
    return LoadedSession(reference, SessionSummary("turn", "", 4.0, 1.0 / 60.0), times_s)


def test_curves_have_the_samples_with_a_reference() -> None:
    """Minutes count from the first sample; errors are yaw minus reference."""
    yaws_deg = [np.array([0.0, 121.0, 242.0, 363.0, 484.0]), np.array([0.0, 120.0, 240.0, 360.0, 480.0])]
    curves = yaw_curves(loaded(), yaws_deg, 100)
    assert curves.minutes.tolist() == [0.0, 1.0, 3.0, 4.0]
    assert curves.reference_deg.tolist() == [0.0, 120.0, 360.0, 480.0]
    assert curves.errors_deg.tolist() == [[0.0, 1.0, 3.0, 4.0], [0.0, 0.0, 0.0, 0.0]]


def test_thinned_curves_keep_the_first_and_the_last_sample() -> None:
    curves = yaw_curves(loaded(), [np.zeros(5)], 2)
    assert curves.minutes.tolist() == [0.0, 4.0]
