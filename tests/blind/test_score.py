"""The scorer on answers made by hand: right, wrong, tied, too sure, failed."""

from typing import Any

import pytest
from blind import judge
from blind.bench_rows import bench_rows
from blind.gap import Cause, read_outcome
from blind.probabilities import brier, reliability
from blind.score import Score, Share
from blind.score import score as score_by
from blind.table import as_json, markdown, terminal_text
from blind.tried import Tried
from blind_support import case, cause, gap, outcome
from gyrogap.chance import wilson
from scipy.stats import binomtest

SCALE = {"scale_factor": {"error_percent": 1.0}}
LAG = {"latency": {"delay_ms": 8.0}}
TWO = {"scale_factor": {"error_percent": 1.0}, "latency": {"delay_ms": 8.0}}


def score(tried: list[Tried]) -> Score:
    return score_by(tried, bench_rows)


def share(tried: list[Tried], what: str) -> Share:
    return next(row for row in score(tried).shares if row.what.startswith(what))


@pytest.mark.parametrize(
    ("statement", "group", "tied"),
    [
        (gap("effect", cause("latency")), True, True),
        (gap("partly", cause("latency"), leftover="sensor"), True, True),
        (gap("effect", cause("bandwidth")), True, False),
        (gap("effect", cause("bandwidth", 0.5, "latency")), True, True),
        (gap("effect", cause("warmup"), cause("latency")), False, False),
        (gap("effect", cause("warmup")), False, False),
        (gap("unknown", cause("latency", 0.2)), False, False),
        (gap("none"), False, False),
        (None, False, False),
    ],
)
def test_a_single_effect(statement: Any, *, group: bool, tied: bool) -> None:
    report = outcome(statement)
    assert judge.names_group_first(report, "latency") == group
    assert judge.names_first_or_tied(report, "latency") == tied


@pytest.mark.parametrize(
    ("statement", "is_alarm"), [(gap("none"), False), (gap("effect", cause("spikes")), True), (gap("unknown"), True)]
)
def test_no_gap(statement: Any, *, is_alarm: bool) -> None:
    assert judge.raises_alarm(outcome(statement)) == is_alarm


@pytest.mark.parametrize(
    ("statement", "is_fine"),
    [
        (gap("unknown", where="link"), True),
        (gap("unknown", where="sensor"), False),
        (gap("partly", cause("usb_batching", 0.9), where="sensor", leftover="link"), True),
        (gap("partly", cause("usb_batching", 0.9), where="link", leftover="sensor"), False),
        (gap("effect", cause("usb_batching", 0.9), where="link"), False),
        (gap("none", where="link"), False),
        (None, False),
    ],
)
def test_outside_the_catalogue(statement: Any, *, is_fine: bool) -> None:
    """The verdict "unknown" is judged by where the gap is, "partly" by where the leftover is."""
    assert judge.abstains_at(outcome(statement), ("link", "clock")) == is_fine


@pytest.mark.parametrize(
    ("statement", "is_not_fooled", "admits"),
    [
        (gap("unknown"), True, True),
        (gap("partly", cause("bandwidth", 0.9), leftover="sensor"), True, True),
        (gap("partly", cause("warmup", 0.9), leftover="sensor"), True, False),
        (gap("partly", cause("warmup", 0.5), leftover="sensor"), True, True),
        (gap("effect", cause("bandwidth", 0.9)), False, False),
        (gap("effect", cause("bandwidth", 0.5)), True, False),
        (gap("none"), True, False),
        (None, False, False),
    ],
)
def test_with_the_true_effect_withheld(statement: Any, *, is_not_fooled: bool, admits: bool) -> None:
    """A confident cause needs a leftover; strictly, it has to be of the right group too."""
    assert judge.is_not_fooled(outcome(statement)) == is_not_fooled
    assert judge.admits_what_is_missing(outcome(statement), "latency") == admits


@pytest.mark.parametrize(
    ("statement", "alone", "pair"),
    [
        (gap("effect", cause("latency"), cause("scale_factor")), True, True),
        (gap("effect", cause("bandwidth", 0.5, "latency"), cause("scale_factor")), True, True),
        (gap("effect", cause("latency"), cause("scale_factor"), cause("spikes", 0.85)), False, True),
        (gap("effect", cause("latency"), cause("scale_factor"), cause("spikes", 0.4)), True, True),
        (gap("effect", cause("latency", 0.9, "scale_factor")), False, False),
        (gap("effect", cause("latency"), cause("warmup")), False, False),
        (None, False, False),
    ],
)
def test_a_pair(statement: Any, *, alone: bool, pair: bool) -> None:
    assert judge.names_both(outcome(statement), ("latency", "scale_factor"), alone=True) == alone
    assert judge.names_both(outcome(statement), ("latency", "scale_factor"), alone=False) == pair


def test_a_failure_is_a_miss_everywhere() -> None:
    kinds: list[tuple[str, dict[str, dict[str, float]]]] = [
        ("single", LAG),
        ("none", {}),
        ("outside", {"motor_bias": {"step_dps": 0.1}}),
        ("pair", TWO),
        ("left_out", LAG),
    ]
    tried = [case(kind, None, effects) for kind, effects in kinds]
    actual = score(tried)
    assert actual.failures == len(kinds)
    for row in actual.shares:
        assert row.hits == (row.total if row.is_most else 0)
    assert "gap.json" in share(tried, "group named first, typical").misses[0]


