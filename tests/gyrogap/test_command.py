"""The command: make a data set, score answers to it, from a terminal."""

import json
import os
import shutil
from pathlib import Path

import pytest
from gyrogap.command import ROW_NAMES
from gyrogap.rows import ROWS

from gyrodrift.cli import main


@pytest.fixture(scope="module")
def data_set(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A case of each row, its labels elsewhere."""
    folder = tmp_path_factory.mktemp("gyrogap")
    words = ["gyrogap", "make", str(folder / "set"), "--seed", "4", "--count", "1", "--seals", str(folder / "sealed")]
    assert main(words) == 0
    return folder


def test_the_rows_of_the_help_are_those_of_the_benchmark() -> None:
    assert tuple(ROWS) == ROW_NAMES


def test_make_and_score(data_set: Path, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    """An answer of none to all cases: right where there is no gap, missing everywhere else."""
    folder = data_set / "set"
    assert not (folder / "seals").exists()
    cases = [case["case"] for case in json.loads((folder / "manifest.json").read_text())["cases"]]
    assert len(cases) == 6
    for case in cases[1:]:
        (tmp_path / f"{case}.json").write_text('{"causes": [], "none": 0.9, "unknown": 0.05}')
    for second in ("case-1.json", "score.json"):
        (tmp_path / second).write_text("{}")
    words = ["gyrogap", "score", str(folder), str(tmp_path), "--seals", str(data_set / "sealed")]
    assert main([*words, "--out", str(tmp_path / "out" / "score.json")]) == 0
    printed = capsys.readouterr()
    assert "6 cases, 5 answered" in printed.out
    assert "1 JSON files answer no case of" in printed.err
    assert "such as case-1.json" in printed.err
    score = json.loads((tmp_path / "out" / "score.json").read_text())
    figures = {figure["key"]: figure for figure in score["figures"]}
    assert figures["single_effect"]["value"] == 0.0
    assert figures["gap_closed"]["value"] == 0.0
    assert len((folder / "openings.log").read_text().splitlines()) == 6


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["make", "{tmp}/new"], "needs one folder and --seed N"),
        (["make", "{tmp}/new", "more", "--seed", "1"], "needs one folder and --seed N"),
        (
            ["make", "{tmp}/new", "--seed", "1", "--rows", "none,singel"],
            "there is no row singel; there are none, single",
        ),
        (["make", "{set}", "--seed", "1", "--count", "1"], "holds a data set; give another folder"),
        (["score", "{set}"], "needs the folder of the answers"),
    ],
)
def test_wrong_usage_is_one_line(
    words: list[str], message: str, data_set: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    given = [word.format(tmp=tmp_path, set=data_set / "set") for word in words]
    assert main(["gyrogap", *given]) == 2
    assert message in capsys.readouterr().err


def test_a_folder_without_answers_is_reported(
    data_set: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["gyrogap", "score", str(data_set / "set"), str(tmp_path)]) == 4
    assert "an answer is CASE.json" in capsys.readouterr().err


@pytest.mark.promise("Configs and commands", "`gyrogap score` takes any file of a stranger, or refuses it by name")
@pytest.mark.parametrize(
    ("file", "content", "message"),
    [
        ("answer", "[" * 100_000, "is no JSON"),
        ("answer", '{"causes": [], "none": 1%s, "unknown": 0}' % ("0" * 400), "the probability of none is"),
        ("answer", None, "is no ordinary file"),
        ("manifest.json", '{"benchmark": "gyrogap"}', "needs the key version"),
        ("manifest.json", '{"benchmark": "gyrogap", "version": 2, "cases": 5}', "needs the key cases"),
        ("manifest.json", '{"benchmark": "gyrogap", "version": 2, "cases": [{}]}', "a case needs the key case"),
        (
            "manifest.json",
            '{"benchmark": "gyrogap", "version": 2, "cases": [{"case": "x\\n2026 forged", "axes": 1, "sha256": ""}]}',
            "is no name of a case",
        ),
        ("hashes.json", "[]", "the list of hashes is no object"),
        ("seal", "[1]", "a seal is no object"),
        ("seal", '{"salt": 5, "label": {}}', "needs the key salt"),
        ("openings.log", None, "cannot be written, and no seal is opened without it: is no ordinary file"),
    ],
)
def test_a_file_of_a_stranger_is_an_error(
    data_set: Path, capsys: pytest.CaptureFixture[str], tmp_path: Path, file: str, content: str | None, message: str
) -> None:
    folder, seals = tmp_path / "set", tmp_path / "sealed"
    shutil.copytree(data_set / "set", folder)
    shutil.copytree(data_set / "sealed", seals)
    case = json.loads((folder / "manifest.json").read_text())["cases"][0]["case"]
    (tmp_path / f"{case}.json").write_text('{"causes": [], "none": 0.9, "unknown": 0.05}')
    named = {"answer": tmp_path / f"{case}.json", "seal": seals / f"{case}.json"}
    path = named.get(file, folder / file)
    path.unlink(missing_ok=True)
    if content is None:
        os.mkfifo(path)
    else:
        path.write_text(content)
    words = ["gyrogap", "score", str(folder), str(tmp_path), "--seals", str(seals), "--no-gap-closed"]
    assert main(words) in (2, 4)
    assert message in capsys.readouterr().err
