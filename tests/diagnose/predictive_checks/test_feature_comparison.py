"""Features of recordings beside what a simulator expects of them, in units that a person knows."""

import numpy as np
import pytest
from diagnosis_support import SECONDS, design
from gyrodrift.diagnose.inference.surrogate import Cause, Surrogate
from inference_support import SESSIONS, evidence, response, rows

from gyrodrift.diagnose.features.vector import NUMBER
from gyrodrift.diagnose.predictive_checks.feature_comparison import FeatureComparison, feature_comparisons_of

RATE = response("scale_factor", {"rate": 2.0})
ROOT = np.sqrt(SECONDS)
"""A coefficient on an orthonormal basis over that, so that it is RMS over a session."""


def compared(name: str, *causes: Cause) -> FeatureComparison:
    """Of sessions whose rate differs by 6 sigmas from a simulator that has 1."""
    difference = rows({"rate": 6.0})
    difference[3, NUMBER["rate"]] = 16.0
    surrogate = Surrogate(evidence(difference, RATE))
    return feature_comparisons_of(surrogate, causes, rows({"rate": 1.0}), [design()] * SESSIONS)[NUMBER[name]]


def test_the_recordings_stand_beside_the_simulator() -> None:
    """What was simulated and the difference, and a band of two standard deviations."""
    found = compared("rate")
    assert found.unit == "deg/s RMS"
    assert found.real == pytest.approx(np.array([7.0, 7.0, 7.0, 17.0]) / ROOT)
    assert found.before.middle == pytest.approx(np.full(SESSIONS, 1.0) / ROOT)
    assert found.before.low == pytest.approx(np.full(SESSIONS, -1.0) / ROOT)
    assert found.before.high == pytest.approx(np.full(SESSIONS, 3.0) / ROOT)
    assert found.z_before == pytest.approx(np.sqrt(3.0 * 36.0 + 256.0) - 2.0)  # as a scatter, 17.08; as a shift, 17


def test_after_is_under_sizes_of_the_other_sessions() -> None:
    """Three say 3, which is also what the fourth is held against; the band is wider by what the model may be off."""
    found = compared("rate", Cause(RATE, 2))
    assert found.after.middle == pytest.approx(np.full(SESSIONS, 7.0) / ROOT)
    wide = np.sqrt(1.0 + 0.6**2 + (0.04 * 6.0) ** 2)
    assert found.after.high == pytest.approx(np.full(SESSIONS, 7.0 + 2.0 * wide) / ROOT)
    assert found.real[3] > found.after.high[3]
    assert abs(found.z_after) < abs(found.z_before)


def test_a_feature_that_no_cause_moves_stays_where_it_is() -> None:
    """Before and after."""
    found = compared("temperature", Cause(RATE, 2))
    assert (found.z_before, found.z_after) == (0.0, 0.0)
    assert found.after.middle == pytest.approx(found.before.middle)
