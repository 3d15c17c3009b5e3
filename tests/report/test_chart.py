"""Charts as data: scales that hold what they show, few digits, and lines that keep peaks."""

import json
from math import inf, nan

import numpy as np
import pytest
from page_support import drawn, series_of

from gyrodrift.report.chart import (
    LINE_PARTS,
    AxisScale,
    Chart,
    ChartSeries,
    Part,
    ScaleKind,
    Shape,
    error_scale,
    line,
    log_scale,
    scale_of,
    thinned,
)

X = np.linspace(0.0, 10.0, 50)


def chart_of(*series: ChartSeries, kind: ScaleKind = ScaleKind.LINEAR) -> Chart:
    return Chart("says", AxisScale("time, s", 0.0, 10.0), [Part(AxisScale("yaw, deg", 1e-4, 100.0, kind), series)])


def test_equal_coordinates_are_stated_once() -> None:
    """Three curves over the same times have four arrays."""
    chart = json.loads(
        chart_of(ChartSeries(X, X, "plain"), ChartSeries(X, 2.0 * X, "tuned"), ChartSeries(X, 3.0 * X, "two")).json()
    )
    assert len(chart["arrays"]) == 4
    assert [sery["x"] for sery in chart["parts"][0]["series"]] == [0, 0, 0]


def test_numbers_have_the_digits_that_a_scale_can_show() -> None:
    """Decimals on a linear scale, significant digits on a logarithmic one; what is no number is null."""
    y = np.array([123.456789, 0.000123456789, -0.0, nan, inf])
    (linear,) = series_of(drawn(chart_of(ChartSeries(np.arange(5.0), y, "ink"))))
    assert linear["y"] == [123.457, 0, 0, None, None]
    (factors,) = series_of(drawn(chart_of(ChartSeries(np.arange(5.0), y, "ink"), kind=ScaleKind.LOG)))
    assert factors["y"] == [123.46, 0.00012346, 0, None, None]


def test_a_line_across_the_chart_ends_at_its_edges() -> None:
    level, upright = series_of(drawn(chart_of(line(y=1.0, color="quiet"), line(x=5.0, color="ink", dash="dotted"))))
    assert (level["x"], level["xEnd"], level["y"], level["yEnd"]) == ([None], [None], [1], [1])
    assert (upright["x"], upright["xEnd"], upright["y"], upright["yEnd"]) == ([5], [5], [None], [None])
    assert (level["shape"], upright["dash"]) == (Shape.STROKES, "dotted")


def test_a_scale_holds_all_finite_values() -> None:
    assert scale_of("", [np.array([0.0, nan, 10.0]), np.array([inf])]) == AxisScale("", -0.5, 10.5)
    wide = scale_of("", [np.array([1.0, 1.1])], 2.0)
    assert (wide.low, wide.high) == pytest.approx((0.05, 2.05))
    assert json.loads(chart_of(ChartSeries(X, X * 1.7e307, "ink")).json())["arrays"][1][:2] == [0, None]
    assert np.isfinite(scale_of("", [np.array([-1.7e308, 1.7e308])]).high)
    for nothing in ([], [np.array([nan])]):
        assert scale_of("", nothing) == AxisScale("", -0.5, 0.5)


def test_a_scale_of_factors_is_at_least_so_long() -> None:
    scale = log_scale("", [np.array([0.0, -1.0, 1.0, nan])], 100.0)
    assert (scale.low, scale.high) == pytest.approx((0.1, 10.0))
    assert log_scale("", [np.zeros(3)], 10.0).low > 0.0


def test_a_scale_of_errors_has_its_linear_part() -> None:
    assert error_scale("", [np.array([0.1, nan])]) == AxisScale("", -1.3, 1.3, ScaleKind.SYMLOG)
    assert error_scale("", [np.array([-100.0])]).low == -130.0


def test_thinning_a_curve_keeps_its_peaks_and_ends() -> None:
    x, y = np.arange(100_000.0), np.zeros(100_000)
    y[[12_345, 99_999]] = 7.0, -5.0
    y[50_000:60_000] = nan
    thin_x, thin_y = thinned(x, y)
    assert len(thin_x) <= 2 * LINE_PARTS + 2
    assert (np.nanmax(thin_y), np.nanmin(thin_y)) == (7.0, -5.0)
    assert (thin_x[0], thin_x[-1]) == (0.0, 99_999.0)
    assert np.isnan(thin_y[(thin_x > 50_500) & (thin_x < 59_500)]).all()
    assert np.all(np.diff(thin_x) > 0.0)
    np.testing.assert_array_equal(thinned(x, 2.0 * y)[0], thin_x)
