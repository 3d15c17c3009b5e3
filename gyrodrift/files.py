"""Reading a file that may be anything, and writing one so that it is there whole or not at all."""

import os
import stat
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from io import RawIOBase
from pathlib import Path
from secrets import token_hex
from tempfile import TemporaryFile
from typing import BinaryIO

from gyrodrift.errors import UsageError
from gyrodrift.system import OPEN_AT_ONCE, set_mode, set_owner

MCAP_MAGIC = b"\x89MCAP"
COMMENT, LONGEST_LINE = b"#", 4096
"""What a line of a table begins with that is not yet its header, and how much of a line is looked at."""

FILTERED_COLUMN = b"yaw_deg"
"""Of tables that a filter has written: they can be worked out again, other tables cannot."""

TABLES = (".csv", ".json", ".jsonl", ".parquet")
LONGEST_PREFIX = 60
"""Characters of a name that the file which is being written begins with."""

NOT_ORDINARY = "is no ordinary file"

NAMED = 3
"""Of many files that a message is about."""


class UnreadableError(Exception):
    """A file cannot be read as one; the text says why, for behind its name."""


@dataclass(frozen=True, slots=True)
class FileContent:
    """The bytes of a file and its mode."""

    content: bytes
    mode: int


def read_ordinary(path: Path, longest_bytes: int) -> FileContent:
    """Read a whole file of a bounded size; a pipe, a device or a socket is not waited for, and not read.

    Raises
    ------
    FileNotFoundError
        Where there is none.
    UnreadableError
        Where it cannot be read, is no ordinary file or is larger.
    """
    try:
        with open(path, "rb", buffering=0, opener=_without_waiting) as file:
            status = os.fstat(file.fileno())
            content = _all_of(file, longest_bytes + 1)
    except FileNotFoundError:
        raise
    except (OSError, ValueError) as error:
        raise UnreadableError(_why_unreadable(error)) from error
    if len(content) > longest_bytes:
        raise UnreadableError(f"is larger than {longest_bytes >> 10} KiB")
    return FileContent(content, stat.S_IMODE(status.st_mode))


def check_ordinary(path: Path) -> None:
    """See that a path can be opened without waiting: a file or a folder, or nothing.

    Raises
    ------
    UnreadableError
        Where it is a pipe, a device or a socket.
    """
    try:
        _check_openable(path)
    except OSError:  # nothing is there, or nobody may look
        return
    except ValueError as error:
        raise UnreadableError(NOT_ORDINARY) from error


def _check_openable(path: Path | str | int) -> None:
    """See that it is a file or a folder; ValueError where it is not, OSError where there is none."""
    mode = os.stat(path).st_mode  # noqa: PTH116 - it may be a descriptor
    if not (stat.S_ISREG(mode) or stat.S_ISDIR(mode)):
        raise ValueError(NOT_ORDINARY)


def _without_waiting(name: str, flags: int) -> int:
    """Open an ordinary file or a folder, which open() refuses itself; a device may do something when it is opened."""
    _check_openable(name)
    fd = os.open(name, flags | OPEN_AT_ONCE)
    try:
        _check_openable(fd)  # another file may have taken the name
    except ValueError:
        os.close(fd)
        raise
    return fd


def _all_of(file: RawIOBase, most_bytes: int) -> bytes:
    content = bytearray()
    while len(content) < most_bytes and (piece := file.read(most_bytes - len(content))):
        content += piece
    return bytes(content)


def _why_unreadable(error: OSError | ValueError) -> str:
    if isinstance(error, OSError):
        return f"cannot be read: {error.strerror}"
    return NOT_ORDINARY if str(error) == NOT_ORDINARY else f"cannot be read: {error}"


