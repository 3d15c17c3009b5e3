"""Charts of a tuning: costs, places of the search, and scales that show errors."""

from dataclasses import replace
from math import inf

import numpy as np
import pytest
from tuning_support import curve, curve_of, run, tuning_of_both

from gyrodrift.evaluation.space import axes_of, linear
from gyrodrift.filters.hdr_filter import HDR
from gyrodrift.tune.report import charts

AXES = axes_of(HDR)


def test_the_best_so_far_falls_to_the_least() -> None:
    """Infinite costs before the first finite one are passed by."""
    x, y = charts.best_so_far(replace(run(), history=np.array([inf, 9.0, 9.5, 4.0, inf, 5.0])))
    np.testing.assert_array_equal(x[np.isfinite(y)], [2.0, 4.0, 6.0])
    np.testing.assert_array_equal(y[np.isfinite(y)], [9.0, 4.0, 4.0])


def test_where_the_search_looked_has_the_mean_one() -> None:
    at_random = replace(run(evaluations=30_000), densities=None)
    _, height = charts.preference(at_random, 3, AXES[3])
    assert height.mean() == pytest.approx(1.0)
    assert np.abs(height - 1.0).max() < 0.4


def test_errors_are_enlarged_only_where_that_shows_more() -> None:
    """A tuned filter as bad as plain integration needs one scale; a single bad session does not spoil it."""
    good, bad = curve(), curve_of(112.0, 112.0)
    assert charts.error_scales([good]).zoom_deg == pytest.approx(0.55, rel=0.01)
    assert charts.error_scales([bad]).zoom_deg is None
    assert charts.error_scales([good, good, bad]).zoom_deg == pytest.approx(2.2, rel=0.01)


def test_the_slice_of_a_linear_search_has_the_values_of_its_own_axis() -> None:
    """CARLA searches linear axes; its slices are over factors."""
    searched = replace(tuning_of_both(), axes=linear(AXES))
    values, costs = charts.slice_curve(searched, 0)
    assert values == pytest.approx(np.geomspace(AXES[0].low, AXES[0].high, len(values)))
    assert costs.tolist() == searched.slices[0].tolist()
