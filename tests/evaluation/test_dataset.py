"""Which sessions train, which test."""

from pathlib import Path

import pytest

from gyrodrift.errors import DataError
from gyrodrift.evaluation.dataset import SessionSummary, Source, Split, check_rates, split_sources


def sources(count: int, tests: int = 0) -> list[Source]:
    return [Source(Path(f"{i}.csv"), split=Split.TEST if i < tests else None) for i in range(count)]


def test_of_many_a_share_is_kept_apart_by_the_seed() -> None:
    """Three in ten; the same ones for the same seed."""
    chosen = {seed: [s.split for s in split_sources(sources(20), seed)] for seed in (1, 2)}
    assert chosen[1].count(Split.TEST) == 6
    assert chosen[1] == [s.split for s in split_sources(sources(20), 1)] != chosen[2]


@pytest.mark.parametrize("count", [2, 5])
def test_of_a_few_none_is_held_out(count: int) -> None:
    """They are left out one by one instead."""
    assert {s.split for s in split_sources(sources(count), 1)} == {Split.TRAIN}


def test_where_tests_are_named_all_others_train() -> None:
    """However few."""
    assert [s.split for s in split_sources(sources(3, tests=2), 1)] == [Split.TEST, Split.TEST, Split.TRAIN]


@pytest.mark.parametrize(("count", "tests"), [(1, 0), (2, 2)])
def test_none_to_train_with_is_told(count: int, tests: int) -> None:
    """As is one alone."""
    with pytest.raises(DataError, match=r"is the only session|there are no sessions to tune on"):
        split_sources(sources(count, tests), 1)


def test_rates_may_differ_by_a_crystal_and_no_more() -> None:
    """Two percent."""

    def sessions(*rates_hz: float) -> list[SessionSummary]:
        return [SessionSummary(f"at {rate_hz:g}", "", 1.0, rate_hz) for rate_hz in rates_hz]

    assert check_rates(sessions(100.0, 101.0, 99.5), "steps") == []
    (said,) = check_rates(sessions(100.0, 50.0, 100.0), "steps")
    assert said.startswith("sample rates differ, from 50 Hz (at 50) to 100 Hz (at 100): steps count samples")
