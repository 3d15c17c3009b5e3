"""Features of recordings beside what a simulator expects of them, in units that a person knows."""

from functools import cache

import numpy as np
import pytest
from diagnosis_support import SECONDS, design
from inference_support import SESSIONS, concluded, rows, simulated

from gyrodrift.diagnose.features.vector import NUMBER
from gyrodrift.diagnose.inference.explanation import Explanation
from gyrodrift.diagnose.inference.scorer import CLOSE_TO_IT
from gyrodrift.diagnose.predictive_checks.feature_comparison import FeatureComparison, feature_comparisons_of

ROOT = np.sqrt(SECONDS)
"""A coefficient on an orthonormal basis over that, so that it is RMS over a session."""


@cache
def explained() -> Explanation:
    difference = rows({"rate": 6.0})
    difference[3, NUMBER["rate"]] = 9.0
    return concluded(difference, simulated("scale_factor", {"rate": 2.0})).explanation


def compared(name: str) -> FeatureComparison:
    """With a simulator that has a rate of 1."""
    return feature_comparisons_of(explained(), rows({"rate": 1.0}), [design()] * SESSIONS)[NUMBER[name]]


def test_the_recordings_stand_beside_the_simulator() -> None:
    result = compared("rate")
    assert result.unit == "deg/s RMS"
    assert result.real == pytest.approx(np.array([7.0, 7.0, 7.0, 10.0]) / ROOT)
    assert result.before.middle == pytest.approx(np.full(SESSIONS, 1.0) / ROOT)
    assert result.before.low == pytest.approx(np.full(SESSIONS, -1.0) / ROOT)
    assert result.before.high == pytest.approx(np.full(SESSIONS, 3.0) / ROOT)
    assert result.z_before == pytest.approx(13.5)  # the mean of 6.75, times the root of four sessions


def test_after_is_under_sizes_of_the_other_sessions() -> None:
    """Three say 6, which the last is held against; the band is wider by the error of the form."""
    result = compared("rate")
    assert result.after.middle[3] * ROOT == pytest.approx(7.0, abs=0.15)
    assert np.all(result.after.middle[:3] > result.after.middle[3])
    change = result.after.middle * ROOT - 1.0
    wide = np.sqrt(1.0 + np.square(CLOSE_TO_IT * change))
    assert result.after.high * ROOT == pytest.approx(1.0 + change + 2.0 * wide)
    assert result.real[3] > result.after.high[3]
    assert abs(result.z_after) < abs(result.z_before)


def test_a_feature_that_no_cause_moves_stays_where_it_is() -> None:
    result = compared("temperature")
    assert (result.z_before, result.z_after) == (0.0, 0.0)
    assert result.after.middle == pytest.approx(result.before.middle)
