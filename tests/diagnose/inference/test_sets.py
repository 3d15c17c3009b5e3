"""Sets of effects: their evidence, corrections by whole simulations, and forms that no effect has."""

from dataclasses import replace

import numpy as np
import pytest
from inference_support import SESSIONS, Simulated, candidate, exactly, rows, scorer_of, simulated, simulated_at_random

from gyrodrift.diagnose.features.vector import FEATURES, IS_LOG, LINEAR, NUMBER
from gyrodrift.diagnose.inference.posterior import POWER
from gyrodrift.diagnose.inference.scorer import (
    CLOSE_TO_IT,
    EFFECT,
    EXACT,
    OUT_OF_CATALOGUE,
    USUAL,
    EffectSet,
    Placed,
    Scorer,
    beyond_noise,
    log_prior_of,
)
from gyrodrift.diagnose.inference.sets import find_sets, fitted, known_forms
from gyrodrift.diagnose.simulate.response_table import SimulatedSet

LOG = FEATURES[int(np.flatnonzero(IS_LOG & ~LINEAR)[0])].name
RATE, CLOCK = NUMBER["rate"], NUMBER["clock_ratio"]
SCALE = simulated("scale_factor", {"rate": 2.0, "lag": 1.0})
DRIFT = simulated("clock_drift", {"clock_ratio": 3.0})


def by_names(scorer: Scorer) -> dict[tuple[str, ...], EffectSet]:
    return {tuple(sorted(item.names)): item for item in find_sets(scorer)}


def curve() -> Simulated:
    """A candidate whose rate grows with the square of its size, simulated at 2 and at 8 only."""
    points = np.array([2.0, 8.0])
    nodes = np.square(points)[:, None, None, None] * rows({"rate": 1.0})[:, None]
    return Simulated(replace(candidate("latency"), grid_points=points, sizes=np.linspace(2.0, 8.0, 13)), nodes)


def placed_at(scorer: Scorer, name: str, size: float) -> Placed:
    template = scorer.templates[name]
    return Placed(template, int(np.abs(template.size - size).argmin()))


def test_two_effects_are_more_probable_together_than_alone() -> None:
    scorer = scorer_of({"rate": 10.0, "lag": 5.0, "clock_ratio": 9.0}, SCALE, DRIFT)
    sets = by_names(scorer)
    pair = sets["clock_drift", "scale_factor"]
    for names, item in sets.items():
        if len(names) < 2:
            assert pair.without_unknown > item.without_unknown + 10.0
            assert scorer.log_posterior(pair, POWER) > scorer.log_posterior(item, POWER)
    sizes = {placed.template.name: placed.size for placed in pair.placed}
    assert sizes == pytest.approx({"scale_factor": 5.0, "clock_drift": 3.0}, abs=0.15)


def test_an_effect_that_is_not_there_costs_its_prior_and_its_sizes() -> None:
    scorer = scorer_of({}, SCALE, DRIFT)
    sets = by_names(scorer)
    log_posteriors = [
        scorer.log_posterior(sets[names], POWER) for names in ((), ("scale_factor",), ("clock_drift", "scale_factor"))
    ]
    assert log_posteriors == sorted(log_posteriors, reverse=True)
    assert log_posteriors[0] > log_posteriors[1] + 3.0


