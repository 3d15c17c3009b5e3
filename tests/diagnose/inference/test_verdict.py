"""The verdict: causes as in the rig, small causes, causes that cost nothing, and what is left without some of them."""

from dataclasses import replace

import numpy as np
import pytest
from inference_support import Amounts, candidate, concluded, simulated

from firmware_sim.rig import parse_effect
from gyrodrift.diagnose.inference.parameters import Parameter
from gyrodrift.diagnose.inference.verdict import (
    NEGLIGIBLE_DEG,
    Kind,
    NamedCause,
    is_small,
    with_negligible,
)
from gyrodrift.diagnose.simulate.response_table import Sized

TRIED = (
    simulated("scale_factor", {"rate": 2.0}),
    simulated("clock_drift", {"clock_ratio": 3.0}),
    simulated("?moving", {"moving": 2.0, "direction": 1.0}),
)
PAIR: Amounts = {"rate": 10.0, "clock_ratio": 9.0}


def named(text: str, in_rig: str | None = None) -> NamedCause:
    """A cause as it is named, of an effect that a rig may have at another size."""
    effect = parse_effect(text)
    tried = replace(candidate(effect.name), in_rig=parse_effect(in_rig) if in_rig else None)
    return NamedCause(Sized(tried, 1.0), effect, "group", "", 0.9, 0.9, (), ())


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
def test_an_effect_of_the_rig_within_the_interval_is_no_cause(
    has_ms: float,
    low_ms: float,
    high_ms: float,
    same: bool,  # noqa: FBT001 - parametrized
) -> None:
    """An effect that the rig has not is one at any interval."""
    size = Parameter("delay_ms", 0.5 * (low_ms + high_ms), low_ms, high_ms, "ms")
    cause = replace(named("latency:delay_ms=20.2", f"latency:delay_ms={has_ms}"), parameters=(size,))
    assert cause.is_as_in_rig is same
    assert not replace(named("latency:delay_ms=20.2"), parameters=(size,)).is_as_in_rig


def test_what_costs_nothing_is_no_cause() -> None:
    verdict = concluded(PAIR, *TRIED).verdict
    assert {cause.effect.name for cause in verdict.causes} == {"scale_factor", "clock_drift"}
    aside = with_negligible(verdict, {"clock_drift": 0.01})
    assert [cause.effect.name for cause in aside.causes] == ["scale_factor"]
    assert [(item.cause.effect.name, item.yaw_deg) for item in aside.negligible] == [("clock_drift", 0.01)]
    assert aside.kind is Kind.EFFECT
    assert {cause.effect.name for cause in aside.acting} == {"scale_factor", "clock_drift"}
    assert with_negligible(verdict, {"clock_drift": NEGLIGIBLE_DEG}) == verdict
    assert with_negligible(verdict, {}) == verdict


def test_causes_are_told_to_people_by_their_expected_share_of_the_gap() -> None:
    """A cause of most of the gap comes before a certain cause of a fiftieth; the probability is that with its ties."""
    certain = replace(named("vibration:amplitude_dps=0.07,frequency_hz=31"), group_probability=0.96, gap_share=0.02)
    large = replace(named("usb_batching:interval_ms=50"), probability=0.4, group_probability=0.6, gap_share=0.75)
    verdict = replace(concluded(PAIR, *TRIED).verdict, causes=(certain, large))
    assert verdict.causes_by_share == (large, certain)
    assert large.expected_share == pytest.approx(0.45)
    equal = replace(verdict, causes=tuple(replace(cause, gap_share=0.0) for cause in (large, certain)))
    assert equal.causes_by_share[0].effect.name == "vibration"


def test_where_all_that_acts_costs_nothing_there_is_no_gap() -> None:
    whole = concluded({"rate": 10.0}, *TRIED).verdict
    part = concluded({"rate": 10.0, "temperature_rate": 12.0}, *TRIED).verdict
    assert (whole.kind, part.kind) == (Kind.EFFECT, Kind.PARTLY)
    assert with_negligible(whole, {"scale_factor": 0.0}).kind is Kind.NONE
    assert with_negligible(part, {"scale_factor": 0.0}).kind is Kind.UNKNOWN
    assert with_negligible(whole, {"scale_factor": 0.0}).causes == ()


def test_a_cause_has_the_phase_of_each_session() -> None:
    tilt = "g_sensitivity:amplitude_dps=0.1,phase_deg=30"
    item = named(tilt)
    assert item.in_session(1, ()) == item.effect
    free = replace(item, cause=item.cause._replace(phases_deg=np.array([10.0, 200.0])))
    assert free.in_session(1, ()).model_dump()["phase_deg"] == 200.0
    shown = item.effect.model_copy(update={"phase_deg": 120.0})
    in_rig = named("g_sensitivity:amplitude_dps=0.2,phase_deg=30", tilt)
    assert in_rig.in_session(0, (shown,)).model_dump() == {
        "name": "g_sensitivity",
        "amplitude_dps": 0.2,
        "phase_deg": 120.0,
    }
