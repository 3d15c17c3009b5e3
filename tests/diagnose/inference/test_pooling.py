"""Evidence out of tables of single sessions: nulls pooled, responses taken to sizes that were not simulated."""

from dataclasses import replace

import numpy as np
import pytest
from inference_support import candidate, row

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features.vector import FEATURES, IS_LOG, LINEAR, NUMBER
from gyrodrift.diagnose.inference.pooling import evidence_of, interpolated, scaled
from gyrodrift.diagnose.simulate.response_table import ResponseTable, key, simulated_key

LOG = FEATURES[int(np.flatnonzero(IS_LOG)[0])].name
SHARE = FEATURES[int(np.flatnonzero(~IS_LOG & ~LINEAR)[0])].name


def table(name: str, nulls: Floats, answers: dict[str, Floats] | None = None) -> ResponseTable:
    """Of a session whose rate deviates by 7, where 2 matter."""
    return ResponseTable(
        name, row({"rate": 7.0}), row({"rate": 2.0}), np.zeros((1, len(FEATURES))), nulls, answers or {}
    )


def test_nulls_of_all_sessions_are_one_sample() -> None:
    """Their mean is taken off, their spread and the relevance threshold are one sigma."""
    nulls = [np.array([row({"rate": 0.0}), row({"rate": 2.0})]), np.array([row({"rate": 1.0}), row({"rate": 5.0})])]
    evidence = evidence_of([table("one", nulls[0]), table("two", nulls[1])], [])
    at = NUMBER["rate"]
    variance = np.var([0.0, 2.0, 1.0, 5.0], ddof=1)
    assert evidence.names == ("one", "two")
    assert evidence.difference[:, at] == pytest.approx([5.0, 5.0])
    assert evidence.sigma[:, at] == pytest.approx(np.sqrt(variance + 4.0))
    assert evidence.nulls[:, at] == pytest.approx(np.array([-2.0, 0.0, -1.0, 3.0]) / np.sqrt(variance + 4.0))
    assert evidence.z[0, at] == pytest.approx(5.0 / np.sqrt(variance + 4.0))


def test_a_feature_that_these_motions_do_not_have_never_deviates() -> None:
    """Without spread and threshold it is divided by 1, not by 0."""
    evidence = evidence_of([table("one", np.zeros((2, len(FEATURES))))], [])
    assert np.isfinite(evidence.z).all()
    assert evidence.z[0, NUMBER["abs_rate"]] == 0.0


def test_sizes_between_two_that_were_simulated_are_interpolated() -> None:
    """Along the logarithm of the size: 2 lies half way between 1 and 4."""
    one = replace(candidate("latency"), grid_points=np.array([1.0, 4.0, 16.0]), sizes=np.array([1.0, 2.0, 4.0, 16.0]))
    nodes = np.array([row({"lag": 10.0}), row({"lag": 30.0}), row({"lag": 50.0})])[:, None]
    assert interpolated(one, nodes)[:, 0, NUMBER["lag"]] == pytest.approx([10.0, 20.0, 30.0, 50.0])


def test_a_linear_effect_is_scaled_to_both_sides_of_zero() -> None:
    """Each by the simulation of its own sign."""
    one = replace(candidate("scale_factor"), grid_points=np.array([-1.0, 1.0]), sizes=np.array([-2.0, -0.5, 0.5, 2.0]))
    nodes = np.array([row({"rate": -10.0}), row({"rate": 12.0})])[:, None]
    assert interpolated(one, nodes)[:, 0, NUMBER["rate"]] == pytest.approx([-20.0, -5.0, 6.0, 24.0])


def test_what_a_linear_effect_does_to_variances_grows_with_its_square() -> None:
    """One that doubles a variance makes it five times as large at twice the size; shares of samples grow no further."""
    found = scaled(row({LOG: np.log(2.0), SHARE: 0.5, "rate": 1.0}), np.array([0.5, 2.0]))
    assert found[:, NUMBER[LOG]] == pytest.approx(np.log([1.25, 5.0]))
    assert found[:, NUMBER[SHARE]] == pytest.approx([0.25, 0.5])
    assert found[:, NUMBER["rate"]] == pytest.approx([0.5, 2.0])


def test_a_phase_is_turned_out_of_its_sine_and_cosine() -> None:
    """At 30 degrees cos 30° of the one and sin 30° of the other."""
    one = replace(
        candidate("scale_factor"),
        name="g_sensitivity",
        phase_deg=30.0,
        grid_points=np.array([1.0]),
        sizes=np.array([2.0]),
    )
    answers = {
        simulated_key(one, 0.0): row({"turn_sine": 4.0})[None, None],
        simulated_key(one, 90.0): row({"turn_cosine": 4.0})[None, None],
    }
    (response,) = evidence_of([table("one", np.zeros((2, len(FEATURES))), answers)], [one]).responses
    assert response.mean[0, 0, NUMBER["turn_sine"]] == pytest.approx(8.0 * np.cos(np.pi / 6.0))
    assert response.mean[0, 0, NUMBER["turn_cosine"]] == pytest.approx(8.0 * np.sin(np.pi / 6.0))


def test_realisations_of_all_sessions_are_one_sample() -> None:
    """What may go either way has no mean but a spread, of which 0 is the middle; a variance has both."""
    one = replace(candidate("rate_random_walk"), realisations=2, grid_points=np.array([1.0]), sizes=np.array([1.0]))
    draws = [[row({"time": 3.0, LOG: 1.0}), row({"time": 1.0, LOG: 2.0})], [row({"time": -3.0, LOG: 3.0}), row({})]]
    tables = [
        table(str(number), np.zeros((2, len(FEATURES))), {key(one): np.array([draw])})
        for number, draw in enumerate(draws)
    ]
    (response,) = evidence_of(tables, [one]).responses
    assert response.mean[0, :, NUMBER["time"]] == pytest.approx([0.0, 0.0])
    assert response.spread[0, NUMBER["time"]] == pytest.approx(np.sqrt((9.0 + 1.0 + 9.0) / 4.0))
    assert response.mean[0, :, NUMBER[LOG]] == pytest.approx([1.5, 1.5])
    assert response.spread[0, NUMBER[LOG]] == pytest.approx(np.std([1.0, 2.0, 3.0, 0.0]))
