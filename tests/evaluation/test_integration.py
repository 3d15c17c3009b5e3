"""Plain integration and start calibration on rates with a known angle."""

from math import inf

import numpy as np

from gyrodrift.evaluation.integration import start_calibrated, trapezium


def test_the_angle_is_the_sum_of_mean_rates_times_steps() -> None:
    assert trapezium(np.array([0.0, 0.5, 2.0]), np.array([9.0, 1.0, -2.0])).tolist() == [0.0, 2.5, 1.5]


def test_a_step_before_the_first_sample_does_not_count() -> None:
    """Yaw is 0 at the first sample."""
    assert trapezium(np.array([7.0, 1.0]), np.array([3.0, 3.0])).tolist() == [0.0, 3.0]


def test_an_angle_that_overflows_is_infinite() -> None:
    assert trapezium(np.array([0.0, 1e10, 1e10]), np.array([0.0, 1e300, -1e300])).tolist()[1] == inf


def test_rates_are_not_changed() -> None:
    t_s, rate_dps = np.arange(500) / 100.0, np.full(500, 2.0)
    trapezium(np.diff(t_s, prepend=0.0), rate_dps)
    start_calibrated(t_s, rate_dps)
    assert (rate_dps == 2.0).all()


def test_a_start_calibration_leaves_no_angle_of_a_constant_rate() -> None:
    t_s = np.arange(500) / 100.0
    assert np.abs(start_calibrated(t_s, np.full(500, 2.0))).max() < 1e-12