def test_a_correction_removes_the_error_of_interpolation_and_changes_the_evidence() -> None:
    """A parabola on one straight line: the simulation says what it does at the size, and the error is gone."""
    size = 4.0
    truth = rows({"rate": size**2})
    scorer = scorer_of(truth, curve())
    at_size = EffectSet((placed_at(scorer, "latency", size),), 0.0, 0.0)
    before, covariance = scorer.change(at_size.placed), scorer.prediction(at_size.placed)[1]
    evidence = fitted(scorer, at_size).without_unknown
    assert before[0, RATE] == pytest.approx(24.0)  # between 4 at a size of 2, and 64 at 8
    assert not scorer.is_simulated(at_size)
    scorer.correct(at_size, exactly(truth))
    assert scorer.is_simulated(at_size)
    assert not scorer.has_moved(at_size)
    assert scorer.has_moved(EffectSet((placed_at(scorer, "latency", 5.0),), 0.0, 0.0))
    assert scorer.change(at_size.placed) == pytest.approx(truth)
    narrower = scorer.prediction(at_size.placed)[1]
    assert narrower[RATE, 0, 0] < covariance[RATE, 0, 0] - 20.0
    again = fitted(scorer, at_size)
    assert again.without_unknown > evidence + 1.0
    assert again.placed[0].size == pytest.approx(size, abs=0.3)


def test_a_correction_that_is_wrong_lowers_the_evidence() -> None:
    truth = rows({"rate": 10.0, "lag": 5.0})
    scorer = scorer_of(truth, SCALE)
    at_size = fitted(scorer, EffectSet((placed_at(scorer, "scale_factor", 5.0),), 0.0, 0.0))
    scorer.correct(at_size, exactly(truth + rows({"lag": 6.0})))
    assert scorer.change(at_size.placed)[:, NUMBER["lag"]] == pytest.approx(np.full(SESSIONS, 11.0), abs=0.2)
    assert fitted(scorer, at_size).without_unknown < at_size.without_unknown - 3.0


def test_the_largest_part_of_a_set_that_was_simulated_corrects_it() -> None:
    scorer = scorer_of({"rate": 10.0, "lag": 5.0, "clock_ratio": 9.0}, SCALE, DRIFT)
    scale, drift = placed_at(scorer, "scale_factor", 5.0), placed_at(scorer, "clock_drift", 3.0)
    alone = EffectSet((scale,), 0.0, 0.0)
    scorer.correct(alone, exactly(scorer.change([scale]) + rows({"lag": 6.0})))
    lag = NUMBER["lag"]
    assert scorer.change([scale, drift])[0, lag] == pytest.approx(11.0)
    assert scorer.change([drift])[0, lag] == 0.0
    pair = EffectSet((scale, drift), 0.0, 0.0)
    scorer.correct(pair, exactly(rows({"rate": 10.0, "lag": 4.0, "clock_ratio": 9.0})))
    assert scorer.change([scale, drift])[0, lag] == pytest.approx(4.0)


def test_a_correction_within_its_own_error_is_not_believed() -> None:
    """A change that is twice its error is believed to three quarters."""
    change = np.array([0.5, 2.0, -2.0, 0.0])
    assert beyond_noise(change, np.ones(4)) == pytest.approx([0.0, 1.5, -1.5, 0.0])
    assert np.array_equal(beyond_noise(change, np.zeros(4)), change)


def test_the_scatter_of_simulations_joins_the_variance() -> None:
    """Two runs differ by 2 by chance; a variance of 6 is 4 more, and the mean of three runs has a third of it."""
    scorer = scorer_of({"rate": 10.0}, SCALE)
    at_size = EffectSet((placed_at(scorer, "scale_factor", 5.0),), 0.0, 0.0)
    before = scorer.prediction(at_size.placed)[1][CLOCK, 0, 0]
    change = scorer.change(at_size.placed)
    scorer.correct(at_size, SimulatedSet(change, np.full_like(change, 6.0), 3))
    assert scorer.prediction(at_size.placed)[1][CLOCK, 0, 0] == pytest.approx(before + 4.0 + 2.0)


