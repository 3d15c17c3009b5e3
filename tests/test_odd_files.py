"""Commands that are given a pipe, a device or a socket as a file: one clear line, at once."""

import os
import socket
from pathlib import Path

import pytest

from gyrodrift.cli import main
from gyrodrift.io.files import UnreadableError, read_ordinary
from gyrodrift.service.memory_file import LONGEST_BYTES, read_memory
from gyrodrift.session.files import load_session
from gyrodrift.values.errors import DataError, UsageError


@pytest.fixture(params=[(kind, end) for kind in ("pipe", "zero", "socket") for end in ("", ".mcap", ".csv")])
def odd(tmp_path: Path, request: pytest.FixtureRequest) -> Path:
    """A pipe that nobody writes to, a device without an end, or a socket."""
    kind, ending = request.param
    path = tmp_path / f"odd{ending}"
    match kind:
        case "pipe":
            os.mkfifo(path)
        case "zero":
            path.symlink_to("/dev/zero")
        case _:
            with socket.socket(socket.AF_UNIX) as listening:
                listening.bind(str(path))
    return path


@pytest.mark.promise("Configs and commands")
def test_what_is_no_ordinary_file_is_refused_at_once(odd: Path) -> None:
    """A pipe, device or socket instead of a session, config or memory is refused at once."""
    with pytest.raises(DataError, match="is no ordinary file"):
        load_session(odd)
    with pytest.raises(UsageError, match=r"--memory .*: is no ordinary file"):
        read_memory(odd)


@pytest.mark.promise("Configs and commands")
@pytest.mark.parametrize("command", ["info", "repair", "convert", "filter", "doctor"])
def test_no_command_waits_for_a_pipe(tmp_path: Path, command: str, capsys: pytest.CaptureFixture[str]) -> None:
    """No command waits for a pipe."""
    path = tmp_path / "odd.mcap"
    os.mkfifo(path)
    outs = {"convert": [str(tmp_path / "out.csv")], "filter": ["--out", str(tmp_path / "out.csv")]}
    assert main([command, str(path), *outs.get(command, [])]) == 4
    assert "is no ordinary file" in capsys.readouterr().err


@pytest.mark.promise("Configs and commands")
def test_a_folder_and_a_huge_file_are_no_memory(tmp_path: Path) -> None:
    """A folder or a huge file instead of a memory is refused."""
    with pytest.raises(UsageError, match="Is a directory"):
        read_memory(tmp_path)
    huge = tmp_path / "huge"
    with huge.open("wb") as file:
        file.truncate(1 << 40)
    with pytest.raises(UsageError, match="is larger than 1024 KiB"):
        read_memory(huge)
    with pytest.raises(UnreadableError):
        read_ordinary(huge, LONGEST_BYTES)
