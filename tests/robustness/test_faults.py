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


@pytest.mark.promise("Samples")
@pytest.mark.promise("Samples", "no wrong sample passes the CRC, except by chance: 1 in 65 536 damaged frames")
@pytest.mark.promise(
    "Samples", "under faults, yaw stays within 1 degree of the run without them, except for turns while no sample came"
)
@pytest.mark.promise("Recovery", "after damage, resets and outages, samples continue within 1 s of device time")
@pytest.mark.parametrize("name", STRENGTHS)
def test_no_fault_breaks_a_promise_of_the_checked_protocol(name: str) -> None:
    """The service loses no intact native frame, under any single fault of the simulated device."""
    row = run("native", ((name, 2),))
    assert row.broken_promises() == []
    assert (row.tally.lost_by_link > 0) == (name in DESTROYED)


@pytest.mark.promise("Samples")
@pytest.mark.parametrize("protocol", [item for item in PROTOCOLS if item != "native"])
@pytest.mark.parametrize("name", QUICK)
def test_what_a_protocol_without_a_checksum_lets_through_is_bounded(protocol: str, name: str) -> None:
    """Without a CRC (csv, witmotion), there are at most as many wrong samples as damaged frames."""
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


DRAWN = 8
"""Pairs of faults that are tried; `make faults` tries all."""


@pytest.mark.promise("Samples")
def test_no_two_faults_at_once_break_a_promise_of_the_checked_protocol() -> None:
    """The service loses no intact native frame under any two faults (8 of 1224 pairs; `make faults` runs all)."""
    date = os.environ.get("GYRODRIFT_FAULT_DATE") or datetime.now(tz=UTC).date().isoformat()
    seed = int(date.replace("-", ""))
    rows = [run("native", pair, seed) for pair in pairs(DRAWN, seed)]
    broken = [(row.name, row.broken_promises()) for row in rows if row.broken_promises()]
    assert broken == [], f"GYRODRIFT_FAULT_DATE={date}"


def test_tables_have_a_line_for_each_run_and_for_each_protocol() -> None:
    row = run("native", (("bit_flips", 3), ("unplug", 2)))
    assert row.tally.lost_by_link > 100
    assert "bit_flips 3 + unplug 2" in table([row])
    assert "| native | 1 |" in summary([row])
