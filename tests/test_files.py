"""Files that are there whole or not at all, for those who could read them before, and for nobody else."""

import errno
import os
from pathlib import Path

import pytest

from gyrodrift.io.files import check_writable, whole_file, write_whole
from gyrodrift.values.errors import UsageError


@pytest.mark.parametrize("mode", [0o600, 0o640, 0o664])
def test_who_may_read_a_file_stays(tmp_path: Path, mode: int) -> None:
    """A config that is private is private after it was tuned again."""
    path = tmp_path / "c.yaml"
    path.touch()
    path.chmod(mode)
    write_whole(path, ["filter: hdr\n"])
    assert path.stat().st_mode & 0o777 == mode
    assert path.read_text() == "filter: hdr\n"


def test_nobody_else_can_open_what_is_about_to_be_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path, observed, fchmod = tmp_path / "c.yaml", [], os.fchmod
    path.touch()
    path.chmod(0o640)

    def looked_at(fd: int, mode: int) -> None:
        observed.append(os.fstat(fd).st_mode & 0o777)
        fchmod(fd, mode)

    monkeypatch.setattr(os, "fchmod", looked_at)
    write_whole(path, ["x"])
    assert observed == [0o600]
    assert path.stat().st_mode & 0o777 == 0o640


@pytest.mark.parametrize(("refused", "mode"), [((), 0o640), ((PermissionError,), 0o600)])
def test_a_group_is_kept_or_has_no_rights(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, refused: tuple[type[Exception], ...], mode: int
) -> None:
    """A config that a group may read is not handed to the group of whoever writes it again."""
    path, request = tmp_path / "c.yaml", []
    path.touch()
    path.chmod(0o640)

    def fchown(_fd: int, uid: int, gid: int) -> None:
        request.append((uid, gid))
        for error in refused:
            raise error(errno.EPERM, "not permitted")

    monkeypatch.setattr(os, "fchown", fchown)
    before = path.stat()
    write_whole(path, ["x"])
    assert request == [(before.st_uid, -1), (-1, before.st_gid)]
    assert path.stat().st_mode & 0o777 == mode


def test_a_new_file_is_as_any_other(tmp_path: Path) -> None:
    write_whole(tmp_path / "ours", ["x"])
    (tmp_path / "others").touch()
    assert (tmp_path / "ours").stat().st_mode == (tmp_path / "others").stat().st_mode


def test_no_name_can_be_taken_before(tmp_path: Path) -> None:
    names = set()
    for _ in range(2):
        with whole_file(tmp_path / "c.yaml") as file:
            (fresh,) = set(tmp_path.glob(".c.yaml.*"))
            assert fresh.stat().st_ino == os.fstat(file.fileno()).st_ino
            names.add(fresh.name)
    assert len(names) == 2
    assert [path.name for path in tmp_path.iterdir()] == ["c.yaml"]


def test_a_long_name_is_written_too(tmp_path: Path) -> None:
    write_whole(tmp_path / ("x" * 255), ["y"])
    assert (tmp_path / ("x" * 255)).read_text() == "y"


def test_what_cannot_be_written_leaves_nothing(tmp_path: Path) -> None:
    """Nor does what fails half way."""
    with pytest.raises(UsageError, match="cannot be written: File name too long"):
        write_whole(tmp_path / ("x" * 256), ["y"])
    with pytest.raises(UsageError, match="cannot be written: No such file"):
        write_whole(tmp_path / "nowhere" / "c.yaml", ["y"])
    with pytest.raises(ZeroDivisionError):
        write_whole(tmp_path / "c.yaml", (str(1 // number) for number in (1, 0)))
    check_writable(tmp_path)
    assert not list(tmp_path.iterdir())
