"""Which cases a set has, and that a case is the same whenever it is generated."""

from collections import Counter
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from blind.recipes import PART, SEEDS, Recipe, recipes, write_case
from gyrogap.catalogue import EFFECTS, EFFECTS_OF_STAGE
from gyrogap.physics.outside_sizes import OUTSIDE
from gyrogap.physics.sizes import STRENGTHS, draw_fault
from gyrogap.physics.write import HEADER

FINAL = recipes("final", SEEDS["final"])


def files_of(recipe: Recipe, folder: Path) -> dict[str, bytes]:
    write_case(recipe, folder)
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_the_final_set_is_whole() -> None:
    """Every effect at three sizes, forty cases without a gap, two sizes of each effect outside, pairs, one left out."""
    kinds = Counter(recipe.kind for recipe in FINAL)
    assert kinds["single"] == 3 * len(EFFECTS) == 81
    assert kinds["none"] >= 40
    assert kinds["outside"] == 2 * len(OUTSIDE) >= 20
    assert kinds["pair"] >= 20
    assert [recipe.withhold for recipe in FINAL if recipe.kind == "left_out"] == list(EFFECTS)


def test_something_is_withheld_from_data_without_a_gap_too() -> None:
    """So that a withheld effect does not mean that it is there."""
    assert sum(recipe.kind == "none" and recipe.withhold in EFFECTS for recipe in FINAL) >= 5


def test_names_tell_nothing() -> None:
    """They are all different, and sorted by name the kinds are mixed."""
    by_name = sorted(FINAL, key=lambda recipe: recipe.name)
    assert len({recipe.name for recipe in FINAL}) == len(FINAL)
    changes = sum(left.kind != right.kind for left, right in pairwise(by_name))
    assert changes > len(FINAL) / 2


@pytest.mark.parametrize("name", EFFECTS)
def test_development_and_final_sizes_differ(name: str) -> None:
    """No strength that the one draws is drawn by the other."""
    ranges = {}
    for part in ("development", "final"):
        drawn = [draw_fault(np.random.default_rng(seed), name, "typical", PART[part], 1.0) for seed in range(40)]
        ranges[part] = {abs(fault.parameters[STRENGTHS[name].parameter]) for fault in drawn}
    assert not ranges["development"] & ranges["final"]


def test_the_same_seed_gives_the_same_bytes(tmp_path: Path) -> None:
    """Of every file of a case; another seed gives others."""
    recipe = recipes("smoke", 11)[0]
    once = files_of(recipe, tmp_path / "once")
    assert files_of(recipes("smoke", 11)[0], tmp_path / "again") == once
    other = files_of(recipes("smoke", 12)[0], tmp_path / "other")
    assert other["sessions/session-1.csv"] != once["sessions/session-1.csv"]


def test_a_case_says_nothing_of_itself(tmp_path: Path) -> None:
    """A rig without effects and sessions with the usual columns, named by numbers; no word of what is in them."""
    recipe = recipes("smoke", 11)[0]
    files = files_of(recipe, tmp_path / "case")
    numbers = range(1, len(recipe.sessions) + 1)
    assert set(files) == {"rig.yaml", *(f"sessions/session-{number}.csv" for number in numbers)}
    assert b"effects: []" in files["rig.yaml"]
    assert files["sessions/session-1.csv"].splitlines()[0].decode() == HEADER


def test_labels_state_the_stage_of_what_is_in() -> None:
    """A case of one effect has the stage of that effect, one without a gap has none."""
    for recipe in FINAL:
        if recipe.kind in {"single", "left_out"}:
            assert recipe.faults[0].name in EFFECTS_OF_STAGE[recipe.stages[0]]
        assert bool(recipe.stages) == (recipe.kind != "none")
