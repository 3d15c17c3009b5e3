"""The verdict: what kind of gap it is, ties told as ties, what no effect explains, and in which order causes stand."""

from dataclasses import replace

import numpy as np
import pytest
from inference_support import Amounts, added, candidate, evidence, random_response, response

from firmware_sim.rig import parse_effect
from gyrodrift.diagnose.inference.alternatives import alternatives_of
from gyrodrift.diagnose.inference.evidence import Evidence, Response
from gyrodrift.diagnose.inference.parameters import Parameter
from gyrodrift.diagnose.inference.search import search
from gyrodrift.diagnose.inference.surrogate import Cause
from gyrodrift.diagnose.inference.verdict import (
    NEGLIGIBLE_DEG,
    Kind,
    NamedCause,
    Verdict,
    is_small,
    kind_of,
    less,
    set_aside,
    verdict_of,
)
from gyrodrift.diagnose.simulate.candidates import KINDS

RATE = response("scale_factor", {"rate": 2.0})
DRIFT = response("clock_drift", {"clock_ratio": 3.0})


def judged(one: Evidence) -> Verdict:
    """Of a search from nothing."""
    result = search(one, added)
    return verdict_of(result, alternatives_of(result, added)[0])


@pytest.mark.parametrize(
    ("explained", "shows", "has_causes", "has_unexplained", "kind"),
    [
        (1.0, False, False, False, Kind.NONE),
        (0.0, True, False, True, Kind.UNKNOWN),
        (0.9, True, True, False, Kind.EFFECT),
        (0.4, True, True, True, Kind.PARTLY),
        (0.39, True, True, True, Kind.UNKNOWN),
        (0.1, True, True, False, Kind.EFFECT),
    ],
)
def test_kinds(explained: float, shows: bool, has_causes: bool, has_unexplained: bool, kind: Kind) -> None:  # noqa: FBT001 - parametrized
    """By whether anything shows, is named, is explained and is left."""
    assert kind_of(explained, shows=shows, has_causes=has_causes, has_unexplained=has_unexplained) is kind


def test_no_gap() -> None:
    """Nothing is named, nothing deviates, and there is nothing to close."""
    verdict = judged(evidence({"rate": 1.0}, RATE, DRIFT))
    assert verdict.kind is Kind.NONE
    assert (verdict.causes, verdict.where, verdict.unexplained) == ((), (), ())
    assert verdict.gap.shrink is None
    assert verdict.gap.before == verdict.gap.after


def test_a_cause_that_explains_all_is_the_effect() -> None:
    """With its size, what it did first, and nothing left."""
    verdict = judged(evidence({"rate": 10.0}, RATE, DRIFT))
    assert verdict.kind is Kind.EFFECT
    (cause,) = verdict.causes
    assert (cause.effect.name, cause.group) == ("scale_factor", "scale")
    assert cause.parameters[0].value == pytest.approx(5.0, rel=0.02)
    assert cause.tied_with == ()
    assert cause.probability > 0.9
    assert [one.feature for one in verdict.where] == ["rate"]
    assert verdict.where[0].z == pytest.approx(20.0)  # 10 in each of four sessions
    assert verdict.unexplained == ()


def test_a_cause_that_leaves_something_explains_it_partly() -> None:
    """What is left is told, and lowers the probability."""
    verdict = judged(evidence({"rate": 10.0, "temperature_rate": 4.0}, RATE, DRIFT))
    assert verdict.kind is Kind.PARTLY
    assert [one.feature for one in verdict.unexplained] == ["temperature_rate"]
    assert verdict.causes[0].probability < judged(evidence({"rate": 10.0}, RATE, DRIFT)).causes[0].probability


def test_a_cause_that_explains_less_than_is_left_is_not_likely() -> None:
    """It may be a part of what is not known; one that explains much more is as likely as ever."""
    weak = judged(evidence({"rate": 5.0, "temperature_rate": 6.0, "clock_ratio": 20.0}, RATE, DRIFT))
    found = {one.effect.name: one.probability for one in weak.causes}
    assert found["scale_factor"] < 0.5
    assert found["clock_drift"] > found["scale_factor"] + 0.3


@pytest.mark.parametrize("names", [("latency", "backlash"), ("backlash", "latency")])
def test_two_that_do_the_same_are_tied(names: tuple[str, str]) -> None:
    """Whichever is named tells of the other, and is less probable for it: 2.8 less four times the logarithm of 2."""
    verdict = judged(evidence({"lag": 10.0}, *(response(name, {"lag": 2.0}) for name in names)))
    (cause,) = verdict.causes
    assert {cause.effect.name, *cause.tied_with} == set(names)
    assert cause.probability == pytest.approx(1.0 / (1.0 + np.exp(-2.8 + 4.0 * np.log(2.0))), abs=0.01)


