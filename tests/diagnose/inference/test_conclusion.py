"""The posterior on tables made by hand: nothing, one effect, two, and what no effect does."""

from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from inference_support import SESSIONS, rows, scorer_of, simulated, simulated_at_random, simulator, tables
from inference_support import concluded as concluded_of

from gyrodrift.diagnose.features.vector import FEATURES, NUMBER
from gyrodrift.diagnose.inference import conclusion as rules
from gyrodrift.diagnose.inference.conclusion import SIMULATED, Conclusion, conclude, kind_of
from gyrodrift.diagnose.inference.posterior import Posterior, WeightedSet
from gyrodrift.diagnose.inference.verdict import Kind
from gyrodrift.diagnose.simulate.response_table import ENOUGH, SimulatedSet, Sized

SCALE = {"rate": 1.0, "direction": 0.3}
CLOCK = {"clock_ratio": 1.0, "stamp_wander": 0.3}
TRIED = (simulated("scale_factor", SCALE), simulated("clock_drift", CLOCK))


@cache
def concluded(**amounts: float) -> Conclusion:
    """Conclusion from sessions that differ from the rig by some amounts, and by half a standard deviation of chance."""
    chance = 0.5 * np.random.default_rng(1).standard_normal((SESSIONS, len(FEATURES)))
    return concluded_of(rows(amounts) + chance, *TRIED)


def times(size: float, per_size: dict[str, float]) -> dict[str, float]:
    return {name: size * value for name, value in per_size.items()}


def test_chance_alone_is_no_gap() -> None:
    conclusion = concluded()
    assert conclusion.verdict.kind is Kind.NONE
    assert conclusion.explanation.posterior.no_gap > 0.8


def test_an_effect_is_named_with_its_size() -> None:
    """The true size of 6 lies within the interval, and the interval is no wider than the form error and chance."""
    conclusion = concluded(**times(6.0, SCALE))
    (cause,) = conclusion.verdict.causes
    assert (conclusion.verdict.kind, cause.effect.name) == (Kind.EFFECT, "scale_factor")
    assert cause.probability > 0.8
    assert cause.parameters[0].low < 6.0 < cause.parameters[0].high
    assert cause.parameters[0].value == pytest.approx(6.0, rel=0.15)


def test_two_effects_are_named_together() -> None:
    conclusion = concluded(**times(6.0, SCALE), **times(5.0, CLOCK))
    assert {cause.effect.name for cause in conclusion.verdict.causes} == {"scale_factor", "clock_drift"}


def test_the_share_of_a_cause_is_what_returns_without_it() -> None:
    """Two causes share the gap by the squares of their changes, chance has the rest, and probability orders them."""
    causes = concluded(**times(6.0, SCALE), **times(5.0, CLOCK)).verdict.causes
    share = {cause.effect.name: cause.gap_share for cause in causes}
    assert share["scale_factor"] / share["clock_drift"] == pytest.approx(36.0 / 25.0, rel=0.2)
    assert 0.6 < sum(share.values()) < 1.0
    probabilities = [cause.probability for cause in causes]
    assert probabilities == sorted(probabilities, reverse=True)


def test_a_gap_that_no_effect_makes_is_unknown() -> None:
    """Large deviations in other features than those of the effects, and no effect is named for them."""
    conclusion = concluded(temperature=12.0, wander_20s=-9.0)
    assert (conclusion.verdict.kind, conclusion.verdict.causes) == (Kind.UNKNOWN, ())
    assert conclusion.explanation.posterior.unknown > 0.9


@pytest.mark.parametrize(
    ("least", "deviates", "kind"),
    [(rules.PREDICTS, True, Kind.EFFECT), (1.1, True, Kind.UNKNOWN), (1.1, False, Kind.NONE)],
)
def test_a_random_cause_that_is_alone_must_close_a_part_of_the_gap(
    least: float, kind: Kind, monkeypatch: pytest.MonkeyPatch, *, deviates: bool
) -> None:
    """Sessions that scatter as the effect does; without a name it is none only where no feature deviates."""
    monkeypatch.setattr(rules, "PREDICTS", least)
    if not deviates:
        monkeypatch.setattr(rules, "deviations", lambda _z, _threshold, least: ())
    numbers, draws = [NUMBER["walk_20s"], NUMBER["wander_20s"]], np.random.default_rng(2)
    per_size = np.zeros((SESSIONS, ENOUGH, len(FEATURES)))
    per_size[:, :, numbers] = 1.0 + 0.3 * draws.standard_normal((SESSIONS, ENOUGH, 2))
    difference = 6.0 * per_size[:, 0] + 0.5 * draws.standard_normal((SESSIONS, len(FEATURES)))
    verdict = concluded_of(difference, simulated_at_random("bias_instability", per_size)).verdict
    assert [cause.effect.name for cause in verdict.causes] == ["bias_instability"] * (kind is Kind.EFFECT)
    assert verdict.kind is kind


