"""Seals: what is published before a run, and that a label which was changed is found out."""

import json
from pathlib import Path

import pytest
from blind.command import main
from blind.folder import SetFolder
from blind.prepare import OtherSetError, prepare
from blind.recipes import recipes
from blind.seals import BrokenSealError, open_seal
from gyrogap.seals import hash_of


@pytest.fixture
def folder(tmp_path: Path) -> SetFolder:
    sealed = SetFolder(tmp_path / "set")
    prepare(sealed, "smoke", 3, [])
    return sealed


def test_every_label_is_sealed_before_the_run(folder: SetFolder) -> None:
    """A hash for each case, which is the hash of what the seal holds."""
    hashes = folder.hashes()
    assert set(hashes) == {recipe.name for recipe in recipes("smoke", 3)}
    for case in folder.plan().cases:
        sealed = json.loads(folder.seal(case.name).read_text())
        assert hash_of(sealed["salt"], sealed["label"]) == hashes[case.name]


def test_salts_differ(folder: SetFolder) -> None:
    """So that nobody finds a label by hashing all labels there may be."""
    salts = {json.loads(folder.seal(case.name).read_text())["salt"] for case in folder.plan().cases}
    assert len(salts) == len(folder.plan().cases)


def test_the_plan_says_nothing_but_what_is_withheld(folder: SetFolder) -> None:
    """And whether a second run follows; no kind, no size, no effect."""
    read = json.loads((folder.root / "plan.json").read_text())
    assert set(read) == {"set", "seed", "cases"}
    assert all(set(case) == {"case", "withhold", "then"} for case in read["cases"])
    assert [case["case"] for case in read["cases"]] == sorted(case["case"] for case in read["cases"])


def test_openings_are_logged(folder: SetFolder) -> None:
    """A line for each, with time, case and reason."""
    name = folder.plan().cases[0].name
    assert not folder.openings.exists()
    assert open_seal(folder, name, "a test")["case"] == name
    open_seal(folder, name, "a test")
    lines = folder.openings.read_text().splitlines()
    assert len(lines) == 2
    assert lines[0].endswith(f"{name} a test")


def test_a_changed_label_is_found_out(folder: SetFolder) -> None:
    """Whoever rewrites a label after the run breaks its seal; the opening is logged all the same."""
    name = folder.plan().cases[0].name
    sealed = json.loads(folder.seal(name).read_text())
    sealed["label"]["size"] = "invisible"
    folder.seal(name).write_text(json.dumps(sealed))
    with pytest.raises(BrokenSealError, match=name):
        open_seal(folder, name, "a test")
    assert folder.openings.read_text().count("\n") == 1
    assert main(["score", str(folder.root)]) == 1


def test_an_exchanged_seal_is_found_out(folder: SetFolder) -> None:
    """A seal that is whole, but another case's."""
    first, second = (case.name for case in folder.plan().cases[:2])
    folder.seal(first).write_text(folder.seal(second).read_text())
    with pytest.raises(BrokenSealError):
        open_seal(folder, first, "a test")


def test_a_set_is_sealed_once(folder: SetFolder) -> None:
    """Going on with a run changes no seal; another set needs another folder."""
    before = folder.hashes()
    prepare(folder, "smoke", 3, [])
    assert folder.hashes() == before
    with pytest.raises(OtherSetError):
        prepare(folder, "smoke", 4, [])


def test_a_final_set_runs_whole(tmp_path: Path) -> None:
    """Nobody picks cases out of it."""
    assert main(["run", "--set", "final", "--only", "single/latency", "--out", str(tmp_path / "set")]) == 1
    assert not (tmp_path / "set").exists()


def test_development_may_pick(tmp_path: Path) -> None:
    """By parts of titles."""
    folder = SetFolder(tmp_path / "set")
    prepare(folder, "development", 1, ["single/latency", "none"])
    assert len(folder.plan().cases) == 43