@contextmanager
def whole_file(path: Path) -> Iterator[BinaryIO]:
    """A file to write bytes to, under another name until it is complete and on the disk.

    Raises
    ------
    UsageError
        Where the place cannot be written to; nothing is left behind then.
    """
    before = _status_of(path)
    if before is not None and not stat.S_ISREG(before.st_mode):  # a device or a pipe is written to, not replaced
        with path.open("wb") as file:
            yield file
        return
    fresh = path.with_name(f".{path.name[:LONGEST_PREFIX]}.{token_hex(8)}")  # nobody can lay a link there before
    try:
        with open(fresh, "xb", opener=None if before is None else _for_us_alone) as file:
            if before is not None:
                _let_the_same_read(file.fileno(), before)
            yield file
            file.flush()
            os.fsync(file.fileno())
        fresh.replace(path)
    except OSError as error:
        raise UsageError(f"{path}: cannot be written: {error.strerror}") from error
    finally:
        with suppress(OSError):
            fresh.unlink()


def _status_of(path: Path) -> os.stat_result | None:
    """What a file is, whose, and who may read and write it; None where there is none."""
    try:
        return path.stat()
    except OSError:
        return None


def _for_us_alone(name: str, flags: int) -> int:
    """Open a new file that nobody else can open before its mode is set."""
    return os.open(name, flags, 0o600)


def _let_the_same_read(fd: int, before: os.stat_result) -> None:
    """Owner, group and mode of the file that is replaced; where its group cannot be given on, no group's rights."""
    mode = stat.S_IMODE(before.st_mode)
    with suppress(OSError):  # root alone gives files away
        set_owner(fd, before.st_uid, -1)
    try:
        set_owner(fd, -1, before.st_gid)
    except OSError:
        mode &= ~stat.S_IRWXG
    set_mode(fd, mode)


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
    places = list(targets)
    check_inputs_kept(places, inputs)
    there = [str(place) for place in places if _is_recorded(place)]
    if there and not force:
        more = f" and {len(there) - NAMED} more" if len(there) > NAMED else ""
        raise UsageError(f"{', '.join(there[:NAMED])}{more}: already recorded; --force replaces what is there")


def check_inputs_kept(targets: Iterable[Path], inputs: Iterable[Path]) -> None:
    """See that what is read is never written over, also through links and other spellings.

    Raises
    ------
    UsageError
        With the name of what would be lost.
    """
    sources = {_identity(source): source for source in reversed(list(inputs))}
    for target in targets:
        source = sources.get(_identity(target))
        if source is not None:
            what = "the input itself" if target == source else f"the input {source} itself"
            raise UsageError(f"{target}: is {what}, which is never written over: choose another name")


def _identity(path: Path) -> tuple[int, int] | str:
    """The same for every name of a file; where nothing is there yet, the name without links."""
    try:
        status = path.stat()
    except OSError:
        return os.path.realpath(path)
    return status.st_dev, status.st_ino


def _is_recorded(path: Path) -> bool:
    """Whether it is an .mcap file or a table of numbers that no filter has written."""
    if not path.is_file() or path.stat().st_size == 0:
        return False
    with path.open("rb") as file:
        first = file.readline(LONGEST_LINE)
        if path.suffix == ".mcap" or first.startswith(MCAP_MAGIC):
            return True
        while first.startswith(COMMENT) or first.isspace():
            first = file.readline(LONGEST_LINE)
    return path.suffix.lower() in TABLES and FILTERED_COLUMN not in first


def check_writable(folder: Path) -> None:
    """See that files can be made in a folder, by making one; the folder is made where it is not there.

    Raises
    ------
    UsageError
        Where they cannot.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with TemporaryFile(prefix=".gyrodrift.", dir=folder):
            pass
    except OSError as error:
        raise UsageError(f"{folder}: cannot be written to: {error.strerror}") from error


def shipped_config(name: str) -> Path:
    """A file of `config/`: beside the package in a checkout, inside it when installed from a wheel."""
    installed = Path(__file__).parent / "shipped"
    return (installed if installed.is_dir() else Path(__file__).parent.parent / "config") / name
