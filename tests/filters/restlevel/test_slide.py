"""Slide of a rest, and its safe bias after a gradual end: on numbers worked out by hand, and in a drive."""

from collections.abc import Sequence

import numpy as np
import pytest

from gyrodrift.filters.restlevel.bias_state import Hypothesis
from gyrodrift.filters.restlevel.model import RestlevelParams, RestlevelState
from gyrodrift.filters.restlevel.slide import follow_slide, mark_safe, restore_safe_bias, undo_safe_bias
from gyrodrift.filters.restlevel.step import coefficients, step

C = coefficients(RestlevelParams(drift_dps_s=0.004))
MARK_S = 4.0


def rest_of(biases_dps: Sequence[float], sigma_dps: float = 1e-6) -> Hypothesis:
    """A rest with these biases, four seconds apart; its variance grows with its number."""
    h = Hypothesis(weight=1.0, knows_bias=True, is_at_rest=True, bias_dps=biases_dps[0], bias_var=sigma_dps**2)
    mark_safe(h)
    for number, dps in enumerate(biases_dps[1:], 2):
        h.bias_dps, h.bias_var = dps, number * sigma_dps**2
        follow_slide(C.rate_ramp_dps_s, h, MARK_S)
    return h


@pytest.mark.parametrize(
    ("biases_dps", "since"),
    [
        ((0.1, 0.1, 0.1, 0.1), 2),  # flat: four seconds ago
        ((0.1, 0.1, 0.1, 0.11, 0.12, 0.13), 2),  # it slides since the third
        ((0.1, 0.1, 0.1, 0.09, 0.08, 0.07), 2),
        ((0.1, 0.1, 0.1, 0.103, 0.106, 0.109), 4),  # by less than a quarter of what drift allows
        ((0.1, 0.11, 0.12, 0.13, 0.14), 3),  # a warm-up slides from the first second on
        ((0.1, 0.1, 0.11, 0.12, 0.09), 3),  # to the other side
        ((0.1, 0.1, *(0.1 + 0.01 * k for k in range(1, 13))), 10),  # for longer than bends last, and once more since
    ],
)
def test_a_slide_begins_where_the_rest_was_flat_last(biases_dps: Sequence[float], since: int) -> None:
    """The safe bias is the bias before the slide, or the bias of four seconds ago."""
    h = rest_of(biases_dps)
    assert h.safe.bias_dps == biases_dps[since]
    assert h.safe.bias_var == (since + 1) * 1e-12
    assert h.safe.ago_s == pytest.approx(MARK_S * (len(biases_dps) - 1 - since))


def test_a_first_step_within_the_uncertainty_is_no_slide() -> None:
    """A step of 0.009 deg/s of a bias that is known to 0.006 is flat, so that what follows is a slide."""
    assert rest_of((0.1, 0.109, 0.13, 0.15, 0.17), sigma_dps=0.006).safe.bias_dps == 0.109
    assert rest_of((0.1, 0.109, 0.13, 0.15, 0.17), sigma_dps=0.004).safe.bias_dps == 0.15


def test_undoing_the_safe_bias_also_turns_yaw() -> None:
    """The bias is 0.3 deg/s, and 0.1 was safe eight seconds ago. Three seconds later yaw is off by 0.6 deg."""
    h = rest_of((0.1, 0.1, 0.1, 0.2, 0.3))
    h.moving_s, h.yaw_deg = 0.0, 5.0
    restore_safe_bias(h)
    assert (h.bias_dps, h.bias_var, h.moving_s) == (0.1, 3e-12, 8.0)
    h.yaw_deg -= h.bias_dps * 3.0
    h.moving_s += 3.0
    undo_safe_bias(h)
    assert (h.bias_dps, h.bias_var) == (0.3, 5e-12)
    assert h.moving_s == pytest.approx(3.0)
    assert h.yaw_deg == pytest.approx(5.0 - 0.3 * 3.0)


def test_yaw_has_turned_with_the_safe_bias_since_the_end_of_the_rest() -> None:
    """The bias is 0.3 deg/s, 0.1 is safe, and the rest ended a second ago: yaw has turned by -0.1 deg, not -0.3."""
    h = rest_of((0.1, 0.1, 0.1, 0.2, 0.3))
    h.moving_s, h.yaw_deg = 1.0, 5.0 - 0.3
    restore_safe_bias(h)
    assert h.yaw_deg == pytest.approx(5.0 - 0.1)
    undo_safe_bias(h)
    assert h.yaw_deg == pytest.approx(5.0 - 0.3)
    assert h.moving_s == pytest.approx(1.0)


def test_a_rest_that_goes_on_from_the_block_that_ended_it_has_the_yaw_of_its_end() -> None:
    """The segment began before the bias was exchanged, so its yaw has turned with neither bias."""
    h = rest_of((0.1, 0.1, 0.1, 0.2, 0.3))
    h.checkpoint.yaw_deg, h.checkpoint.moving_s = 5.0, 0.0
    h.yaw_deg, h.moving_s = 4.7, 1.0
    restore_safe_bias(h)
    h.yaw_deg, h.moving_s = h.checkpoint.yaw_deg, h.checkpoint.moving_s
    undo_safe_bias(h)
    assert (h.yaw_deg, h.moving_s) == (5.0, 0.0)


def test_a_gentle_slide_behind_a_rest_is_a_curve() -> None:
    """Ten seconds at rest, half a minute into a curve by 0.004 deg/s², and on: the bias is that of the rest."""
    true_dps = np.r_[np.zeros(1000), 0.004 * np.arange(3000) / 100.0, 0.12 + 0.1 * np.arange(1, 2000) / 100.0]
    rates_dps = 0.2 + true_dps + 0.07 * np.random.default_rng(20261123).standard_normal(len(true_dps))
    s = RestlevelState()
    for n, dps in enumerate(rates_dps.tolist()):
        step(C, s, n / 100.0, dps)
    assert s.bias_dps == pytest.approx(0.2, abs=0.02)
