"""Sessions as files: the sessions of a path, and loading and writing by the ending."""

from collections.abc import Iterable, Sequence
from itertools import chain
from pathlib import Path

from gyrodrift.columns.spec import Column
from gyrodrift.columns.times import AS_READ, StatedClock
from gyrodrift.io.files import UnreadableError, check_ordinary, whole_file, write_whole
from gyrodrift.session.damage import DamagedError, RecordingDamage
from gyrodrift.session.session import Session
from gyrodrift.values.errors import DataError, UsageError

ENDINGS = (".mcap", ".csv")
TABLES = (".csv", ".tsv", ".txt", ".log", ".json", ".jsonl", ".ndjson", ".parquet")
"""Usual endings of tables in lower case; a file with another ending is read as a table if its content is one."""

OTHERS_IN_FOLDER = (".parquet", ".jsonl", ".ndjson", ".tsv", ".ulg", ".bag")
"""Endings that count in a folder without `.mcap` and `.csv`; the rest may be notes, configs or logs of a program."""

LOGS = (".bag", ".db3", ".bin", ".log", ".ulg")
"""Endings of bags and logs of autopilots; tables have some of them too."""


def load_session(
    path: Path,
    columns: Sequence[Column] | None = None,
    *,
    reference: str = "",
    allow_damage: bool = False,
    clock: StatedClock = AS_READ,
) -> Session:
    """Load a session by its ending.

    Parameters
    ----------
    path
        The file.
    columns
        Meaning of the columns of a table; without them its header has to state it.
    reference
        Topic of a bag or .mcap file with the reference angle, as in `--reference`; empty for none.
    allow_damage
        Whether the whole samples of a damaged recording are returned.
    clock
        Unit of the clock of a table, or a sample rate in place of its clock.

    Raises
    ------
    DamagedError
        Bytes were changed or are missing, and `allow_damage` is not given.
    DataError
        The file is missing, of an unknown kind, or no session.
    """
    try:
        session = _loaded(path, columns, clock, allow_damage=allow_damage)
    except OSError as error:  # of the disk, or of a package that reads a format
        raise DataError(f"{path}: cannot be read: {error.strerror or error}") from error
    if not reference:
        return session
    from gyrodrift.session.foreign.reference import with_reference  # noqa: PLC0415 - imported only for topics

    return with_reference(session, path, reference)


def _loaded(path: Path, columns: Sequence[Column] | None, clock: StatedClock, *, allow_damage: bool) -> Session:
    if not path.exists():
        raise DataError(f"{path}: there is no such session")
    if path.is_dir():
        return _bag(path)
    try:
        check_ordinary(path)
    except UnreadableError as error:
        raise DataError(f"{path}: {error}: it is no session") from error
    ending = path.suffix.lower()
    if ending in LOGS and columns is None and (log := _log(path, ending)) is not None:
        return log
    if ending == ".mcap" and columns is None:
        from gyrodrift.session.mcap.read import read_mcap  # noqa: PLC0415 - a format is imported only when it is read

        return read_mcap(path, allow_damage=allow_damage)
    if ending in (".mcap", *LOGS) and ending not in TABLES:
        raise UsageError(f"--columns: {path} is no table; tables end in {', '.join(TABLES)}")
    from gyrodrift.session.tables.read import read_table
    from gyrodrift.session.tables.text import NoTableError  # noqa: PLC0415 - imported only for tables

    try:
        return read_table(path, columns, clock)
    except NoTableError as error:
        if ending in TABLES:
            raise
        read = ", ".join(dict.fromkeys((".mcap", *TABLES, *LOGS)))
        raise DataError(f"{error}; sessions end in {read}, not {path.suffix or 'nothing'}") from error


def _bag(folder: Path) -> Session:
    if not _is_bag_folder(folder):
        raise DataError(f"{folder}: it is a folder; give a session in it")
    from gyrodrift.session.logs.bag import read_bag  # noqa: PLC0415 - as above

    return read_bag(folder)


def _bag_file(folder: Path) -> list[Path]:
    """First file of a ROS 2 bag in SQLite, which stands for the bag; none for other folders."""
    return [min(folder.glob("*.db3"))] if _is_bag_folder(folder) else []


def _is_bag_folder(folder: Path) -> bool:
    """Whether a folder is a ROS 2 bag in SQLite; the .mcap file of a bag in MCAP is a session itself."""
    return (folder / "metadata.yaml").is_file() and any(folder.glob("*.db3"))


