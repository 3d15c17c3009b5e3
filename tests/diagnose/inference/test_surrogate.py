"""Predictions of the surrogate: responses that add up, corrected where a set was simulated, and no memory beside."""

from dataclasses import replace

import numpy as np
import pytest
from inference_support import SESSIONS, SIZES, evidence, exactly, random_response, response, row, rows

from gyrodrift.diagnose.features.vector import FEATURES, NUMBER
from gyrodrift.diagnose.inference.evidence import Usual
from gyrodrift.diagnose.inference.surrogate import FREE_PHASE_COST, Cause, Surrogate, beyond_noise
from gyrodrift.diagnose.simulate.response_table import SimulatedSet

RATE, DRIFT = response("scale_factor", {"rate": 2.0}), response("clock_drift", {"clock_ratio": 3.0})
THIRD = response("temp_bias", {"temperature": 1.0})
SURROGATE = Surrogate(evidence({"rate": 6.0, "clock_ratio": 6.0}, RATE, DRIFT, THIRD))
TWO, THREE = Cause(RATE, 1), Cause(RATE, 2)
ONE_DRIFT = Cause(DRIFT, 0)

NAMES = ("scale_factor", "temp_bias", "clock_drift")
LOG, OTHER_LOG = "wander_20s", "noise_rest_32"


def test_changes_add_up() -> None:
    """Size 2 of 2 per size, and size 1 of 3."""
    change = SURROGATE.prediction((TWO, ONE_DRIFT)).change
    assert change == pytest.approx(rows({"rate": 4.0, "clock_ratio": 3.0}))


def test_random_causes_add_variance() -> None:
    """Two standard deviations of 3 and 4 are one of 5."""
    walk, jitter = (
        random_response("rate_random_walk", {"time": 3.0}),
        random_response("timestamp_jitter", {"time": 4.0}),
    )
    surrogate = Surrogate(evidence({}, walk, jitter))
    assert surrogate.prediction((Cause(walk, 0), Cause(jitter, 0))).variance[:, NUMBER["time"]] == pytest.approx(25.0)


def test_what_happens_in_few_sessions_costs_little_in_the_others() -> None:
    """Twenty features that an event in one session spreads: that one gains, and the three without it lose ln 2."""
    names = [one.name for one in FEATURES[:20]]
    walk = random_response("rate_random_walk", dict.fromkeys(names, 3.0))
    events, never = replace(walk, usual=Usual(*np.zeros((2, *walk.spread.shape)))), np.zeros((SESSIONS, len(FEATURES)))
    shown = never + np.eye(SESSIONS, 1) * row(dict.fromkeys(names, 5.0))
    for one, least in ((events, -np.log(2.0)), (walk, -10.0 * np.log(1.0 + 3.0**2))):
        surrogate = Surrogate(evidence(shown, one))
        gains = surrogate.scores((Cause(one, 0),)) - surrogate.scores(())
        assert gains[0] > 15.0
        assert gains[1:] == pytest.approx(np.full(SESSIONS - 1, least), abs=1e-6)


def test_a_curve_is_the_score_at_every_size() -> None:
    """Of a candidate by itself and beside another."""
    for others in ((), (ONE_DRIFT,)):
        scores = [SURROGATE.scores((*others, Cause(RATE, at))) for at in range(len(SIZES))]
        assert SURROGATE.curve(others, RATE) == pytest.approx(np.array(scores))
        assert SURROGATE.curve(others, RATE, 3) == pytest.approx(np.array(scores[::3]))


def test_what_was_simulated_is_predicted_exactly() -> None:
    """And the same offset holds at other sizes, alone and in a curve."""
    simulated = rows({"rate": 4.5, "abs_rate": 1.0})
    refined = SURROGATE.refined((TWO,), exactly(simulated))
    assert refined.prediction((TWO,)).change == pytest.approx(simulated)
    assert refined.prediction((THREE,)).change == pytest.approx(rows({"rate": 6.5, "abs_rate": 1.0}))
    assert refined.curve((), RATE)[2] == pytest.approx(refined.scores((THREE,)))
    assert refined.knows((THREE,))
    assert not refined.knows((TWO, ONE_DRIFT))


def test_a_score_follows_from_the_surrogate_and_the_set_alone() -> None:
    """Whatever was simulated since, the one that did not learn of it says what it said."""
    before = SURROGATE.scores((TWO, ONE_DRIFT))
    refined = SURROGATE.refined((TWO,), exactly(rows({"rate": 9.0})))
    assert refined.scores((TWO, ONE_DRIFT)) != pytest.approx(before)
    assert np.array_equal(SURROGATE.scores((TWO, ONE_DRIFT)), before)


