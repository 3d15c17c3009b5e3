"""Yaw of a session, raw and corrected, against an encoder."""

import numpy as np
from support import near

from gyrodrift.describe.yaw import mean_absolute, yaw_history_of
from gyrodrift.filters.registry import FILTERS
from gyrodrift.filters.run import FilterRun
from gyrodrift.session.session import Session

RESTLEVEL = FILTERS["restlevel"]
BIAS_DPS = 0.5


def turned(encoder_deg: np.ndarray | None = None) -> Session:
    """A minute of rest under a bias, then a minute of turning at 10 deg/s."""
    rate_dps = np.repeat([0.0, 10.0], 6000)
    noise_dps = np.random.default_rng(1).normal(0.0, 0.02, len(rate_dps))
    return Session(
        "s", 50.0 + np.arange(len(rate_dps)) / 100.0, rate_dps + BIAS_DPS + noise_dps, None, None, encoder_deg
    )


def encoder_of(turn_deg: float) -> np.ndarray:
    return np.concatenate([np.full(6000, turn_deg), turn_deg + np.arange(6000) / 10.0])


def test_both_errors_are_those_against_the_encoder() -> None:
    """Raw yaw runs away with the bias; corrected yaw stays."""
    yaw = yaw_history_of(turned(encoder_of(77.0)), FilterRun(RESTLEVEL, RESTLEVEL.params()))
    assert yaw is not None
    assert yaw.has_reference
    assert yaw.raw_error_deg[-1] == near(0.5 * 120.0, 0.5)
    assert mean_absolute(yaw.raw_error_deg) == near(30.0, 0.5)
    assert mean_absolute(yaw.corrected_error_deg) < 0.5
    assert yaw.t_s[0] == 0.0
    assert yaw.bias_dps[5000] == near(BIAS_DPS, 0.01)


def test_raw_yaw_of_a_constant_acceleration_is_exact() -> None:
    t_s = np.arange(100) / 100.0
    yaw = yaw_history_of(Session("s", t_s, 200.0 * t_s), FilterRun(RESTLEVEL, RESTLEVEL.params()))
    assert yaw is not None
    assert np.abs(yaw.raw_deg - 100.0 * t_s**2).max() < 1e-9


def test_errors_begin_where_the_encoder_does() -> None:
    encoder_deg = encoder_of(0.0)
    encoder_deg[:3000] = np.nan
    yaw = yaw_history_of(turned(encoder_deg), FilterRun(RESTLEVEL, RESTLEVEL.params()))
    assert yaw is not None
    assert np.isnan(yaw.raw_error_deg[:3000]).all()
    assert yaw.raw_error_deg[3000] == 0.0
    assert yaw.raw_error_deg[-1] == near(0.5 * 90.0, 0.5)


def test_without_an_encoder_there_is_no_error() -> None:
    yaw = yaw_history_of(turned(), FilterRun(RESTLEVEL, RESTLEVEL.params()))
    assert yaw is not None
    assert not yaw.has_reference
    item = Session("s", np.array([1.0, 1.0, np.nan]), np.zeros(3))
    assert yaw_history_of(item, FilterRun(RESTLEVEL, RESTLEVEL.params())) is None
