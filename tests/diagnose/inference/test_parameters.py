"""Best sizes between those of the grid, their intervals and units."""

import numpy as np
import pytest
from inference_support import SIZES, response

from gyrodrift.diagnose.inference.alternatives import Alternatives
from gyrodrift.diagnose.inference.exact_sizes import ExactSize
from gyrodrift.diagnose.inference.parameters import best_size, effect_of, parameters_of, unit_of
from gyrodrift.diagnose.inference.surrogate import Cause

GRID = np.geomspace(1.0, 256.0, 9)


@pytest.mark.parametrize("true", [3.0, 4.0, 5.5, 30.0])
def test_a_parabola_over_the_logarithm_has_its_top_where_it_is(true: float) -> None:
    """Between the sizes of a geometric grid."""
    assert best_size(GRID, -((np.log(GRID) - np.log(true)) ** 2)) == pytest.approx(true)


def test_at_an_end_and_across_zero_the_size_of_the_grid_holds() -> None:
    """There is no parabola."""
    assert best_size(GRID, np.arange(9.0)) == 256.0
    assert best_size(GRID, -np.arange(9.0)) == 1.0
    assert best_size(np.array([-2.0, -1.0, 1.0, 2.0]), np.array([0.0, 3.0, 2.0, 0.0])) == -1.0
    assert best_size(GRID, np.zeros(9)) == 1.0
    assert best_size(GRID, np.array([0.0] * 3 + [1.0] * 3 + [0.0] * 3)) == pytest.approx(8.0 * 2.0**0.5)


def test_the_interval_holds_what_scores_less_by_two() -> None:
    """Sizes 4 to 6 of 1 to 8, around 5."""
    profile = -1.5 * (SIZES - 5.0) ** 2
    cause = Cause(response("scale_factor", {"rate": 1.0}), 4)
    (one,) = parameters_of(Alternatives(cause, 1.0, (), profile))
    assert (one.name, one.unit) == ("error_percent", "%")
    assert one.value == pytest.approx(5.0)
    assert (one.low, one.high) == (4.0, 6.0)
    assert effect_of(Alternatives(cause, 1.0, (), profile)).name == "scale_factor"


def test_an_exact_size_is_the_value_and_its_error_is_within_the_interval() -> None:
    """The profile knows no sizes between those of the grid."""
    profile = -50.0 * (SIZES - 5.0) ** 2
    one = Alternatives(Cause(response("scale_factor", {"rate": 1.0}), 4), 1.0, (), profile, ExactSize(5.2, 0.05))
    (found,) = parameters_of(one)
    assert found.value == 5.2
    assert (found.low, found.high) == pytest.approx((5.0, 5.3))
    assert effect_of(one).model_dump()["error_percent"] == 5.2


def test_an_exact_phase_is_the_value_and_its_error_the_interval() -> None:
    """Else it is that of the grid."""
    cause = Cause(response("g_sensitivity", {"rate": 1.0}), 4)
    profile = -50.0 * (SIZES - 5.0) ** 2
    one = Alternatives(cause, 1.0, (), profile, ExactSize(5.2, 0.05, 77.0, 1.5))
    _, phase = parameters_of(one)
    assert (phase.name, phase.value, phase.low, phase.high) == ("phase_deg", 77.0, 74.0, 80.0)
    assert effect_of(one).model_dump() == {"name": "g_sensitivity", "amplitude_dps": 5.2, "phase_deg": 77.0}


@pytest.mark.parametrize(
    ("parameter", "unit"),
    [
        ("error_percent", "%"),
        ("error_percent_fs", "% of full scale"),
        ("slope_dps_per_c", "deg/s/°C"),
        ("slope_percent_per_c", "%/°C"),
        ("bias_dps_at_100_dps", "deg/s at 100 deg/s"),
        ("time_constant_s", "s"),
        ("delay_ms", "ms"),
        ("cpr", "counts per turn"),
        ("gremlins", ""),
    ],
)
def test_units_follow_the_longest_end_of_a_name(parameter: str, unit: str) -> None:
    """A share of full scale is no plain share."""
    assert unit_of(parameter) == unit
