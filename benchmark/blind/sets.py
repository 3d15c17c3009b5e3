"""All sets by name: those of recipes and the rows of the set `bench`, a case of either with the same face."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from blind import recipes as by_recipe
from blind.recipes import Recipe, recipes, write_case
from blind.rows.case import RowCase
from blind.rows.table import draw_rows, find_case

BENCH = "bench"
SEEDS = by_recipe.SEEDS | {BENCH: 4711}


@dataclass(frozen=True, slots=True)
class Case:
    """What running a set needs of a case.

    title
        Among those who know.
    withhold, then
        Of a second run: an effect that it must do without, or the folder that it is of.
    """

    name: str
    title: str
    withhold: str
    then: str
    label: Callable[[], dict[str, Any]]
    write: Callable[[Path], None]


def cases_of(set_name: str, seed: int, rows: Iterable[str] = (), count: int | None = None) -> list[Case]:
    """The cases of a set; `rows` and `count` choose in the set `bench`."""
    if set_name == BENCH:
        return [_of_row(case) for case in draw_rows(seed, list(rows), count)]
    return [_of_recipe(recipe) for recipe in recipes(set_name, seed)]


def case_of(set_name: str, seed: int, name: str) -> Case | None:
    """One of them by its public name."""
    if set_name == BENCH:
        found = find_case(seed, name)
        return _of_row(found) if found else None
    return next((case for case in cases_of(set_name, seed) if case.name == name), None)


def _of_row(case: RowCase) -> Case:
    return Case(case.name, case.title, case.draft.withhold, case.draft.then, case.label, case.write)


def _of_recipe(recipe: Recipe) -> Case:
    return Case(recipe.name, recipe.title, recipe.withhold, "", recipe.label, partial(write_case, recipe))
