"""The campaign of faults, a part of it: what arrived is not lost, and what was not sent passes no checksum."""

import os
from datetime import UTC, datetime

import pytest
from robustness.campaign import PROTOCOLS, run, summary, table
from robustness.strengths import STRENGTHS, Pair, pairs

QUICK = ("bit_flips", "zeros", "unplug")
DESTROYED = {
    *("bit_flips", "dropped_bytes", "duplicated_bytes", "merged_frames", "truncated_frames"),
    *("unplug", "wrong_baud"),
}


@pytest.mark.parametrize("name", STRENGTHS)
def test_no_fault_breaks_a_promise_of_the_checked_protocol(name: str) -> None:
    """At the middle strength; `make faults` has all of them, alone and in pairs."""
    row = run("native", ((name, 2),))
    assert row.broken_promises() == []
    assert (row.tally.lost_by_link > 0) == (name in DESTROYED)


@pytest.mark.parametrize("protocol", [each for each in PROTOCOLS if each != "native"])
@pytest.mark.parametrize("name", QUICK)
def test_what_a_protocol_without_a_checksum_lets_through_is_bounded(protocol: str, name: str) -> None:
    """No more wrong samples than damaged ones."""
    assert run(protocol, ((name, 3),)).broken_promises() == []


HARD_PAIRS = (
    (("wrong_baud", 1), ("unplug", 1)),
    (("wrong_baud", 2), ("unplug", 1)),
    (("merged_frames", 3), ("rate_change", 3)),
    (("millisecond_clock", 3), ("rate_change", 3)),
)
"""A HELLO that is damaged after a reconnect, and a slow rate that begins while frames are lost."""


@pytest.mark.parametrize("faults", HARD_PAIRS, ids=str)
def test_a_damaged_hello_and_a_rate_that_changes_amid_damage_cost_no_sample(faults: Pair) -> None:
    """Samples wait for their HELLO; the pace of the samples bears out a clock."""
    assert run("native", faults).broken_promises() == []


DRAWN, PARTS = 60, 6
"""Pairs of faults that are tried; `make faults` tries all."""


@pytest.mark.parametrize("part", range(PARTS))
def test_no_two_faults_at_once_break_a_promise_of_the_checked_protocol(part: int) -> None:
    """Others each day; a failure says which, and the date that drew them. GYRODRIFT_FAULT_DATE draws them again."""
    date = os.environ.get("GYRODRIFT_FAULT_DATE") or datetime.now(tz=UTC).date().isoformat()
    seed = int(date.replace("-", ""))
    rows = [run("native", both, seed) for both in pairs(DRAWN, seed)[part::PARTS]]
    broken = [(row.name, row.broken_promises()) for row in rows if row.broken_promises()]
    assert broken == [], f"GYRODRIFT_FAULT_DATE={date}"


def test_tables_have_a_line_for_each_run_and_for_each_protocol() -> None:
    """With what the link lost."""
    row = run("native", (("bit_flips", 3), ("unplug", 2)))
    assert row.tally.lost_by_link > 100
    assert "bit_flips 3 + unplug 2" in table([row])
    assert "| native | 1 |" in summary([row])
