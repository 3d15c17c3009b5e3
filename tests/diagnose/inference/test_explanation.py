"""Sessions predicted by the other sessions, and effects that may act beside the named ones."""

import numpy as np
import pytest
from inference_support import SESSIONS, concluded, rows, simulated

from gyrodrift.diagnose.features.vector import NUMBER
from gyrodrift.diagnose.inference.explanation import Explanation
from gyrodrift.diagnose.inference.scorer import CLOSE_TO_IT
from gyrodrift.values.arrays import Floats

RATE, CLOCK = NUMBER["rate"], NUMBER["clock_ratio"]
SCALE = simulated("scale_factor", {"rate": 2.0})
DRIFT = simulated("clock_drift", {"clock_ratio": 2.0})


def explained(rates: list[float]) -> Explanation:
    """Sessions whose rate is off by so much; a scale error and nothing else is tried."""
    difference: Floats = rows({"rate": 1.0}, len(rates)) * np.array(rates)[:, None]
    tried = simulated("scale_factor", {"rate": 2.0}, sessions=len(rates))
    return concluded(difference, tried).explanation


def test_a_session_is_predicted_by_the_others() -> None:
    """Three agree, so that the last is left with its difference from them; it pulls the prediction of the others."""
    explanation = explained([6.0, 6.0, 6.0, 9.0])
    assert explanation.named == ("scale_factor",)
    change, variance = explanation.held_out
    assert change[3, RATE] == pytest.approx(6.0, abs=0.15)
    assert (change[:3, RATE] > 6.5).all()
    assert variance[:, RATE] == pytest.approx(np.square(CLOSE_TO_IT * change[:, RATE]))
    expected = (9.0 - change[3, RATE]) / np.sqrt(1.0 + variance[3, RATE])
    assert explanation.held_out_z[3, RATE] == pytest.approx(expected)


def test_a_single_session_is_predicted_by_its_own_size() -> None:
    explanation = explained([12.0])
    assert explanation.named == ("scale_factor",)
    assert explanation.held_out[0][0, RATE] == pytest.approx(12.0, abs=0.2)


def test_without_named_effects_all_is_unexplained() -> None:
    explanation = concluded({"temperature": 12.0}, SCALE).explanation
    assert explanation.named == ()
    assert np.array_equal(explanation.held_out_z, explanation.evidence.z)
    assert not explanation.held_out[0].any()


def test_the_change_of_some_effects_is_that_of_these_alone() -> None:
    explanation = concluded({"rate": 10.0, "clock_ratio": 8.0}, SCALE, DRIFT).explanation
    assert set(explanation.named) == {"scale_factor", "clock_drift"}
    change = explanation.change(["clock_drift"])
    assert change[:, CLOCK] == pytest.approx(np.full(SESSIONS, 8.0), abs=0.15)
    assert not change[:, RATE].any()
    assert explanation.change(explanation.named)[:, RATE] == pytest.approx(np.full(SESSIONS, 10.0), abs=0.15)


def test_effects_that_may_act_are_listed_where_they_fit_best() -> None:
    similar = simulated("latency", {"rate": 1.8})
    explanation = concluded({"rate": 10.0}, SCALE, similar, DRIFT).explanation
    (cause,) = explanation.named
    (placed,) = explanation.possible()
    assert {cause, placed.template.name} == {"scale_factor", "latency"}
    assert placed.size * {"scale_factor": 2.0, "latency": 1.8}[placed.template.name] == pytest.approx(10.0, abs=0.2)
    assert explanation.where_best("temp_bias") is None