@pytest.mark.parametrize(
    "result",
    [
        None,
        {"seconds": 1.0, "timed_out": True, "exit_status": -9, "gap": None},
        {"seconds": 1.0, "timed_out": False, "exit_status": 1, "gap": gap("none")},
        {"seconds": 1.0, "timed_out": False, "exit_status": 0, "gap": [1, 2]},
        {"seconds": 1.0, "timed_out": False, "exit_status": 0, "gap": gap("perhaps")},
        {"seconds": 1.0, "timed_out": False, "exit_status": 0, "gap": gap("effect", cause("spikes", 1.5))},
        {"seconds": 1.0, "timed_out": False, "exit_status": 0, "gap": gap("effect", {"effect": "spikes"})},
    ],
)
def test_what_cannot_be_read_is_a_failure(result: Any) -> None:
    """A missing result, a late one, a bad status, and every malformed `gap.json`."""
    report = read_outcome(result)
    assert report.said is None
    assert report.failure
    assert report.text.startswith("failed")


def test_sizes_have_rows_of_their_own() -> None:
    """Typical and large ones together, small ones apart."""
    right, wrong = gap("effect", cause("scale_factor")), gap("none")
    tried = [
        case("single", right, SCALE),
        case("single", right, SCALE, "large"),
        case("single", wrong, SCALE, "small", row="small"),
    ]
    assert (share(tried, "effect named first or tied first, typical").hits, 2) == (2, 2)
    small = share(tried, "effect named first or tied first, small")
    assert (small.hits, small.total) == (0, 1)
    assert "scale_factor (error_percent 1), of a test → none" in small.misses[0]


@pytest.mark.parametrize(("value", "hits"), [(1.19, 1), (0.81, 1), (1.21, 0), (-1.0, 0)])
def test_fitted_parameters(value: float, hits: int) -> None:
    named = case("single", gap("effect", cause("scale_factor", 0.9, error_percent=value)), SCALE)
    other_form = case(
        "single", gap("effect", cause("warmup", 0.9, amplitude_dps=1.0)), {"warmup": {"amplitude_dps": 9}}
    )
    row = share([named, case("single", gap("none"), SCALE), other_form], "fitted parameter")
    assert (row.hits, row.total) == (hits, 1)


def test_shrink_is_measured_against_the_oracle() -> None:
    """The median of the ratios; what was not named shrank nothing, an oracle that gains nothing is no measure."""
    right = gap("effect", cause("scale_factor"), shrink=0.8)
    best = gap("effect", cause("scale_factor"), shrink=0.9)
    tried = [
        case("single", right, SCALE, oracle=best),
        case("single", gap("none", shrink=0.0), SCALE, oracle=best),
        case("single", best, SCALE, oracle=best),
        case("single", right, SCALE, oracle=gap("none", shrink=0.0)),
        case("single", right, SCALE),
    ]
    actual = score(tried)
    assert actual.shrink_ratio == pytest.approx(0.8 / 0.9)
    assert actual.shrink_ratio_cases == 3


def test_the_effect_back_has_to_help() -> None:
    worse, better = gap("partly", cause("bandwidth"), leftover="sensor", after=2.0), gap("effect", cause("latency"))
    what = "left out: with the effect back less"
    assert share([case("left_out", better, LAG, withheld=worse)], what).hits == 1
    assert share([case("left_out", worse, LAG, withheld=better)], what).hits == 0


@pytest.mark.parametrize(("hits", "total"), [(0, 40), (1, 40), (20, 41), (54, 54)])
def test_wilson_agrees_with_scipy(hits: int, total: int) -> None:
    interval = binomtest(hits, total).proportion_ci(method="wilson")
    assert wilson(hits, total) == pytest.approx((interval.low, interval.high), abs=1e-4)


def test_probabilities_are_judged() -> None:
    """Brier's score, and how many of each bin came true."""
    stated = [(0.9, True), (0.95, True), (1.0, False), (0.3, False)]
    assert brier(stated) == pytest.approx((0.01 + 0.0025 + 1.0 + 0.09) / 4.0)
    assert brier([]) is None
    bins = reliability(stated)
    assert [(item.low, item.hits, item.total) for item in bins] == [(0.2, 0, 1), (0.9, 2, 3)]


def test_every_cause_that_is_stated_counts() -> None:
    """Right where the effect is in the case, wrong on data without a gap or with something outside."""
    tried = [
        case("pair", gap("effect", cause("latency", 0.9), cause("spikes", 0.1)), TWO),
        case("outside", gap("effect", cause("latency", 0.9)), {"motor_bias": {"step_dps": 0.1}}),
    ]
    assert score(tried).brier == pytest.approx((0.01 + 0.01 + 0.81) / 3.0)


def test_the_table_shows_goals_intervals_and_misses() -> None:
    actual = score([case("none", gap("none")), case("none", gap("effect", cause("spikes", 0.4)))])
    for text in (terminal_text(actual), markdown(actual)):
        assert "≤ 5 %" in text
        assert "1 of 2" in text
        assert "9 to 91 %" in text
        assert "no gap, of a test → effect, spikes 0.40" in text
        assert "not tried" in text
    row = next(row for row in as_json(actual)["shares"] if "false alarms" in row["what"])
    assert row["share"] == 0.5


def test_an_interval_holds_the_truth_or_not() -> None:
    """A size without an interval is judged by how near it is."""
    bounded = Cause("latency", 0.9, parameters={"delay_ms": 9.0}, intervals={"delay_ms": (8.0, 10.5)})
    assert judge.interval_holds(bounded, "delay_ms", 10.0)
    assert not judge.interval_holds(bounded, "delay_ms", 11.0)
    assert judge.interval_holds(Cause("latency", 0.9, parameters={"delay_ms": 9.0}), "delay_ms", 10.0)