def test_one_that_does_half_of_it_is_not_tied() -> None:
    """It leaves too much."""
    whole, half = response("latency", {"lag": 2.0, "lag_bend": 2.0}), response("backlash", {"lag": 2.0})
    (cause,) = judged(evidence({"lag": 10.0, "lag_bend": 10.0}, whole, half)).causes
    assert cause.effect.name == "latency"
    assert cause.tied_with == ()


@pytest.mark.parametrize(
    ("names", "tied_with"),
    [(("bias_instability", "rate_random_walk"), ("rate_random_walk",)), (("latency", "backlash"), ())],
)
def test_walks_that_explain_nearly_as_much_are_tied(names: tuple[str, str], tied_with: tuple[str, ...]) -> None:
    """Another generator's may well show more of the wrong one; it counts no more than by what it explains."""
    better, worse = (
        response(name, {"time": 2.0, "walk_20s": 2.0, "wander_20s": 2.0, "wander_5s": share})
        for name, share in zip(names, (2.0, 1.25), strict=True)
    )
    (cause,) = judged(
        evidence(dict.fromkeys(("time", "walk_20s", "wander_20s", "wander_5s"), 10.0), better, worse)
    ).causes
    assert (cause.effect.name, cause.tied_with) == (names[0], tied_with)
    assert cause.probability > 0.8


def test_what_explains_all_and_is_improbable_is_unknown() -> None:
    """A random cause with rivals that no effect is: nothing is named, and nothing of the gap is closed."""
    names = ("?swing", "?ripple", "?wander_rest")
    shown: Amounts = {"walk_20s": 2.0, **{name.removeprefix("?"): 2.0 for name in names}}
    walk = random_response("bias_instability", {"time": 3.0, "walk_20s": 1.0})
    walk = replace(walk, mean=response("bias_instability", shown).mean)
    strange = [Response(candidate(name, realisations=4), walk.mean, walk.spread) for name in names]
    one = evidence({name: 5.0 * amount for name, amount in shown.items()}, walk, *strange)
    alone = judged(one.only(["bias_instability"]))
    assert alone.kind is Kind.EFFECT
    assert alone.causes[0].group_probability > 0.5
    verdict = judged(one)
    assert verdict.kind is Kind.UNKNOWN
    assert verdict.causes == ()
    assert verdict.unexplained == verdict.where != ()
    assert verdict.gap.after == verdict.gap.before


def test_a_group_is_as_probable_as_one_of_it_that_has_no_kin() -> None:
    """What is tied within a group, or with the cause, does not count against the two together."""
    names = ("latency", "backlash")
    (cause,) = judged(evidence({"lag": 10.0}, *(response(name, {"lag": 2.0}) for name in names))).causes
    (alone,) = judged(evidence({"lag": 10.0}, response(cause.effect.name, {"lag": 2.0}))).causes
    assert cause.group_probability == alone.group_probability == alone.probability > cause.probability


@pytest.mark.parametrize(
    ("names", "is_sure"),
    [
        (("latency", "bandwidth"), False),
        (("latency", "backlash"), True),
        (("scale_asymmetry", "vibration_rectification"), True),
    ],
)
def test_the_weaker_of_a_group_may_be_what_the_stronger_lacks(names: tuple[str, str], *, is_sure: bool) -> None:
    """A low-pass of the second order is one of the first and a delay: the weaker is as probable as a tie."""
    stronger, weaker = (
        response(name, {feature: 2.0}) for name, feature in zip(names, ("lag", "lag_bend"), strict=True)
    )
    stronger = replace(stronger, candidate=replace(stronger.candidate, is_exact=KINDS[names[0]].is_exact))
    verdict = judged(evidence({"lag": 14.0, "lag_bend": 8.0}, stronger, weaker))
    probabilities = {cause.effect.name: cause.probability for cause in verdict.causes}
    assert set(probabilities) == set(names)
    assert probabilities[names[0]] > 0.9
    assert (probabilities[names[1]] > 0.9) is is_sure
    assert all(cause.group_probability > 0.9 for cause in verdict.causes)


def test_what_no_effect_does_is_unknown() -> None:
    """Nothing is named; what it depends on stands first, before what deviates more."""
    both: Amounts = {"moving": 2.0, "rate": 2.5}
    strange = Response(candidate("?moving"), response("scale_factor", both).mean, RATE.spread)
    verdict = judged(evidence({"moving": 10.0, "rate": 12.5}, strange, DRIFT))
    assert verdict.kind is Kind.UNKNOWN
    assert verdict.causes == ()
    assert [one.feature for one in verdict.where] == ["moving", "rate"]
    assert verdict.unexplained == verdict.where
    assert sum(one.share for one in verdict.where) == pytest.approx(1.0)
    assert verdict.gap.after == verdict.gap.before


