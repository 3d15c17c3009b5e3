"""Warnings of a tuning, and silence without a reason for one."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from gyrodrift.evaluation.space import axes_of
from gyrodrift.filters.hdr import HdrParams
from gyrodrift.filters.hdr_filter import HDR
from gyrodrift.tune.result import Pi
from gyrodrift.tune.warnings import (
    bound_of,
    bound_warnings,
    held_out_warnings,
    identifiability_warnings,
    slice_candidates,
)
from gyrodrift.values.arrays import Floats

AXES = axes_of(HDR)

INSIDE = HdrParams(i_c_dps=1e-3, tau_s=0.1, theta_w_dps=0.5, c1=1.0, c2=1.0)


def bowl(*decided: int) -> Callable[[Floats], Floats]:
    """A cost that these parameters decide, least at `INSIDE`."""

    def pi(params: Floats) -> Floats:
        best = np.array([INSIDE.i_c_dps, INSIDE.tau_s, INSIDE.theta_w_dps, INSIDE.c1, INSIDE.c2])
        away = np.log((params + 0.1 * best) / (1.1 * best))[:, list(decided)]
        cost: Floats = 1.0 + np.sum(away**2, axis=1)
        return cost

    return pi


def test_a_value_at_an_end_of_its_range_is_told() -> None:
    assert [bound_of(AXES[3], value) for value in (0.0, 0.02, 1.0, 2.99, 9.0)] == [
        "lower",
        "lower",
        "",
        "upper",
        "upper",
    ]
    assert [bound_of(AXES[0], value) for value in (1e-6, 1e-5, 0.1)] == ["lower", "", "upper"]


def test_a_parameter_at_a_bound_is_told_with_what_to_do() -> None:
    """Wider by --range, unless the filter itself ends there."""
    statement = list(bound_warnings(HDR, AXES, replace(INSIDE, i_c_dps=0.1, c2=0.0)))
    assert statement == [
        "i_c_dps is at the upper end of its range, 0.1; widen it with --range",
        "c2 is at the lower end of its range, 0, which is a bound of the filter",
    ]
    assert not list(bound_warnings(HDR, AXES, INSIDE))


def test_a_parameter_that_changes_nothing_is_told() -> None:
    rows = slice_candidates(HDR, AXES, INSIDE)
    assert not list(identifiability_warnings(HDR, AXES, bowl(0, 1, 2, 3, 4)(rows).reshape(len(AXES), -1)))
    (statement,) = identifiability_warnings(HDR, AXES, bowl(0, 1, 3, 4)(rows).reshape(len(AXES), -1))
    expected = "theta_w_dps is not determined by these sessions: from 0.02 to 20 the cost is within 2% of its minimum"
    assert statement.startswith(expected)
    assert statement.endswith("it needs motion at all rates, slow turns too")


@pytest.mark.parametrize(
    ("tuned", "plain", "words"),
    [
        (Pi(1.0, 1.0), Pi(100.0, 100.0), ""),
        (Pi(1.0, None), Pi(100.0, None), ""),
        (Pi(1.0, 3.9), Pi(100.0, 100.0), ""),
        (Pi(1.0, 4.1), Pi(100.0, 100.0), "held-out sessions are much worse than training sessions, 2.02 against 1"),
        (Pi(1.0, 4.1), Pi(100.0, 200.0), ""),
        (Pi(1.0, 101.0), Pi(100.0, 100.0), "the tuned filter is worse than plain integration: do not use it"),
    ],
)
def test_a_test_that_goes_badly_is_told(tuned: Pi, plain: Pi, words: str) -> None:
    statement = list(held_out_warnings(tuned, plain))
    assert len(statement) == bool(words)
    assert words in "".join(statement)