def test_probabilities_of_all_hypotheses_add_up_to_1() -> None:
    posterior = concluded(**times(6.0, SCALE)).explanation.posterior
    assert posterior.weights.sum() == pytest.approx(1.0)
    assert posterior.no_gap + posterior.unknown < 1.0


@pytest.mark.parametrize(
    ("nothing", "cataloged", "unknown", "has_causes", "kind"),
    [
        (0.6, 0.2, 0.2, False, Kind.NONE),
        (0.1, 0.7, 0.2, True, Kind.EFFECT),
        (0.1, 0.3, 0.6, True, Kind.PARTLY),
        (0.1, 0.3, 0.6, False, Kind.UNKNOWN),
        (0.4, 0.3, 0.3, False, Kind.UNKNOWN),
    ],
)
def test_the_kind_is_that_of_the_most_probable_hypotheses(
    nothing: float,
    cataloged: float,
    unknown: float,
    has_causes: bool,  # noqa: FBT001 - parametrized
    kind: Kind,
) -> None:
    none = scorer_of({}).nothing()
    names = frozenset({"scale_factor"})
    posterior = Posterior(
        (
            WeightedSet(frozenset(), False, none, nothing),
            WeightedSet(names, False, none, cataloged),
            WeightedSet(names, True, none, unknown),
        )
    )
    assert kind_of(posterior, has_causes=has_causes) is kind


def test_probable_sets_are_simulated_the_best_part_of_each_first() -> None:
    calls: list[tuple[str, ...]] = []

    def simulate(effects: Sequence[Sized]) -> SimulatedSet:
        calls.append(tuple(sized.candidate.name for sized in effects))
        return simulator(*TRIED)(effects)

    candidates = [tried.candidate for tried in TRIED]
    conclude(tables({}, *TRIED), candidates, simulate)
    assert calls == []
    conclusion = conclude(tables({**times(7.0, SCALE), **times(5.0, CLOCK)}, *TRIED), candidates, simulate)
    assert {len(names) for names in calls[:-1]} == {1}
    assert set(calls[-1]) == {"scale_factor", "clock_drift"}
    scorer, posterior = conclusion.explanation.scorer, conclusion.explanation.posterior
    assert all(scorer.is_simulated(item) for item in posterior.by_mass(SIMULATED) if item.placed)


def test_a_simulation_that_contradicts_the_templates_takes_the_name_away() -> None:
    """The set itself moves other features than the effect alone does."""

    def contradicts(effects: Sequence[Sized]) -> SimulatedSet:
        change = simulator(*TRIED)(effects).change
        return SimulatedSet(change + rows({"temperature": 25.0, "lag": -25.0}), np.zeros_like(change), 3)

    conclusion = conclude(tables(times(7.0, SCALE), *TRIED), [tried.candidate for tried in TRIED], contradicts)
    assert conclusion.verdict.kind is Kind.UNKNOWN


def test_effects_that_fit_as_well_are_tied() -> None:
    same = simulated("latency", SCALE)
    verdict = concluded_of(rows(times(6.0, SCALE)), *TRIED, same).verdict
    (cause,) = verdict.causes
    assert {cause.effect.name, *cause.tied_with} == {"scale_factor", "latency"}
    assert cause.probability == pytest.approx(0.5, abs=0.1)
    assert cause.group_probability > 0.8
    assert verdict.kind is Kind.EFFECT


def test_a_form_that_no_effect_has_is_listed_first() -> None:
    form = simulated("?moving", {"moving": 2.0, "rate": 2.5, "lag": 1.0})
    verdict = concluded_of(rows({"moving": 10.0, "rate": 12.5, "lag": 5.0}), *TRIED, form).verdict
    assert (verdict.kind, verdict.causes) == (Kind.UNKNOWN, ())
    assert [deviation.feature for deviation in verdict.where[:2]] == ["moving", "rate"]


def test_an_effect_that_the_rig_has_at_this_size_is_no_cause() -> None:
    (scale, _) = TRIED
    for percent, kind in ((6.0, Kind.NONE), (2.0, Kind.EFFECT)):
        in_rig = replace(scale.candidate, in_rig=scale.candidate.make(percent))
        tried = scale._replace(candidate=in_rig)
        verdict = concluded_of(rows(times(6.0, SCALE)), tried).verdict
        assert (verdict.kind, bool(verdict.causes)) == (kind, kind is Kind.EFFECT)


def test_an_unknown_effect_stays_beside_an_effect_of_the_rig() -> None:
    """The effect explains its own features as the rig does, and not those that deviate beside them."""
    (scale, _) = TRIED
    tried = scale._replace(candidate=replace(scale.candidate, in_rig=scale.candidate.make(6.0)))
    verdict = concluded_of(rows({**times(6.0, SCALE), "temperature": 12.0, "wander_20s": -9.0}), tried).verdict
    assert (verdict.kind, verdict.causes) == (Kind.UNKNOWN, ())
