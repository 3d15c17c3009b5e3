"""Seals: what is published before a run, and that a label which was changed is found out."""

import json
from pathlib import Path

import pytest
from blind.command import main
from blind.folder import SetFolder
from blind.prepare import OtherSetError, prepare
from blind.rows.table import draw_rows
from gyrogap.seals import OPENINGS, BrokenSealError, hash_of

ROWS = ("none_generator", "single")


@pytest.fixture
def folder(tmp_path: Path) -> SetFolder:
    sealed = SetFolder(tmp_path / "set")
    prepare(sealed, 3, ROWS, 2)
    return sealed


def test_every_label_is_sealed_before_the_run(folder: SetFolder) -> None:
    """A hash for each case, which is the hash of what the seal holds."""
    hashes = folder.hashes()
    assert set(hashes) == {case.name for case in draw_rows(3, list(ROWS), 2)}
    for case in folder.plan().cases:
        sealed = json.loads((folder.seals / f"{case.name}.json").read_text())
        assert hash_of(sealed["salt"], sealed["label"]) == hashes[case.name]


def test_salts_differ(folder: SetFolder) -> None:
    salts = {json.loads((folder.seals / f"{case.name}.json").read_text())["salt"] for case in folder.plan().cases}
    assert len(salts) == len(folder.plan().cases)


def test_the_plan_says_nothing_but_what_is_withheld(folder: SetFolder) -> None:
    read = json.loads((folder.root / "plan.json").read_text())
    assert set(read) == {"seed", "cases"}
    assert all(set(case) == {"case", "withhold", "then"} for case in read["cases"])
    assert [case["case"] for case in read["cases"]] == sorted(case["case"] for case in read["cases"])


def test_openings_are_logged(folder: SetFolder) -> None:
    """A line for each, with time, case and reason."""
    name = folder.plan().cases[0].name
    assert not (folder.root / OPENINGS).exists()
    assert folder.open_seal(name, "a test")["case"] == name
    folder.open_seal(name, "a test")
    lines = (folder.root / OPENINGS).read_text().splitlines()
    assert len(lines) == 2
    assert lines[0].endswith(f"{name} a test")


def test_a_changed_label_is_found_out(folder: SetFolder) -> None:
    name = folder.plan().cases[0].name
    path = folder.seals / f"{name}.json"
    sealed = json.loads(path.read_text())
    sealed["label"]["size"] = "invisible"
    path.write_text(json.dumps(sealed))
    with pytest.raises(BrokenSealError, match=name):
        folder.open_seal(name, "a test")
    assert (folder.root / OPENINGS).read_text().count("\n") == 1
    assert main(["score", str(folder.root)]) == 1


def test_an_exchanged_seal_is_found_out(folder: SetFolder) -> None:
    """A seal that is whole, but another case's."""
    first, second = (folder.seals / f"{case.name}.json" for case in folder.plan().cases[:2])
    first.write_text(second.read_text())
    with pytest.raises(BrokenSealError):
        folder.open_seal(first.stem, "a test")


def test_a_set_is_sealed_once(folder: SetFolder) -> None:
    """Going on with a run changes no seal; another set needs another folder."""
    before = folder.hashes()
    prepare(folder, 3, ROWS, 2)
    assert folder.hashes() == before
    with pytest.raises(OtherSetError):
        prepare(folder, 4, ROWS, 2)


def test_cases_are_picked_by_parts_of_titles(tmp_path: Path) -> None:
    """A case that has one of them is sealed."""
    folder = SetFolder(tmp_path / "set")
    prepare(folder, 3, ROWS, 4, ["single/2", "none_generator/0"])
    assert len(folder.plan().cases) == 2
