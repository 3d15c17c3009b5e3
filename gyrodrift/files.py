"""Writing a file so that it is there whole or not at all."""

import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO

from gyrodrift.errors import UsageError

SESSION_COLUMN, DERIVED_COLUMN, LONGEST_HEADER = b"t_device_s", b"yaw_deg", 4096
"""What the first line of a CSV session names, what that of one names that a filter has made of
another, and how much of that line is looked at."""

NAMED = 3
"""Of many files that a message is about."""


@contextmanager
def whole_file(path: Path) -> Iterator[BinaryIO]:
    """A file to write bytes to, under another name until it is complete and on the disk.

    Raises
    ------
    UsageError
        Where the place cannot be written to; nothing is left behind then.
    """
    if path.exists() and not path.is_file():  # a device or a pipe is written to, not replaced
        with path.open("wb") as file:
            yield file
        return
    fresh = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        with fresh.open("wb") as file:
            yield file
            file.flush()
            os.fsync(file.fileno())
        fresh.replace(path)
    except OSError as error:
        raise UsageError(f"{path}: cannot be written: {error.strerror}") from error
    finally:
        with suppress(OSError):
            fresh.unlink()


def write_whole(path: Path, pieces: Iterable[str]) -> None:
    """Write text to a file so that it is there whole or not at all.

    Raises
    ------
    UsageError
        Where the place cannot be written to; nothing is left behind then.
    """
    with whole_file(path) as file:
        file.writelines(piece.encode() for piece in pieces)


def check_kept(targets: Iterable[Path], inputs: Iterable[Path], *, force: bool) -> None:
    """See that nothing recorded is lost: what is read is never written over, other sessions with force only.

    Raises
    ------
    UsageError
        With the names of what would be lost.
    """
    sources, there = list(inputs), []
    for target in targets:
        for source in sources:
            if _is_same(target, source):
                what = "the input itself" if target == source else f"the input {source} itself"
                raise UsageError(f"{target}: is {what}, which is never written over: choose another name")
        if _is_session(target):
            there.append(str(target))
    if there and not force:
        more = f" and {len(there) - NAMED} more" if len(there) > NAMED else ""
        raise UsageError(f"{', '.join(there[:NAMED])}{more}: already recorded; --force replaces what is there")


def _is_same(target: Path, source: Path) -> bool:
    """Also through links and other spellings."""
    try:
        return target.samefile(source)
    except OSError:
        return target.resolve() == source.resolve()


def _is_session(path: Path) -> bool:
    if not path.is_file() or path.stat().st_size == 0:
        return False
    if path.suffix != ".csv":
        return path.suffix == ".mcap"
    with path.open("rb") as file:
        header = file.readline(LONGEST_HEADER)
    return SESSION_COLUMN in header and DERIVED_COLUMN not in header


def check_writable(folder: Path) -> None:
    """See that files can be made in a folder, by making one; the folder is made where it is not there.

    Raises
    ------
    UsageError
        Where they cannot.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        trial = folder / f".gyrodrift.{os.getpid()}"
        trial.touch()
        trial.unlink()
    except OSError as error:
        raise UsageError(f"{folder}: cannot be written to: {error.strerror}") from error


def shipped_config(name: str) -> Path:
    """A file of `config/`: beside the package in a checkout, inside it when installed from a wheel."""
    installed = Path(__file__).parent / "shipped"
    return (installed if installed.is_dir() else Path(__file__).parent.parent / "config") / name
