"""Writing a file so that it is there whole or not at all."""

import os
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

from gyrodrift.errors import UsageError


def write_whole(path: Path, lines: Iterable[str]) -> None:
    """Write lines to a file through a neighbour that takes its place when it is complete and on the disk.

    Raises
    ------
    UsageError
        Where the place cannot be written to; nothing is left behind then.
    """
    if path.exists() and not path.is_file():  # a device or a pipe is written to, not replaced
        with path.open("w", encoding="utf-8") as file:
            file.writelines(lines)
        return
    fresh = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        with fresh.open("w", encoding="utf-8") as file:
            file.writelines(lines)
            file.flush()
            os.fsync(file.fileno())
        fresh.replace(path)
    except OSError as error:
        raise UsageError(f"{path}: cannot be written: {error.strerror}") from error
    finally:
        with suppress(OSError):
            fresh.unlink()


def shipped_config(name: str) -> Path:
    """A file of `config/`: beside the package in a checkout, inside it when installed from a wheel."""
    installed = Path(__file__).parent / "config"
    return (installed if installed.is_dir() else Path(__file__).parent.parent / "config") / name