def _log(path: Path, ending: str) -> Session | None:
    """Load a bag or the log of an autopilot; None for a `.log` that is a table."""
    if ending in (".bag", ".db3"):
        from gyrodrift.session.logs.bag import read_bag  # noqa: PLC0415 - as above

        return read_bag(path)
    from gyrodrift.session.logs.autopilot import is_ardupilot_text, read_ardupilot, read_px4

    if ending == ".ulg":
        return read_px4(path)
    return read_ardupilot(path) if ending == ".bin" or is_ardupilot_text(path) else None


def damages_of(paths: Iterable[Path]) -> list[tuple[Path, RecordingDamage]]:
    """Damage of recordings by path; the reader reports other errors."""
    damages: list[tuple[Path, RecordingDamage]] = []
    for path in paths:
        if path.suffix == ".mcap" and not _is_intact(path):
            try:
                load_session(path)
            except DamagedError as error:
                damages += error.damages
            except DataError:
                continue
    return damages


def _is_intact(path: Path) -> bool:
    """Whether a checksum proves that every byte is as it was written."""
    from gyrodrift.session.mcap.ending import Ending, ending_of  # noqa: PLC0415 - as above

    try:
        check_ordinary(path)
        with path.open("rb") as file:
            return ending_of(file) is Ending.INTACT
    except (OSError, UnreadableError):  # the reader reports it
        return False


def write_session(path: Path, chunks: Iterable[Session], metadata: dict[str, dict[str, str]] | None = None) -> None:
    """Write the consecutive chunks of a session, with `metadata` if the format supports it.

    Raises
    ------
    UsageError
        The ending is unknown or the file cannot be written; nothing is left behind.
    """
    ending = path.suffix.lower()
    if ending == ".csv":
        from gyrodrift.session.csv import csv_pieces  # noqa: PLC0415 - a format is imported only when it is written

        write_whole(path, csv_pieces(chunks))
    elif ending == ".mcap":
        _write_mcap(path, chunks, metadata)
    else:
        raise UsageError(_unknown_ending(path))


def _write_mcap(path: Path, chunks: Iterable[Session], metadata: dict[str, dict[str, str]] | None) -> None:
    from gyrodrift.session.mcap.read import add_chunk, writer_for  # noqa: PLC0415

    stream = iter(chunks)
    first = next(stream)
    with whole_file(path) as file:
        writer = writer_for(first, file, metadata)
        for chunk in chain([first], stream):
            add_chunk(writer, chunk)
        writer.finish()


def _unknown_ending(path: Path) -> str:
    return f"{path}: sessions end in {' or '.join(ENDINGS)}, not {path.suffix or 'nothing'}"


def session_paths(paths: Iterable[Path]) -> list[Path]:
    """Paths of sessions: a file itself, and all sessions in a folder, by name.

    A ROS 2 bag counts as its first file. Files of OTHERS_IN_FOLDER count in a folder with neither `.mcap` nor `.csv`.
    A folder without sessions counts as the folders in it. Other files, hidden files, and recordings that were cut off
    while empty are skipped.

    Raises
    ------
    DataError
        A path does not exist, or a folder and the folders in it have no session.
    """
    sessions: list[Path] = []
    for path in paths:
        if not path.is_dir():
            if not path.exists():
                raise DataError(f"{path}: there is no such session or folder")
            sessions.append(path)
            continue
        if bag := _bag_file(path):
            sessions += bag
            continue
        inside = _sessions_in(path) or [
            p for folder in _visible_in(path) if folder.is_dir() for p in _bag_file(folder) or _sessions_in(folder)
        ]
        if not inside:
            endings = ", ".join((*ENDINGS, *OTHERS_IN_FOLDER))
            raise DataError(f"{path}: no file in this folder ends in {endings}; name other files one by one")
        sessions += inside
    return list(dict.fromkeys(sessions))


def _visible_in(folder: Path) -> list[Path]:
    return sorted(p for p in folder.iterdir() if not p.name.startswith("."))


def _sessions_in(folder: Path) -> list[Path]:
    for endings in (ENDINGS, OTHERS_IN_FOLDER):
        paths = [p for p in _visible_in(folder) if p.suffix.lower() in endings and not _is_bare(p)]
        if paths:
            return paths
    return []


def _is_bare(path: Path) -> bool:
    from gyrodrift.session.mcap.ending import is_bare  # noqa: PLC0415 - as above

    if path.suffix != ".mcap" or not path.is_file():
        return False
    try:
        with path.open("rb") as file:
            return is_bare(file)
    except OSError:  # the reader reports it
        return False
