"""The table of the set `bench` on answers made by hand."""

from dataclasses import replace
from typing import Any

import pytest
from blind import judge
from blind.bench_rows import bench_rows
from blind.gap import read_gap
from blind.score import Share, score
from blind.table import markdown
from blind.tried import Tried
from blind_support import case, cause, gap, outcome

LAG = {"latency": {"delay_ms": 8.0}}
LIMIT = {"saturation": {"limit_dps": 125.0}}


def share(tried: list[Tried], what: str) -> Share:
    return next(row for row in bench_rows(tried) if row.what.startswith(what))


def counts(row: Share) -> tuple[int, int]:
    return row.hits, row.total


def shows(**least: dict[str, Any]) -> Any:
    """A quiet verdict that says what would have been seen."""
    return gap("none") | {"detectable": least}


def in_rig(effect: str, stated: float, **parameters: float) -> dict[str, Any]:
    """A cause that the rig has at another size."""
    return cause(effect, 0.9, **parameters) | {"in_rig": dict.fromkeys(parameters, stated)}


def test_no_gap_is_scored_by_who_made_it() -> None:
    tried = [
        case("none", gap("none"), row="none_own"),
        case("none", gap("unknown"), row="none_own"),
        case("none", gap("none"), row="none_generator"),
        case("none", None, row="none_generator"),
    ]
    own, second = (share(tried, f"no gap, {who}") for who in ("own simulator: ", "generator"))
    assert (counts(own), counts(second)) == ((1, 2), (1, 2))
    assert "c0ffee (seed 9, none_own/2): typical no gap, of a test → unknown" in own.misses[0]


@pytest.mark.parametrize(
    ("least", "is_seen"),
    [
        ({"latency": {"delay_ms": 7.9, "unit": "ms"}}, True),
        ({"latency": {"delay_ms": 8.1, "unit": "ms"}}, False),
        ({"spikes": {"height_dps": 1.0, "unit": "deg/s"}}, False),
        ({}, True),
    ],
)
def test_what_could_not_be_seen_is_told_apart(least: dict[str, Any], *, is_seen: bool) -> None:
    tried = [case("single", gap("none"), LAG, row="single", without=shows(**least))]
    assert share(tried, "effect named first or tied first, typical").total == is_seen
    apart = share(tried, "said to be too small to be seen, typical and large: none")
    assert counts(apart) == (not is_seen, not is_seen)


def test_what_is_read_off_the_recordings_is_not_excused_for_being_read_off() -> None:
    tried = [case("single", gap("none"), LIMIT, row="single", without=shows(latency={"delay_ms": 7.9}))]
    assert counts(share(tried, "group named first, typical")) == (0, 1)


@pytest.mark.parametrize(("least", "is_seen"), [(126.0, True), (124.0, False)])
def test_a_limit_is_larger_the_lower_it_is(least: float, *, is_seen: bool) -> None:
    tried = [case("single", gap("none"), LIMIT, row="single", without=shows(saturation={"limit_dps": least}))]
    assert share(tried, "group named first, typical").total == is_seen


@pytest.mark.parametrize(("least_dps", "is_seen"), [(124.0, False), (126.0, True)])
def test_a_pair_is_told_apart_where_either_could_not_be_seen(least_dps: float, *, is_seen: bool) -> None:
    statement = gap("effect", cause("latency"), cause("saturation"))
    without = shows(latency={"delay_ms": 7.9}, saturation={"limit_dps": least_dps})
    tried = [case("pair", statement, LAG | LIMIT, row="pair", without=without)]
    assert counts(share(tried, "pairs: both named, nothing else")) == (1, 1)
    assert counts(share(tried, "pairs, neither")) == (is_seen, is_seen)


@pytest.mark.parametrize(
    ("cost_deg", "answer", "costly", "report", "told_or_none"),
    [
        (0.29, "none", (0, 0), (0, 1), (1, 1)),
        (0.29, "unknown", (0, 0), (1, 1), (1, 1)),
        (0.31, "none", (0, 1), (0, 0), (0, 0)),
        (0.31, "unknown", (1, 1), (0, 0), (0, 0)),
        (None, "none", (0, 1), (0, 0), (0, 0)),
    ],
)
def test_what_costs_nothing_may_be_none(
    cost_deg: float | None, answer: str, costly: tuple[int, int], report: tuple[int, int], told_or_none: tuple[int, int]
) -> None:
    """Outside the catalogue. In the row of all of them it is missed; and what nobody worked out is no small cost."""
    tried = [replace(case("outside", gap(answer), row="outside"), yaw_cost_deg=cost_deg)]
    rows = {
        "costs 0.3": costly,
        "costs less: at the right stage": report,
        "costs less: at the right stage, or": told_or_none,
    }
    assert {what: counts(share(tried, f"outside the catalogue, {what}")) for what in rows} == rows
    assert counts(share(tried, "outside the catalogue: unknown or partly, at the right")) == (answer == "unknown", 1)


