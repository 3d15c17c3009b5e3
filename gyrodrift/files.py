"""Writing a file so that it is there whole or not at all."""

import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO

from gyrodrift.errors import UsageError


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