def test_what_scatters_from_run_to_run_is_known_the_less() -> None:
    """A third of it for the mean of three runs, and what is more than two chances for the recording, which is a run."""
    at = NUMBER["rate"]
    for variance, scatter in ((0.3, 0.1), (2.0, 2.0 / 3.0), (8.0, 6.0 + 8.0 / 3.0)):
        runs = SimulatedSet(rows({"rate": 4.0}), rows({"rate": variance}), 3)
        variances = SURROGATE.refined((TWO,), runs).prediction((TWO,)).variance
        assert variances[:, at] == pytest.approx(scatter)
        assert np.count_nonzero(variances) == len(variances)


def test_what_scatters_within_a_relevance_threshold_costs_nothing() -> None:
    """Where chance is 0.6 of sigma, 0.8 is room for what does not matter: a spread of 0.8 is as good as none."""
    within, beyond = Cause(random_response("rate_random_walk", {"rate": 0.8}), 0), {"rate": 1.1}
    calm = replace(evidence({}, within.response), chance=np.full((SESSIONS, len(FEATURES)), 0.6))
    assert Surrogate(calm).scores((within,)) == pytest.approx(Surrogate(calm).scores(()))
    wider = Cause(random_response("rate_random_walk", beyond), 0)
    costs = Surrogate(replace(calm, responses=(wider.response,)))
    assert costs.scores(()) - costs.scores((wider,)) == pytest.approx(0.5 * np.log(0.6**2 + 1.1**2))


def test_the_mean_of_a_few_simulations_is_believed_beyond_its_error() -> None:
    """Of three runs: not where it is as large as that, nearly whole where it is far larger."""
    change, variance = np.array([0.0, 1.0, -1.0, 2.0, 10.0]), np.ones(5)
    assert beyond_noise(change, variance) == pytest.approx([0.0, 0.0, 0.0, 1.5, 9.9])
    assert np.array_equal(beyond_noise(change, np.zeros(5)), change)


def test_of_few_runs_half_is_believed() -> None:
    """The other half is the mean of all sessions."""
    variance = rows({})
    variance[0, NUMBER["rate"]] = 1.2
    found = SURROGATE.refined((TWO,), SimulatedSet(rows({}), variance, 3)).prediction((TWO,)).variance
    assert found[:, NUMBER["rate"]] == pytest.approx([0.25, *[0.05] * (SESSIONS - 1)])


def test_a_set_that_was_not_simulated_takes_the_largest_part_that_was() -> None:
    """Of its single causes and its pair, the pair."""
    surrogate = SURROGATE.refined((TWO,), exactly(rows({"rate": 5.0}))).refined(
        (ONE_DRIFT,), exactly(rows({"clock_ratio": 9.0}))
    )
    surrogate = surrogate.refined((TWO, ONE_DRIFT), exactly(rows({"rate": 4.0, "clock_ratio": 3.0})))
    both = (TWO, ONE_DRIFT, Cause(THIRD, 4))
    assert surrogate.prediction(both).change == pytest.approx(
        rows({"rate": 4.0, "clock_ratio": 3.0, "temperature": 5.0})
    )


def test_what_was_simulated_of_one_variant_is_believed_of_the_others() -> None:
    """Until they are simulated themselves: a variant that has not been does not win for it."""
    slower = response("scale_factor", {"rate": 3.0})
    surrogate = Surrogate(evidence({"rate": 6.0}, RATE, slower)).refined((TWO,), exactly(rows({"rate": 5.0})))
    assert surrogate.prediction((Cause(slower, 1),)).change == pytest.approx(rows({"rate": 7.0}))
    assert not surrogate.knows((Cause(slower, 1),))
    again = surrogate.refined((Cause(slower, 1),), exactly(rows({"rate": 6.5})))
    assert again.prediction((Cause(slower, 1),)).change == pytest.approx(rows({"rate": 6.5}))
    assert again.prediction((TWO,)).change == pytest.approx(rows({"rate": 5.0}))


def test_of_parts_as_large_that_of_the_older_set_around_it_is_behind() -> None:
    """A part within a set that was simulated later is the older knowledge; elsewhere the first holds."""
    surrogate = SURROGATE.refined((TWO,), exactly(rows({"rate": 5.0}))).refined(
        (ONE_DRIFT,), exactly(rows({"clock_ratio": 4.0}))
    )
    both = (TWO, ONE_DRIFT)
    assert surrogate.prediction(both).change == pytest.approx(rows({"rate": 5.0, "clock_ratio": 3.0}))
    with_third = surrogate.refined((TWO, Cause(THIRD, 0)), exactly(rows({"rate": 4.0, "temperature": 1.0})))
    assert with_third.prediction(both).change == pytest.approx(rows({"rate": 4.0, "clock_ratio": 4.0}))


