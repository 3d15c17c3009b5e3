"""The longest motion between two rests."""

import numpy as np

from gyrodrift.evaluation.dataset import longest_motion_s


def test_the_longest_motion_is_measured_between_rests() -> None:
    """Five seconds of turning, a rest, then twelve seconds of turning."""
    t_s = np.arange(0.0, 40.0, 0.01)
    rate_dps = np.where((t_s >= 4.0) & (t_s < 9.0), 30.0, np.where((t_s >= 20.0) & (t_s < 32.0), -20.0, 0.0))
    reference_deg = np.cumsum(rate_dps) * 0.01
    assert abs(longest_motion_s(t_s, reference_deg) - 12.0) <= 1.0
    assert longest_motion_s(t_s, np.zeros_like(t_s)) == 0.0


def test_samples_without_a_reference_do_not_end_a_motion() -> None:
    """Every other sample has no angle."""
    t_s = np.arange(0.0, 20.0, 0.01)
    reference_deg = 10.0 * t_s
    reference_deg[1::2] = np.nan
    assert abs(longest_motion_s(t_s, reference_deg) - 20.0) <= 1.0
    assert longest_motion_s(t_s, np.full_like(t_s, np.nan)) == 0.0


def test_a_jump_of_the_clock_by_years_costs_no_memory() -> None:
    t_s = np.concatenate((np.arange(0.0, 5.0, 0.01), 1e12 + np.arange(0.0, 5.0, 0.01)))
    assert longest_motion_s(t_s, np.zeros_like(t_s)) == 0.0