def test_a_failed_look_beforehand_excuses_nothing() -> None:
    tried = [case("single", gap("none"), LAG, row="small", size="small")]
    assert counts(share(tried, "group named first, small")) == (0, 1)


@pytest.mark.parametrize(
    ("answer", "is_invented"),
    [
        (gap("effect", cause("latency", 0.95)), False),
        (gap("effect", cause("spikes", 0.85), cause("latency", 0.9)), True),
        (gap("effect", cause("spikes", 0.7)), False),
        (gap("unknown", cause("spikes", 0.9)), False),
        (None, True),
    ],
)
def test_a_confident_cause_has_to_be_there(answer: Any, *, is_invented: bool) -> None:
    """A failure counts as one that is not; a list beside "unknown" names nothing."""
    assert judge.invents(outcome(answer), {"latency"}) == is_invented


def test_a_loop_counts_where_there_was_something_to_adopt() -> None:
    """New sessions have to be quiet against the rig that was adopted."""
    named = gap("effect", cause("latency"))
    tried = [
        case("loop", named, LAG, row="loop", again=gap("none")),
        case("loop", named, LAG, row="loop", again=gap("effect", cause("spikes"))),
        case("loop", named, LAG, row="loop"),
        case("loop", gap("unknown"), LAG, row="loop"),
    ]
    assert counts(share(tried, "loop: there is")) == (3, 4)
    closed = share(tried, "loop: adopted")
    assert counts(closed) == (1, 3)
    assert "→ effect, spikes 0.90" in closed.misses[0]


@pytest.mark.parametrize(
    ("answer", "is_right", "is_named"),
    [
        (gap("effect", in_rig("latency", 25.0, delay_ms=9.5)), True, True),
        (gap("effect", in_rig("latency", 25.0, delay_ms=9.7)), False, True),
        (gap("effect", cause("latency", 0.9, delay_ms=8.0)), False, False),
        (gap("effect", in_rig("spikes", 1.0, height_dps=8.0)), False, False),
        (gap("none"), False, False),
    ],
)
def test_a_wrong_size_is_named_as_that(answer: Any, *, is_right: bool, is_named: bool) -> None:
    """The cause says what the rig has, and its new size is within 20 %; a second one of the kind does not count."""
    tried = [case("wrong_size", answer, LAG, row="wrong_size")]
    assert counts(share(tried, "in the rig at a wrong size: named as that, new")) == (is_right, 1)
    assert share(tried, "in the rig at a wrong size: named as that").what
    assert judge.names_wrong_size(tried[0].blind, "latency") == is_named


def test_real_recordings_have_rows_of_their_own() -> None:
    """The group is what counts; without an effect anything but "none" is an alarm, and fewer is better."""
    tried = [
        case("baseline", gap("effect", cause("bandwidth")), LAG, row="baseline"),
        case("baseline", gap("effect", cause("spikes")), LAG, row="baseline"),
        case("none", gap("none"), row="baseline_none"),
        case("none", gap("partly", cause("spikes")), row="baseline_none"),
    ]
    assert counts(share(tried, "put into real recordings, against a baseline: group")) == (1, 2)
    alarms = share(tried, "real recordings against a baseline")
    assert counts(alarms) == (1, 2)
    assert alarms.is_most
    assert len(alarms.misses) == 1


def test_what_the_rig_has_is_read() -> None:
    statement = read_gap(
        gap("effect", in_rig("latency", 25.0, delay_ms=8.0))
        | {"detectable": {"spikes": {"height_dps": 2, "unit": "deg/s"}}}
    )
    assert statement.causes[0].in_rig == {"delay_ms": 25.0}
    assert statement.detectable == {"spikes": {"height_dps": 2.0}}


@pytest.mark.parametrize(("step_deg", "is_seen"), [(0.6, True), (0.5, True), (0.3, False)])
def test_of_jumps_less_high_than_those_it_speaks_of_nothing_is_said(step_deg: float, *, is_seen: bool) -> None:
    without = shows(encoder_slip={"per_hour": 20.0, "unit": "1/h", "at": {"step_deg": 0.5}})
    item = case(
        "single", gap("none"), {"encoder_slip": {"per_hour": 40.0, "step_deg": step_deg}}, row="single", without=without
    )
    shown = counts(share([item], "group named first, typical"))
    assert shown == ((0, 1) if is_seen else (0, 0))


def test_the_whole_table_can_be_printed() -> None:
    """Rows that were not run say so."""
    text = markdown(score([case("none", gap("none"), row="none_own")], bench_rows))
    assert "| no gap, own simulator: none | ≥ 95 % | 100.0 % | 1 of 1 |" in text
    assert "| no gap, generator: none | ≥ 95 % | not tried |" in text
