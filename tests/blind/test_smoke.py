"""A blind case through the real program; `make evaluate` counts how many of many come out right."""

from pathlib import Path

import pytest
from blind.command import main
from blind.folder import SetFolder
from blind.score import is_right
from blind.tried import open_all

pytestmark = [pytest.mark.long, pytest.mark.timeout(3600)]

PATIENCE = ("--timeout", "3000")
"""A run that takes longer has failed; on a machine with much else to do, ten minutes are not enough to tell."""


def test_an_effect_of_another_generator_is_named(tmp_path: Path) -> None:
    """A delay, among all effects of the catalogue."""
    only = ("--only", "single/latency")
    assert main(["run", "--set", "smoke", "--no-oracle", *only, *PATIENCE, "--out", str(tmp_path)]) == 0
    assert main(["score", str(tmp_path)]) == 0
    tried = open_all(SetFolder(tmp_path))
    assert len(tried) == 1
    assert [f"{case.put_in} → {case.blind.text}" for case in tried if not is_right(case)] == []
