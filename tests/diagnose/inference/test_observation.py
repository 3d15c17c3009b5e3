"""Observed differences in units of their standard deviation without a gap."""

from dataclasses import replace

import numpy as np
import pytest
from inference_support import SESSIONS, observed, rows, tables, unit_nulls

from gyrodrift.diagnose.features.vector import FEATURES, NUMBER
from gyrodrift.diagnose.inference.observation import observation_of

RATE = NUMBER["rate"]


def test_a_difference_is_in_units_of_the_scatter_of_its_nulls() -> None:
    nulls = unit_nulls(SESSIONS)
    nulls[:, :, RATE] *= 2.0
    result = observed({"rate": 6.0, "lag": 6.0}, nulls=nulls)
    assert result.unit[:, RATE] == pytest.approx(np.full(SESSIONS, 2.0))
    assert result.difference[:, RATE] == pytest.approx(np.full(SESSIONS, 3.0))
    assert result.difference[:, NUMBER["lag"]] == pytest.approx(np.full(SESSIONS, 6.0))
    assert result.covariance == pytest.approx(np.tile(np.eye(SESSIONS), (len(FEATURES), 1, 1)), abs=1e-9)


def test_the_mean_of_the_nulls_is_no_difference() -> None:
    """Replaying leaves it in each session."""
    result = observed({"rate": 6.0}, nulls=unit_nulls(SESSIONS) + 1.5)
    assert (result.difference * result.unit)[:, RATE] == pytest.approx(np.full(SESSIONS, 4.5))


def test_what_is_not_compared_is_no_difference_and_no_correlation() -> None:
    made = tables({"rate": 6.0})
    compared = np.ones((SESSIONS, len(FEATURES)), dtype=np.bool_)
    compared[1, RATE] = False
    result = observation_of(made, compared)
    assert result.difference[:, RATE] == pytest.approx([6.0, 0.0, 6.0, 6.0])
    assert result.covariance[RATE, 1] == pytest.approx([0.0, 1.0, 0.0, 0.0])


def test_relevance_is_half_common_to_the_sessions() -> None:
    """A threshold as large as the scatter: a variance of 2, of which a quarter is common."""
    made = [replace(table, thresholds=np.ones(len(FEATURES))) for table in tables({"rate": 6.0})]
    result = observation_of(made, np.ones((SESSIONS, len(FEATURES)), dtype=np.bool_))
    assert result.unit[:, RATE] == pytest.approx(np.full(SESSIONS, np.sqrt(2.0)))
    off = ~np.eye(SESSIONS, dtype=np.bool_)
    assert result.covariance[RATE][off] == pytest.approx(np.full(SESSIONS * (SESSIONS - 1), 0.25))


def test_nulls_that_all_sessions_have_in_common_are_correlated() -> None:
    """Runs that are equal in each session, and independent runs."""
    runs = np.random.default_rng(1).standard_normal((1, 12, len(FEATURES)))
    common = observed({}, nulls=np.tile(runs, (SESSIONS, 1, 1))).covariance[:, 0, 1]
    independent = observed({}, nulls=np.random.default_rng(2).standard_normal((SESSIONS, 12, len(FEATURES))))
    assert common.min() > 0.5
    assert independent.covariance[:, 0, 1].mean() < 0.2


def test_some_of_the_sessions_are_an_observation() -> None:
    difference = rows({"rate": 1.0}) * np.arange(1.0, SESSIONS + 1.0)[:, None]
    whole = observed(difference)
    part = whole.of_sessions([2, 0])
    assert part.sessions == 2
    assert part.difference[:, RATE] == pytest.approx([3.0, 1.0])
    assert np.array_equal(part.covariance, whole.covariance[:, [2, 0]][:, :, [2, 0]])
