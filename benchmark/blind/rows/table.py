"""The rows of the set `bench`: how many cases each has, and who draws them."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from gyrogap.physics.dice import Path as DicePath
from gyrogap.physics.dice import Rng, plan_dice

from blind.rows import baseline, generated, simulated
from blind.rows.case import Draft, RowCase, name_of, path_of
from blind.rows.recordings import devices
from blind.rows.wrong_size import wrong_size

MOST_CASES = 10_000


@dataclass(frozen=True, slots=True)
class Row:
    """`count` cases where nobody asks for another number; `is_possible` says no where data are missing."""

    count: int
    draw: Callable[[Rng, int, DicePath], Draft]
    is_possible: Callable[[], bool] = lambda: True


def _has_recordings() -> bool:
    return bool(devices())


ROWS = {
    "none_own": Row(100, simulated.no_gap),
    "none_short": Row(0, simulated.short_no_gap),
    "none_generator": Row(100, generated.no_gap),
    "none_driven": Row(30, generated.driven),
    "single": Row(54, generated.clear),
    "small": Row(27, generated.small),
    "outside": Row(44, generated.outside),
    "pair": Row(24, generated.pair),
    "triple": Row(24, generated.triple),
    "left_out": Row(27, generated.left_out),
    "loop": Row(40, generated.loop),
    "wrong_size": Row(46, wrong_size),
    "baseline": Row(40, baseline.with_effect, _has_recordings),
    "baseline_none": Row(40, baseline.without_effect, _has_recordings),
}
"""`none_short` runs where it is asked for by name and count, as `make evaluate` does."""


def draw_case(seed: int, row: str, number: int) -> RowCase:
    """A case by its number in its row."""
    path = path_of(seed, row, number)
    return RowCase(seed, row, number, ROWS[row].draw(plan_dice((*path, "plan")), number, path))


def draw_rows(seed: int, rows: list[str], count: int | None) -> Iterator[RowCase]:
    """The first `count` cases of the rows that are named; where none is, of all rows, and no more than each has."""
    for row in filter(lambda row: ROWS[row].is_possible(), rows or ROWS):
        usual = ROWS[row].count
        wanted = usual if count is None else count if rows else min(count, usual)
        yield from (draw_case(seed, row, number) for number in range(wanted))


def impossible_rows(rows: list[str]) -> list[str]:
    """Those of the rows asked for, all where none is named, that lack the recordings they are made of."""
    return [row for row in rows or ROWS if not ROWS[row].is_possible()]


def find_case(seed: int, name: str) -> RowCase | None:
    """A case by its public name, or by row and number as in `none_own/12`."""
    row, _, number = name.partition("/")
    if row in ROWS and number.isdecimal():
        return draw_case(seed, row, int(number))
    return _search(seed, name)


def _search(seed: int, name: str) -> RowCase | None:
    for number in range(MOST_CASES):
        for row in ROWS:
            if name_of(seed, row, number) == name:
                return draw_case(seed, row, number)
    return None
