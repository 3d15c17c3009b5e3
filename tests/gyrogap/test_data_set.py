"""A data set of the open benchmark: the same bytes from a seed, rows as documented, sealed labels."""

import json
from collections import Counter
from pathlib import Path

import pytest
import yaml
from evaluate.gyrogap_methods import reader
from evaluate.gyrogap_methods.cases import PublicCase
from gyrogap.answer import answer_of
from gyrogap.case import BenchmarkCase
from gyrogap.data_set import chosen_cases, digest_of_files, make_data_set, read_manifest
from gyrogap.judge import judged_case
from gyrogap.rows import ON_THREE_AXES, ROWS, draw_case
from gyrogap.seals import hash_of, open_seal
from gyrogap.vocabulary import GROUP_OF, PARAMETERS

from gyrodrift.values.errors import DataError, UsageError

SEED = 20261126


def make(folder: Path, *cases: BenchmarkCase) -> Path:
    make_data_set(folder, folder / "seals", cases, lambda done, total: None)
    return folder


@pytest.mark.parametrize(
    ("row", "number", "digest"),
    [
        ("none", 0, "193fffd964181692"),
        ("single", 1, "bc9accd3cd7ee271"),
        ("pair", 3, "1e91d534cd45e190"),
        ("outside", 2, "135ce0cae2d6f54a"),
        ("wrong_size", 0, "393cf53d7f2e8ec4"),
    ],
)
def test_a_seed_gives_the_same_bytes(row: str, number: int, digest: str, tmp_path: Path) -> None:
    """The streams of numpy's bit generators are fixed; a digest that differs is another data set."""
    draw_case(SEED, row, number).write(tmp_path / "case")
    assert digest_of_files(tmp_path / "case")[:16] == digest


def test_another_seed_gives_other_cases() -> None:
    """Name, salt and label change with the seed, the row and the number."""
    cases = [draw_case(1, "none", 0), draw_case(2, "none", 0), draw_case(1, "none", 1), draw_case(1, "single", 0)]
    assert len({case.name for case in cases}) == len({case.salt for case in cases}) == 4
    assert cases[0].label() != cases[1].label()


def test_there_are_300_cases_in_six_rows_and_a_quarter_has_three_axes() -> None:
    cases = list(chosen_cases(3, [], None))
    assert Counter(case.row for case in cases) == {name: row.count for name, row in ROWS.items()}
    assert len(cases) == 300
    assert len({case.name for case in cases}) == 300
    assert sum(case.axes == 3 for case in cases) == 74
    one_axis = [case.effects[0].name for case in cases if case.row == "single" and case.axes == 1]
    assert {*one_axis, *ON_THREE_AXES} == set(PARAMETERS)
    assert {effect.name for case in cases if case.row != "outside" for effect in case.effects} <= set(GROUP_OF)
    assert not {case.effects[0].name for case in cases if case.row == "outside"} & set(GROUP_OF)


def test_the_seed_mixes_the_order_of_effects() -> None:
    """The first ten cases of a row are a sample of its effects, another one for each seed."""
    first = [[draw_case(seed, "single", number).effects[0].name for number in range(10)] for seed in range(4)]
    assert len(set(map(tuple, first))) == 4


def test_a_wrong_size_is_stated_by_the_simulator() -> None:
    """The file of the simulator has the effect, at another size than the sessions."""
    case = draw_case(5, "wrong_size", 1)
    stated, effect = case.stated[0], case.effects[0]
    assert stated.name == effect.name
    assert stated.parameters != effect.parameters
    assert f"name: {effect.name}" in case.stand.rig_text


@pytest.mark.parametrize("row", ROWS)
def test_the_simulator_has_effects_in_every_row(row: str) -> None:
    """So the file of the simulator tells no row; only a wrong size needs at least one effect."""
    cases = [draw_case(7, row, number) for number in range(24)]
    stated = [len(case.modeled) + len(case.stated) for case in cases]
    assert set(stated) == ({1, 2} if row == "wrong_size" else {0, 1, 2})
    assert any(case.mover for case in cases)
    for case in cases:
        assert all(f"name: {effect.name}" in case.stand.rig_text for effect in case.modeled)
        assert not {effect.name for effect in case.modeled} & {effect.name for effect in case.effects}


def test_the_file_of_the_simulator_alone_scores_no_more_than_chance() -> None:
    """`none` for each case is right in every fifth."""
    right = []
    for case in chosen_cases(11, [], 25):
        simulator = yaml.safe_load(case.stand.rig_text)
        answer = answer_of(reader.answer(PublicCase(case.name, [], simulator)), Path("reader.json"))
        right.append(judged_case(case.label(), answer, None).is_right)
    assert sum(right) / len(right) < 0.2


def test_the_public_files_tell_no_label(tmp_path: Path) -> None:
    """Names and hashes only; the label is in the seal, and its hash is the published one."""
    case = draw_case(SEED, "single", 0)
    folder = make(tmp_path / "set", case)
    public = [path for path in folder.iterdir() if path.is_file() and path.name != "effects.json"]
    assert {path.name for path in public} == {"manifest.json", "hashes.json"}
    assert not any(case.effects[0].name in path.read_text() for path in public)
    label = open_seal(folder, folder / "seals", case.name, "test")
    assert json.loads((folder / "hashes.json").read_text()) == {case.name: hash_of(case.salt, label)}
    assert case.name in (folder / "openings.log").read_text()
    listed = read_manifest(folder)[0]
    assert listed.sha256 == digest_of_files(folder / "cases" / case.name)


def test_a_changed_label_is_no_label(tmp_path: Path) -> None:
    """The error names the seal and the file of the hashes."""
    case = draw_case(SEED, "none", 2)
    folder = make(tmp_path / "set", case)
    path = folder / "seals" / f"{case.name}.json"
    path.write_text(path.read_text().replace('"row": "none"', '"row": "single"'))
    with pytest.raises(DataError, match=r"is not the label that was sealed; its hash differs from .*hashes\.json"):
        open_seal(folder, folder / "seals", case.name, "test")


def test_a_data_set_is_not_replaced(tmp_path: Path) -> None:
    """An interrupted one, which has no manifest, is made again."""
    case = draw_case(SEED, "none", 2)
    folder = make(tmp_path / "set", case)
    with pytest.raises(UsageError, match="holds a data set; give another folder"):
        make(folder, case)
    (folder / "manifest.json").unlink()
    make(folder, case)
    assert read_manifest(folder)[0].case == case.name


def test_a_folder_without_a_data_set_is_reported(tmp_path: Path) -> None:
    (tmp_path / "manifest.json").write_text("[]")
    with pytest.raises(DataError, match="make a set: gyrodrift gyrogap make DIR --seed N"):
        read_manifest(tmp_path)
    (tmp_path / "manifest.json").write_text('{"benchmark": "gyrogap", "version": 99}')
    with pytest.raises(DataError, match="has version 99; this program reads version 2"):
        read_manifest(tmp_path)