def test_what_no_effect_does_is_left_over_beside_a_cause() -> None:
    """The cause is named, and the rest is told as what it would be without an explanation."""
    strange = Response(candidate("?moving"), response("scale_factor", {"moving": 2.0}).mean, RATE.spread)
    verdict = judged(evidence({"moving": 10.0, "rate": 10.0}, strange, RATE))
    assert verdict.kind is Kind.PARTLY
    assert [cause.effect.name for cause in verdict.causes] == ["scale_factor"]
    assert [one.feature for one in verdict.unexplained] == ["moving"]
    assert verdict.unexplained[0].z > 15.0


def test_what_no_effect_does_is_unknown_where_it_shows_in_no_feature() -> None:
    """Four features of 1.5 sigmas in each of four sessions: none of them stands out, all of them together do."""
    weak: Amounts = dict.fromkeys(("moving", "direction", "after_turn", "total_angle"), 1.5)
    strange = Response(candidate("?moving"), response("scale_factor", weak).mean, RATE.spread)
    one = evidence(weak, strange, DRIFT)
    assert judged(one.only(["clock_drift"])).kind is Kind.NONE
    verdict = judged(one)
    assert verdict.kind is Kind.UNKNOWN
    assert [one.feature for one in verdict.where] == ["moving"]


def test_a_form_that_is_chance_is_no_gap_where_it_shows_in_no_feature() -> None:
    """As where recordings of one device differ as much among themselves; what stands out by itself still does."""
    weak: Amounts = dict.fromkeys(("moving", "direction", "after_turn", "total_angle"), 1.5)
    strange = Response(candidate("?moving"), response("scale_factor", weak).mean, RATE.spread)
    for shown, kind, where in (
        (weak, Kind.NONE, []),
        ({**weak, "temperature": 10.0}, Kind.UNKNOWN, ["temperature"]),
        (dict.fromkeys(weak, 10.0), Kind.UNKNOWN, [*weak]),
    ):
        one = evidence(shown, strange, DRIFT)
        verdict = less(judged(one), (), ("moving",), one)
        assert verdict.kind is kind
        assert {deviation.feature for deviation in verdict.where} == set(where)
        assert verdict.unexplained == verdict.where


def test_beside_a_cause_a_form_that_is_chance_leaves_nothing_unexplained() -> None:
    """The cause alone is the effect then, and without it there is nothing."""
    weak: Amounts = dict.fromkeys(("moving", "direction", "after_turn", "total_angle"), 1.5)
    strange = Response(candidate("?moving"), response("scale_factor", weak).mean, RATE.spread)
    one = evidence({**weak, "rate": 10.0}, strange, RATE)
    verdict = judged(one)
    assert verdict.kind is Kind.PARTLY
    assert less(verdict, (), ("moving",), one).kind is Kind.EFFECT
    assert [left.feature for left in less(verdict, ("scale_factor",), ("moving",), one).where] == ["rate"]


@pytest.mark.parametrize(("share", "is_sure"), [(0.0, True), (1.0, False)])
def test_a_cause_that_looks_like_what_no_effect_does_may_be_a_part_of_it(share: float, *, is_sure: bool) -> None:
    """A curve of the rate beside a kink that no effect has: two forms, or one that is neither."""
    curve = response("scale_asymmetry", {"rate_cubed": 2.0, "hinge_low": share})
    kink = response("scale_factor", {"hinge_low": 2.0, "rate_cubed": share})
    strange = Response(candidate("?hinge_low"), kink.mean, kink.spread)
    shown: Amounts = {"rate_cubed": 2.0 + 0.6 * share, "hinge_low": 1.2 + share}
    verdict = judged(evidence({name: 8.0 * amount for name, amount in shown.items()}, curve, strange))
    (cause,) = verdict.causes
    assert cause.effect.name == "scale_asymmetry"
    assert (cause.probability > 0.8) is is_sure


def test_a_gap_that_nothing_explains_is_unknown() -> None:
    """Without any candidate that moves what deviates."""
    verdict = judged(evidence({"temperature": 10.0}, RATE, DRIFT))
    assert verdict.kind is Kind.UNKNOWN
    assert verdict.causes == ()
    assert verdict.unexplained == verdict.where


def test_a_profile_has_the_score_of_the_set_at_each_size() -> None:
    """And its top at the size that was found."""
    result = search(evidence({"rate": 10.0, "clock_ratio": 9.0}, RATE, DRIFT), added)
    every, surrogate = alternatives_of(result, added)
    for one in every:
        assert int(np.argmax(one.profile)) == one.cause.at
        assert one.profile.max() == pytest.approx(surrogate.scores(result.found.causes).sum())
        assert one.rivals == ()
        assert one.rival_weight == 0.0