def test_residuals_are_in_standard_deviations() -> None:
    """Of 6 there are 2 left, over a sigma of 1, a tenth of the change of 4, and what leaks of it."""
    residual = SURROGATE.standardised_residuals((TWO,))[0]
    assert residual[NUMBER["rate"]] == pytest.approx(2.0 / np.sqrt(1.0 + 0.4**2 + (0.04 * 4.0) ** 2))
    assert residual[NUMBER["clock_ratio"]] == 6.0
    assert row({})[0] == residual[-1] == 0.0


def test_a_phase_that_was_fitted_has_its_price_in_every_session() -> None:
    """By itself and beside others, in scores and in curves, and once for each cause that has one."""
    turning = replace(RATE, phases_deg=np.full(4, 30.0))
    surrogate = Surrogate(evidence({"rate": 6.0, "clock_ratio": 6.0}, RATE, DRIFT, turning))
    for others in ((), (ONE_DRIFT,)):
        free, fixed = (surrogate.scores((*others, Cause(one, 1))) for one in (turning, RATE))
        assert free == pytest.approx(fixed - FREE_PHASE_COST)
        assert surrogate.curve(others, turning) == pytest.approx(surrogate.curve(others, RATE) - FREE_PHASE_COST)
    beside_free = surrogate.curve((Cause(turning, 1),), DRIFT)
    assert beside_free[0] == pytest.approx(surrogate.scores((Cause(turning, 1), ONE_DRIFT)))
    two = replace(DRIFT, phases_deg=np.full(4, 60.0))
    surrogate = Surrogate(evidence({"rate": 6.0, "clock_ratio": 6.0}, RATE, DRIFT, turning, two))
    both = surrogate.scores((Cause(turning, 1), Cause(two, 0)))
    assert both == pytest.approx(surrogate.scores((TWO, ONE_DRIFT)) - 2.0 * FREE_PHASE_COST)


def test_a_plane_is_the_curves_beside_each_size_of_the_first() -> None:
    """Of one that is fixed by its size and of one that is random."""
    surrogate = SURROGATE.refined((THREE,), exactly(1.1 * SURROGATE.prediction((THREE,)).change))
    responses = [one for one in surrogate.evidence.responses if one is not RATE]
    for plane, other in zip(surrogate.planes(RATE, responses, 2), responses, strict=True):
        sizes = range(0, len(RATE.candidate.sizes), 2)
        beside = [surrogate.curve((Cause(RATE, at),), other, 2) for at in sizes]
        assert plane == pytest.approx(np.array(beside), rel=1e-12)


def test_curves_and_planes_are_scores_whatever_was_simulated() -> None:
    """Logarithms of variances do not add: what a simulation corrects comes behind the sum, in both alike."""
    rng = np.random.default_rng()
    names = ("rate", LOG, OTHER_LOG, "time")
    one, two, three = (response(name, dict(zip(names, rng.normal(0.0, 2.0, 4), strict=True))) for name in NAMES)
    events = random_response("rate_random_walk", {"rate": 2.0, "time": 1.0})
    three = replace(events, mean=three.mean, usual=Usual(-0.2 * events.spread, 0.5 * events.spread))
    surrogate = Surrogate(evidence(dict(zip(names, rng.normal(0.0, 3.0, 4), strict=True)), one, two, three))
    sets = [(Cause(one, 1),), (Cause(two, 2),), (Cause(one, 1), Cause(two, 0)), (Cause(one, 0), Cause(three, 1))]
    for known in rng.permutation(len(sets)):
        change = surrogate.prediction(sets[known]).change
        simulated = SimulatedSet(change + rng.normal(0.0, 1.0, change.shape), rng.gamma(2.0, 2.0, change.shape), 3)
        surrogate = surrogate.refined(sets[known], simulated)
        for others in ((), *sets):
            for new in {one, two, three} - {cause.response for cause in others}:
                scores = [surrogate.scores((*others, Cause(new, at))) for at in range(len(SIZES))]
                assert surrogate.curve(others, new) == pytest.approx(np.array(scores))
        (plane,) = surrogate.planes(one, (two,), 1)
        assert plane[1] == pytest.approx(surrogate.curve((Cause(one, 1),), two))
