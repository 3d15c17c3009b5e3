"""Three blind cases through the real program; `make evaluate` counts how many of many come out right."""

from pathlib import Path

import pytest

from blind.command import main
from blind.folder import SetFolder
from blind.score import is_right
from blind.tried import open_all

pytestmark = [pytest.mark.long, pytest.mark.timeout(3600)]

PATIENCE = ("--timeout", "3000")
"""A run that takes longer has failed; on a machine with much else to do, ten minutes are not enough to tell."""


def assert_right(out: Path, cases: int, *options: str) -> None:
    assert main(["run", *options, *PATIENCE, "--out", str(out)]) == 0
    assert main(["score", str(out)]) == 0
    tried = open_all(SetFolder(out))
    assert len(tried) == cases
    assert [f"{case.id}: {case.put_in} → {case.blind.text}" for case in tried if not is_right(case)] == []


def test_a_rig_explains_its_own_sessions(tmp_path: Path) -> None:
    """Short sessions of a random rig, diagnosed against that very rig: no false alarm."""
    assert_right(tmp_path, 1, "--set", "bench", "--seed", "6", "--rows", "none_short", "--count", "1")


def test_an_effect_of_another_generator_is_named_and_what_no_catalogue_has_is_not(tmp_path: Path) -> None:
    """A delay; and a bias that follows the motor, told as unknown at its stage."""
    only = ("--only", "single/latency", "--only", "outside/motor_bias")
    assert_right(tmp_path, 2, "--set", "smoke", "--no-oracle", *only)
