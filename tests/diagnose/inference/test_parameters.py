"""Units of parameters."""

import pytest

from gyrodrift.diagnose.inference.parameters import unit_of


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
