"""The door for files that a user or a config names: safe reading of any kind of file, and atomic writing."""

import errno
import json
import os
import stat
import threading
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from io import RawIOBase
from pathlib import Path
from secrets import token_hex
from tempfile import TemporaryFile
from typing import Any, BinaryIO, TypeVar

from gyrodrift.io.system import OPEN_AT_ONCE, set_mode, set_owner
from gyrodrift.values.errors import UsageError

MCAP_MAGIC = b"\x89MCAP"
COMMENT, LONGEST_LINE = b"#", 4096
"""First byte of a comment line of a table, and longest part of a line that is read."""

FILTERED_COLUMN = b"yaw_deg"
"""Column of tables that a filter has written; these can be computed again, other tables cannot."""

TABLES = (".csv", ".json", ".jsonl", ".parquet")
LONGEST_PREFIX = 60
"""Characters of the target name in the name of the temporary file."""

NOT_ORDINARY = "is no ordinary file"

OPENED_BYTES, OPENED_TIMES = 1 << 24, 100
"""Limit of decompressed content: bytes, or times the file size; noisy samples shrink about tenfold."""

READ_S = 5.0
"""Longest time to read a file of limited size, s; a network or a FUSE file system may never answer. Chosen."""

T = TypeVar("T")

NAMED = 3
"""Files that a message names, of many."""


class UnreadableError(Exception):
    """A file cannot be read; the text is the reason, to follow the name of the file."""


@dataclass(frozen=True, slots=True)
class FileContent:
    """The bytes of a file and its mode."""

    content: bytes
    mode: int


def read_ordinary(path: Path, longest_bytes: int) -> FileContent:
    """Read a whole file of limited size within READ_S; never wait for or read a pipe, a device or a socket.

    Raises
    ------
    FileNotFoundError
        There is no such file.
    UnreadableError
        It cannot be read, is no ordinary file, is larger, or takes longer.
    """
    return in_time(lambda: _read(path, longest_bytes), READ_S)


def read_json(path: Path, longest_bytes: int) -> Any:
    """Value of a JSON file of limited size.

    Raises
    ------
    FileNotFoundError
        There is no such file.
    UnreadableError
        It cannot be read, or is no JSON.
    """
    content = read_ordinary(path, longest_bytes).content
    try:
        return json.loads(content)
    except RecursionError as error:
        raise UnreadableError("is no JSON: it is nested too deeply") from error
    except ValueError as error:
        raise UnreadableError(f"is no JSON: {error}") from error


def in_time(work: Callable[[], T], seconds: float) -> T:
    """Result of work on a file in a thread of its own, so that it cannot hold up the program.

    Raises
    ------
    UnreadableError
        It takes longer; the thread is left alone.
    """
    results: list[T] = []
    errors: list[BaseException] = []

    def run() -> None:
        """Do the work, and keep its result or its error."""
        try:
            results.append(work())
        except BaseException as error:  # noqa: BLE001 - raised below, in the thread that waits
            errors.append(error)

    thread = threading.Thread(target=run, name="read file", daemon=True)
    thread.start()
    thread.join(seconds)
    if errors:
        raise errors[0]
    if not results:
        raise UnreadableError(f"cannot be read: it takes more than {seconds:g} s")
    return results[0]


def _read(path: Path, longest_bytes: int) -> FileContent:
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


def opened_limit(size_bytes: int) -> int:
    """Largest size of the content of a compressed file; a few bytes can expand to any size."""
    return max(OPENED_BYTES, OPENED_TIMES * size_bytes)


def open_ordinary(path: Path) -> int:
    """Descriptor of a file, for reading; never of a folder, a pipe, a device or a socket.

    Raises
    ------
    OSError
        It cannot be opened.
    UnreadableError
        It is no ordinary file.
    """
    try:
        fd = _without_waiting(os.fspath(path), os.O_RDONLY | getattr(os, "O_CLOEXEC", 0))
    except ValueError as error:
        raise UnreadableError(NOT_ORDINARY) from error
    if stat.S_ISDIR(os.fstat(fd).st_mode):
        os.close(fd)
        raise UnreadableError(NOT_ORDINARY)
    return fd


def check_ordinary(path: Path) -> None:
    """Check that a path can be opened without waiting: a file, a folder, or nothing.

    Raises
    ------
    UnreadableError
        It is a pipe, a device or a socket.
    """
    try:
        _check_openable(path)
    except OSError:  # nothing is there, or it may not be read
        return
    except ValueError as error:
        raise UnreadableError(NOT_ORDINARY) from error


def _check_openable(path: Path | str | int) -> None:
    """Check that it is a file or a folder; ValueError if not, OSError if nothing is there."""
    mode = os.stat(path).st_mode  # noqa: PTH116 - it may be a descriptor
    if not (stat.S_ISREG(mode) or stat.S_ISDIR(mode)):
        raise ValueError(NOT_ORDINARY)