def test_a_form_that_no_effect_has_is_less_probable_beforehand() -> None:
    form = simulated("?moving", {"moving": 2.0})
    exact = SCALE._replace(candidate=replace(SCALE.candidate, is_exact=True))
    templates = scorer_of({}, form, SCALE, DRIFT).templates
    assert log_prior_of(templates["?moving"]) == pytest.approx(np.log(OUT_OF_CATALOGUE / (1.0 - OUT_OF_CATALOGUE)))
    assert log_prior_of(templates["scale_factor"]) == pytest.approx(np.log(EFFECT / (1.0 - EFFECT)))
    assert known_forms(templates["?moving"]) == (USUAL,)
    assert known_forms(templates["scale_factor"]) == (CLOSE_TO_IT, USUAL)
    assert known_forms(scorer_of({}, exact).templates["scale_factor"]) == (EXACT, USUAL)
    of_form = by_names(scorer_of({"moving": 10.0}, form))["?moving",]
    assert of_form.resembling == ((-np.inf, -np.inf),)


def test_an_effect_whose_form_is_not_exact_has_the_wider_form_error() -> None:
    """Two features in other proportions than the simulated ones; in the same proportions it is the narrow one."""
    for lag, form_error in ((5.0, CLOSE_TO_IT), (8.0, USUAL)):
        scorer = scorer_of({"rate": 10.0, "lag": lag}, SCALE)
        (placed,) = by_names(scorer)["scale_factor",].placed
        assert placed.form_error == form_error


def test_an_effect_that_only_resembles_fits_what_the_effect_does_not() -> None:
    """Features in other proportions; where the effect fits, its own evidence is larger."""
    gains = []
    for lag in (5.0, 25.0):
        item = by_names(scorer_of({"rate": 10.0, "lag": lag}, SCALE))["scale_factor",]
        gains.append(item.resembling[0][0] - item.without_unknown)
    assert gains[0] < -1.0
    assert gains[1] > 10.0


def test_logarithms_of_variances_add_as_variances() -> None:
    noise = (simulated(name, {LOG: 1.0, "rate": 1.0}) for name in ("timestamp_jitter", "latency"))
    scorer = scorer_of({}, *noise)
    change = scorer.change([placed_at(scorer, "timestamp_jitter", 2.0), placed_at(scorer, "latency", 3.0)])
    assert change[:, RATE] == pytest.approx(np.full(SESSIONS, 5.0))
    assert change[:, NUMBER[LOG]] == pytest.approx(np.full(SESSIONS, np.log(np.exp(2.0) + np.exp(3.0) - 1.0)))


def random_rate() -> Simulated:
    """An effect that moves rate and lag together, either way, in each session."""
    draws = np.random.default_rng(1).standard_normal((SESSIONS, 32, 1))
    return simulated_at_random("bias_instability", draws * rows({"rate": 2.0, "lag": 2.0})[0])


def test_a_random_effect_is_paid_for_where_nothing_deviates() -> None:
    scorer = scorer_of({}, random_rate())
    template = scorer.templates["bias_instability"]
    densities = scorer.along(template, []).without_unknown - scorer.nothing().without_unknown
    assert (np.diff(densities) < 0.0).all()
    assert densities[-1] < -6.0


def test_a_random_effect_explains_features_that_move_together() -> None:
    """Two that do in each session, otherwise than one that goes up where the other goes down."""
    signs = np.array([1.0, -1.0, 1.0, -1.0])[:, None]
    together, apart = (
        by_names(scorer_of(signs * rows({"rate": 12.0, "lag": lag}), random_rate()))["bias_instability",]
        for lag in (12.0, -12.0)
    )
    assert together.without_unknown > apart.without_unknown + 10.0


def test_sets_of_some_sessions_have_the_corrections_of_these() -> None:
    """A scorer without the first session."""
    truth = rows({"rate": 10.0, "lag": 5.0})
    truth[0] *= 2.0
    scorer = scorer_of(truth, SCALE)
    at_size = EffectSet((placed_at(scorer, "scale_factor", 5.0),), 0.0, 0.0)
    scorer.correct(at_size, exactly(truth))
    part = scorer.of_sessions([1, 2, 3])
    assert part.observation.sessions == 3
    assert part.change([placed_at(part, "scale_factor", 5.0)]) == pytest.approx(truth[1:])
