"""Paths that stand for sessions: files, and folders of them."""

from pathlib import Path

import pytest

from gyrodrift.session.files import session_paths
from gyrodrift.values.errors import DataError


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name in ("b.mcap", "a.csv", "rig.yaml", ".hidden.mcap", "c.mcap.tail"):
        (tmp_path / name).write_bytes(b"x")
    (tmp_path / "empty").mkdir()
    return tmp_path


def test_a_folder_is_the_sessions_in_it_by_name(folder: Path) -> None:
    assert [path.name for path in session_paths([folder])] == ["a.csv", "b.mcap"]


def test_files_and_folders_mix_and_nothing_comes_twice(folder: Path) -> None:
    assert session_paths([folder / "b.mcap", folder]) == [folder / "b.mcap", folder / "a.csv"]


def test_tables_of_other_formats_count_where_nothing_else_is(folder: Path) -> None:
    for name in ("b.parquet", "a.jsonl", "notes.txt"):
        (folder / "empty" / name).write_bytes(b"x")
    assert [path.name for path in session_paths([folder / "empty"])] == ["a.jsonl", "b.parquet"]
    (folder / "a.jsonl").write_bytes(b"x")
    assert [path.name for path in session_paths([folder])] == ["a.csv", "b.mcap"]


@pytest.mark.parametrize(
    ("name", "message"), [("empty", "no file in this folder ends in .mcap, .csv, "), ("x", "is no such")]
)
def test_nothing_there_is_told(folder: Path, name: str, message: str) -> None:
    with pytest.raises(DataError, match=message):
        session_paths([folder / name])


def test_a_folder_of_folders_is_the_sessions_in_those(folder: Path) -> None:
    deeper = folder / "empty" / "case"
    deeper.mkdir()
    (deeper / "a.mcap").write_bytes(b"x")
    assert session_paths([folder / "empty"]) == [deeper / "a.mcap"]
    assert len(session_paths([folder])) == 2