def _without_waiting(name: str, flags: int) -> int:
    """Open an ordinary file or a folder; opening a device could start something."""
    _check_openable(name)
    fd = os.open(name, flags | OPEN_AT_ONCE)
    try:
        _check_openable(fd)  # another file may have the name now
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
    """A file to write bytes to; it has a temporary name until it is complete and on the disk.

    Raises
    ------
    UsageError
        The file cannot be written; nothing is left behind.
    """
    before = _status_of(path)
    if before is not None and not stat.S_ISREG(before.st_mode):  # write to a device or a pipe, do not replace it
        with _device_of(path) as file:
            yield file
        return
    fresh = path.with_name(f".{path.name[:LONGEST_PREFIX]}.{token_hex(8)}")  # an unpredictable name
    try:
        with open(fresh, "xb", opener=None if before is None else _open_private) as file:
            if before is not None:
                _copy_permissions(file.fileno(), before)
            yield file
            file.flush()
            os.fsync(file.fileno())
        fresh.replace(path)
    except OSError as error:
        raise UsageError(f"{path}: cannot be written: {error.strerror}") from error
    finally:
        with suppress(OSError):
            fresh.unlink()


@contextmanager
def _device_of(path: Path) -> Iterator[BinaryIO]:
    """A device, or a pipe that another program reads; never wait for a reader of a pipe.

    Raises
    ------
    UsageError
        It cannot be written.
    """
    try:
        with open(path, "wb", opener=_open_device) as file:
            yield file
    except OSError as error:
        reason = "no program reads this pipe" if error.errno == errno.ENXIO else error.strerror
        raise UsageError(f"{path}: cannot be written: {reason}") from error


def _open_device(name: str, flags: int) -> int:
    fd = os.open(name, flags | OPEN_AT_ONCE)
    os.set_blocking(fd, True)
    return fd


def _status_of(path: Path) -> os.stat_result | None:
    """Status of a file; None if it does not exist."""
    try:
        return path.stat()
    except OSError:
        return None


def _open_private(name: str, flags: int) -> int:
    """Open a new file that no other user can open until its mode is set."""
    return os.open(name, flags, 0o600)


def _copy_permissions(fd: int, before: os.stat_result) -> None:
    """Set owner, group and mode of the replaced file; without its group, no rights for a group."""
    mode = stat.S_IMODE(before.st_mode)
    with suppress(OSError):  # only root may change the owner
        set_owner(fd, before.st_uid, -1)
    try:
        set_owner(fd, -1, before.st_gid)
    except OSError:
        mode &= ~stat.S_IRWXG
    set_mode(fd, mode)


def write_whole(path: Path, pieces: Iterable[str]) -> None:
    """Write text to a file atomically: the whole file or nothing.

    Raises
    ------
    UsageError
        The file cannot be written; nothing is left behind.
    """
    with whole_file(path) as file:
        file.writelines(piece.encode() for piece in pieces)


def check_kept(targets: Iterable[Path], inputs: Iterable[Path], *, force: bool) -> None:
    """Check that no recording is lost: inputs are never overwritten, other recordings only with `force`.

    Raises
    ------
    UsageError
        With the names of the files that would be lost.
    """
    paths = list(targets)
    check_inputs_kept(paths, inputs)
    recorded = [str(path) for path in paths if _is_recorded(path)]
    if recorded and not force:
        rest = f" and {len(recorded) - NAMED} more" if len(recorded) > NAMED else ""
        raise UsageError(f"{', '.join(recorded[:NAMED])}{rest}: already recorded; --force replaces it")


def check_inputs_kept(targets: Iterable[Path], inputs: Iterable[Path]) -> None:
    """Check that no input is overwritten, also through links and other spellings.

    Raises
    ------
    UsageError
        With the name of the file that would be lost.
    """
    sources = {_identity(source): source for source in reversed(list(inputs))}
    for target in targets:
        source = sources.get(_identity(target))
        if source is not None:
            name = "the input itself" if target == source else f"the input {source} itself"
            raise UsageError(f"{target}: is {name}, which is never written over: choose another name")


def _identity(path: Path) -> tuple[int, int] | str:
    """Device and inode of a file, equal for all its names; the name without links if it does not exist yet."""
    try:
        status = path.stat()
    except OSError:
        return os.path.realpath(path)
    return status.st_dev, status.st_ino


def _is_recorded(path: Path) -> bool:
    """Whether it is an .mcap file, or a table that no filter has written."""
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
    """Check that files can be created in a folder by creating one; create the folder if needed.

    Raises
    ------
    UsageError
        They cannot be created.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with TemporaryFile(prefix=".gyrodrift.", dir=folder):
            pass
    except OSError as error:
        raise UsageError(f"{folder}: cannot be written to: {error.strerror}") from error


def shipped_config(name: str) -> Path:
    """Path of a file of `config/`, in a checkout or in an installed wheel."""
    installed = Path(__file__).parent.parent / "shipped"
    return (installed if installed.is_dir() else Path(__file__).parents[2] / "config") / name