def named(text: str, in_rig: str | None = None) -> NamedCause:
    """A cause as it is named, of an effect that a rig may have at another size."""
    effect = parse_effect(text)
    tried = replace(candidate(effect.name), in_rig=parse_effect(in_rig) if in_rig else None)
    return NamedCause(Cause(replace(RATE, candidate=tried), 0), effect, "group", "", 0.9, 0.9, (), ())


@pytest.mark.parametrize(
    ("text", "in_rig", "small"),
    [
        ("latency:delay_ms=0.9", None, True),
        ("latency:delay_ms=1.1", None, False),
        ("latency:delay_ms=20.9", "latency:delay_ms=20", True),
        ("latency:delay_ms=18.9", "latency:delay_ms=20", False),
        ("scale_factor:error_percent=-3", None, False),
        ("temp_bias:slope_dps_per_c=-0.00001", None, True),
    ],
)
def test_a_cause_is_small_by_what_is_new_of_it(text: str, in_rig: str | None, small: bool) -> None:  # noqa: FBT001 - parametrized
    """A delay matters from 1 ms on, or from 1 ms beside that of the rig."""
    assert is_small(named(text, in_rig)) is small


@pytest.mark.parametrize(
    ("has_ms", "low_ms", "high_ms", "same"),
    [(20.0, 19.8, 20.4, True), (20.0, 20.1, 20.4, False), (0.0, -1.0, 1.0, True)],
)
def test_what_the_rig_has_just_so_is_no_cause(has_ms: float, low_ms: float, high_ms: float, same: bool) -> None:  # noqa: FBT001 - parametrized
    """Of another size is one whose interval the rig's is not in; of an effect that the rig has not any is."""
    size = Parameter("delay_ms", 0.5 * (low_ms + high_ms), low_ms, high_ms, "ms")
    cause = replace(named("latency:delay_ms=20.2", f"latency:delay_ms={has_ms}"), parameters=(size,))
    assert cause.is_as_in_rig is same
    assert not replace(named("latency:delay_ms=20.2"), parameters=(size,)).is_as_in_rig


def test_what_costs_nothing_is_no_cause() -> None:
    """It is told beside what it costs; what costs as much as the bound stays, and so does what nobody asked for."""
    verdict = judged(evidence({"rate": 10.0, "clock_ratio": 9.0}, RATE, DRIFT))
    assert {cause.effect.name for cause in verdict.causes} == {"scale_factor", "clock_drift"}
    aside = set_aside(verdict, {"clock_drift": 0.01})
    assert [cause.effect.name for cause in aside.causes] == ["scale_factor"]
    assert [(one.cause.effect.name, one.yaw_deg) for one in aside.negligible] == [("clock_drift", 0.01)]
    assert aside.kind is Kind.EFFECT
    assert {cause.effect.name for cause in aside.acting} == {"scale_factor", "clock_drift"}
    assert set_aside(verdict, {"clock_drift": NEGLIGIBLE_DEG}) == verdict
    assert set_aside(verdict, {}) == verdict


def test_where_all_that_acts_costs_nothing_there_is_no_gap() -> None:
    """Unless something is left over that nothing explains."""
    whole = judged(evidence({"rate": 10.0}, RATE, DRIFT))
    part = judged(evidence({"rate": 10.0, "temperature_rate": 4.0}, RATE, DRIFT))
    assert set_aside(whole, {"scale_factor": 0.0}).kind is Kind.NONE
    assert set_aside(part, {"scale_factor": 0.0}).kind is Kind.UNKNOWN
    assert set_aside(whole, {"scale_factor": 0.0}).causes == ()


def test_a_cause_has_the_phase_of_each_session() -> None:
    """Where phases are free; where the rig has it, that which it has in the session; elsewhere its own everywhere."""
    tilt = "g_sensitivity:amplitude_dps=0.1,phase_deg=30"
    one = named(tilt)
    assert one.in_session(1, ()) == one.effect
    free = replace(
        one, cause=replace(one.cause, response=replace(one.cause.response, phases_deg=np.array([10.0, 200.0])))
    )
    assert free.in_session(1, ()).model_dump()["phase_deg"] == 200.0
    shown = one.effect.model_copy(update={"phase_deg": 120.0})
    in_rig = named("g_sensitivity:amplitude_dps=0.2,phase_deg=30", tilt)
    assert in_rig.in_session(0, (shown,)).model_dump() == {
        "name": "g_sensitivity",
        "amplitude_dps": 0.2,
        "phase_deg": 120.0,
    }
