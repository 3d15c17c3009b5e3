"""The door for files that a user or a config names: ordinary, limited in size, in time."""

import os
import threading
from pathlib import Path

import pytest

from gyrodrift.io import files
from gyrodrift.io.files import UnreadableError, open_ordinary, read_json, read_ordinary, whole_file
from gyrodrift.values.errors import UsageError


def odd_file(kind: str, path: Path) -> Path:
    match kind:
        case "pipe":
            os.mkfifo(path)
        case "device":
            path.symlink_to("/dev/zero")
        case "folder":
            path.mkdir()
        case "large":
            path.write_bytes(b"x" * 101)
    return path


@pytest.mark.promise("Configs and commands")
@pytest.mark.parametrize(
    ("kind", "why"),
    [
        ("pipe", "is no ordinary file"),
        ("device", "is no ordinary file"),
        ("folder", "cannot be read: Is a directory"),
        ("large", "is larger than 0 KiB"),
    ],
)
def test_a_named_file_is_ordinary_and_of_limited_size(tmp_path: Path, kind: str, why: str) -> None:
    """A pipe, a device or a file of any size in the place of a named file is an error with its name."""
    path = odd_file(kind, tmp_path / "f")
    with pytest.raises(UnreadableError, match=why):
        read_ordinary(path, 100)
    if kind != "large":
        with pytest.raises(UnreadableError, match="is no ordinary file"):
            open_ordinary(path)


def test_a_file_system_that_does_not_answer_is_an_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    go_on = threading.Event()
    monkeypatch.setattr(files, "READ_S", 0.05)
    monkeypatch.setattr(files, "_all_of", lambda *_: b"x" * go_on.wait())
    (tmp_path / "f").touch()
    with pytest.raises(UnreadableError, match=r"cannot be read: it takes more than 0.05 s"):
        read_ordinary(tmp_path / "f", 100)
    go_on.set()
    for thread in threading.enumerate():
        if thread.name == "read file":
            thread.join()


@pytest.mark.parametrize("content", ["[" * 100_000, '{"a":' * 100_000, "\xff", "{", ""])
def test_content_that_is_no_json_is_an_error(tmp_path: Path, content: str) -> None:
    (tmp_path / "f").write_text(content, encoding="latin-1")
    with pytest.raises(UnreadableError, match="is no JSON"):
        read_json(tmp_path / "f", 1 << 20)


@pytest.mark.parametrize(("kind", "why"), [("pipe", "no program reads this pipe"), ("full", "No space left on device")])
def test_a_device_that_cannot_be_written_is_an_error_with_its_name(tmp_path: Path, kind: str, why: str) -> None:
    path = tmp_path / "f"
    if kind == "pipe":
        os.mkfifo(path)
    else:
        path.symlink_to("/dev/full")
    with pytest.raises(UsageError, match=f"f: cannot be written: {why}"), whole_file(path) as file:
        file.write(b"x")
