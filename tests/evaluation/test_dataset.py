"""Split of sessions into training and test."""

from pathlib import Path

import pytest

from gyrodrift.evaluation.dataset import SessionSummary, Source, Split, check_rates, split_sources
from gyrodrift.values.errors import DataError


def sources(count: int, tests: int = 0) -> list[Source]:
    return [Source(Path(f"{i}.csv"), split=Split.TEST if i < tests else None) for i in range(count)]


def test_the_seed_chooses_the_held_out_share() -> None:
    chosen = {seed: [s.split for s in split_sources(sources(20), seed)] for seed in (1, 2)}
    assert chosen[1].count(Split.TEST) == 6
    assert chosen[1] == [s.split for s in split_sources(sources(20), 1)] != chosen[2]


@pytest.mark.parametrize("count", [2, 5])
def test_of_at_most_five_sessions_none_is_held_out(count: int) -> None:
    """Cross-validation leaves out a session at a time."""
    assert {s.split for s in split_sources(sources(count), 1)} == {Split.TRAIN}


def test_sessions_that_are_not_tests_are_for_training() -> None:
    assert [s.split for s in split_sources(sources(3, tests=2), 1)] == [Split.TEST, Split.TEST, Split.TRAIN]


@pytest.mark.parametrize(("count", "tests"), [(1, 0), (2, 2)])
def test_a_split_without_training_sessions_is_refused(count: int, tests: int) -> None:
    """A single session cannot be split either."""
    with pytest.raises(DataError, match=r"is the only session|there are no sessions to tune on"):
        split_sources(sources(count, tests), 1)


def test_sample_rates_that_differ_by_more_than_2_percent_give_a_warning() -> None:
    """The warning names the slowest and the fastest session."""

    def sessions(*rates_hz: float) -> list[SessionSummary]:
        return [SessionSummary(f"at {rate_hz:g}", "", 1.0, rate_hz) for rate_hz in rates_hz]

    assert check_rates(sessions(100.0, 101.0, 99.5), "steps") == []
    (warning,) = check_rates(sessions(100.0, 50.0, 100.0), "steps")
    assert warning.startswith("sample rates differ, from 50 Hz (at 50) to 100 Hz (at 100): steps count samples")
