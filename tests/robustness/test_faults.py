"""The campaign of faults, a part of it: what arrived is not lost, and what was not sent passes no checksum."""

import pytest

from robustness.campaign import PROTOCOLS, run, summary, table
from robustness.strengths import STRENGTHS

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


def test_two_faults_at_once_break_nothing_either() -> None:
    """And the tables have a line for each run and for each protocol."""
    rows = [run("native", (("bit_flips", 3), ("unplug", 2))), run("native", (("stall", 2), ("reset", 2)))]
    assert [row.broken_promises() for row in rows] == [[], []]
    assert rows[0].tally.lost_by_link > 100
    assert "bit_flips 3 + unplug 2" in table(rows)
    assert "| native | 2 |" in summary(rows)
