"""Tuned parameters whose sigma of yaw does not fit the errors are not written."""

from dataclasses import replace

from tuning_support import alternative

from gyrodrift.filters.restlevel_filter import RESTLEVEL
from gyrodrift.tune.choice import refused_sets
from gyrodrift.tune.result import Alternative, Pi


def ways(default_crps_deg: float, tuned_crps_deg: float) -> list[Alternative]:
    """Restlevel with its defaults at 15.5 deg, and tuned at 3 deg."""
    default = alternative("restlevel", "restlevel, defaults", 15.0, 15.5, RESTLEVEL)
    tuned = replace(alternative("restlevel", "restlevel, tuned", 3.0, 3.0, RESTLEVEL), is_tuned=True)
    return [
        replace(default, crps_deg=Pi(default_crps_deg, default_crps_deg)),
        replace(tuned, crps_deg=Pi(tuned_crps_deg, tuned_crps_deg)),
    ]


def test_a_small_error_with_an_absurd_sigma_is_refused() -> None:
    """The warning has both errors and both CRPS."""
    (warning,) = refused_sets(ways(11.3, 329.0)).values()
    assert warning.endswith("CRPS 329 deg at an error of 3 deg; defaults: CRPS 11.3 deg, error 15.5 deg")


def test_a_sigma_that_is_no_worse_than_that_of_the_defaults_is_written() -> None:
    """A sigma that is better than none is written too."""
    assert not refused_sets(ways(11.3, 11.3))
    assert not refused_sets(ways(0.1, 2.9))
