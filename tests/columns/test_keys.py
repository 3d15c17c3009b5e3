"""A column that names the sender of a row, and two senders without such a column."""

from random import Random

import pytest

from gyrodrift.columns.keys import has_two_senders, keys_of

DICE = Random(1)


@pytest.mark.parametrize(
    ("texts", "keys"),
    [
        ("AB" * 10, ("A", "B")),
        ("AAB" * 8, ("A", "B")),
        ("ABABBAABAABBABAB", ("A", "B")),
        (["1", "2"] * 10, ("1", "2")),
        (["17", "4", "9"] * 8, ("17", "4", "9")),
        (["0x61", "0x62"] * 8, ("0x61", "0x62")),
    ],
    ids=["nodes", "one is faster", "by radio", "numbers", "three", "addresses"],
)
def test_what_alternates_among_few_is_a_key(texts: list[str], keys: tuple[str, ...]) -> None:
    assert keys_of(texts) == keys


@pytest.mark.parametrize(
    "texts",
    [
        [str(i) for i in range(40)],
        [str(i % 8) for i in range(40)],
        ["0"] * 20 + ["1"] * 20,
        [str(DICE.choice((-1, 0, 0, 1))) for _ in range(200)],
        [str(DICE.choice((3, 4))) for _ in range(200)],
        ["ok"] * 30 + ["hot"] * 3,
        "AB",
    ],
    ids=["counter", "short counter", "rest", "rate in steps", "two counts", "state", "too few"],
)
def test_other_columns_are_no_key(texts: list[str]) -> None:
    assert keys_of(texts) == ()


def test_two_clocks_side_by_side_are_two_senders() -> None:
    hub = [time for i in range(20) for time in (1000.0 + 20 * i, 912_345.0 + 20 * i)]
    assert has_two_senders(hub)
    near = [time for i in range(20) for time in (1000.0 + 20 * i, 993.0 + 20 * i)]
    assert has_two_senders(near)


def test_steps_that_alternate_need_two_levels() -> None:
    times = [time for i in range(20) for time in (20.0 * i, 20.0 * i + 7)]
    rates = [rate + DICE.gauss(0.0, 0.05) for _ in range(20) for rate in (0.5, -0.4)]
    assert has_two_senders(times, rates)
    assert not has_two_senders(times, [DICE.gauss(0.0, 0.05) for _ in times])
    assert not has_two_senders(times)


@pytest.mark.parametrize(
    "times",
    [
        [20.0 * i for i in range(40)],
        [20.0 * (i % 20) for i in range(40)],
        [20.0 * i - 30.0 * (i == 9) for i in range(40)],
        [float(i // 2) for i in range(40)],
    ],
    ids=["one clock", "a restart", "a glitch", "coarse"],
)
def test_one_clock_is_one_sender(times: list[float]) -> None:
    assert not has_two_senders(times)
