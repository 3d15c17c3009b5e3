"""Ranges of parameters, and the unit cube."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gyrodrift.evaluation.space import Axis, axes_of, limits, linear, values_of, with_ranges
from gyrodrift.filters.hdr import HdrParams
from gyrodrift.filters.hdr_filter import HDR
from gyrodrift.values.errors import UsageError

AXES = axes_of(HDR)


@pytest.mark.parametrize("axis", AXES, ids=lambda axis: axis.name)
@given(u=st.floats(0, 1))
def test_unit_inverts_values(axis: Axis, u: float) -> None:
    """A position in the unit interval and its value correspond."""
    value = float(axis.values(np.array([u]))[0])
    assert axis.low <= value <= axis.high
    assert axis.unit(value) == pytest.approx(u, abs=1e-9)


def test_the_middle_of_a_logarithmic_axis_is_the_geometric_mean() -> None:
    """The middle of a linear axis is the arithmetic mean."""
    middle = np.array([0.5])
    assert Axis("x", 0.01, 100.0, is_log=True).values(middle) == pytest.approx([1.0])
    assert Axis("x", 0.0, 4.0).values(middle) == pytest.approx([2.0])
    assert not any(axis.is_log for axis in linear(AXES))


def test_a_corner_of_the_cube_gives_parameters() -> None:
    """Every parameter is at the lower end of its range."""
    assert values_of(AXES, np.zeros((2, 5))).tolist() == [[axis.low for axis in AXES]] * 2
    HdrParams(*values_of(AXES, np.ones((1, 5)))[0].tolist())


def test_a_range_is_replaced_by_name() -> None:
    axes = with_ranges(["tau_s=0.5:2", "c1=0:1"], HDR)
    assert [(axis.low, axis.high) for axis in axes[1::2]] == [(0.5, 2.0), (0.0, 1.0)]
    assert axes[0] == AXES[0]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("tau_s=2:0.5", "LOW must be below HIGH"),
        ("tau_s=1:1", "LOW must be below HIGH"),
        ("tau=0:1", "unknown parameter tau; there are i_c_dps, tau_s, theta_w_dps, c1, c2"),
        ("tau_s=fast", "expected NAME=LOW:HIGH"),
        ("tau_s=nan:1", "LOW must be below HIGH"),
        ("tau_s=0:1", "LOW must be above 0"),
        ("c2=0:11", "c2 is at most 10"),
        ("c1=-1:1", "c1 is at least 0"),
    ],
)
def test_an_invalid_range_is_refused(text: str, message: str) -> None:
    with pytest.raises(UsageError, match=message) as caught:
        with_ranges([text], HDR)
    assert text in str(caught.value)


def test_limits_come_from_the_annotations_of_the_filter() -> None:
    """Limits may be inclusive or exclusive."""
    assert limits("c2", HDR) == (0.0, 10.0)
    assert limits("theta_w_dps", HDR) == (0.0, 2000.0)
