"""Sessions as files: what a path stands for, and the one way to load and to write one, by its ending."""

from collections.abc import Iterable, Sequence
from pathlib import Path

from gyrodrift.columns.spec import Column
from gyrodrift.errors import DataError, UsageError
from gyrodrift.files import UnreadableError, check_ordinary, whole_file, write_whole
from gyrodrift.session.damage import DamagedError, RecordingDamage
from gyrodrift.session.session import Session

ENDINGS = (".mcap", ".csv")
TABLES = (".csv", ".tsv", ".txt", ".log", ".json", ".jsonl", ".ndjson", ".parquet")
"""Endings of tables, in small or capital letters."""

LOGS = (".bag", ".db3", ".bin", ".log", ".ulg")
"""Endings of bags and logs of autopilots, some of which tables have too."""


def load_session(path: Path, columns: Sequence[Column] | None = None, *, allow_damage: bool = False) -> Session:
    """Load a session by its ending.

    Parameters
    ----------
    path
        The file.
    columns
        What the columns of a table are; without them its header has to say it.
    allow_damage
        Whether what is whole of a damaged recording is returned.

    Raises
    ------
    DamagedError
        Where bytes of it were changed or are missing, unless what is whole is asked for with `allow_damage`.
    DataError
        Where it is missing, of an unknown kind, or no session.
    """
    if not path.exists():
        raise DataError(f"{path}: there is no such session")
    if path.is_dir():
        return _bag(path)
    try:
        check_ordinary(path)
    except UnreadableError as error:
        raise DataError(f"{path}: {error}: this is no session") from error
    ending = path.suffix.lower()
    if ending in LOGS and columns is None and (log := _log(path, ending)) is not None:
        return log
    if ending in TABLES:
        from gyrodrift.session.tables.read import read_table  # noqa: PLC0415 - each format costs only who reads it

        return read_table(path, columns)
    if columns is not None:
        raise UsageError(f"--columns: {path} is no table; tables end in {', '.join(TABLES)}")
    if ending == ".mcap":
        from gyrodrift.session.mcap.read import read_mcap  # noqa: PLC0415

        return read_mcap(path, allow_damage=allow_damage)
    read = ", ".join(dict.fromkeys((".mcap", *TABLES, *LOGS)))
    raise DataError(f"{path}: sessions end in {read}, not {path.suffix or 'nothing'}")


def _bag(folder: Path) -> Session:
    if not _is_bag_folder(folder):
        raise DataError(f"{folder}: this is a folder; give one session in it")
    from gyrodrift.session.logs.bag import read_bag  # noqa: PLC0415 - likewise

    return read_bag(folder)


def _is_bag_folder(folder: Path) -> bool:
    """Whether a folder is a bag of ROS 2 in SQLite; of one in MCAP the .mcap file is a session."""
    return (folder / "metadata.yaml").is_file() and any(folder.glob("*.db3"))


def _log(path: Path, ending: str) -> Session | None:
    """A bag, or the log of an autopilot; None for a `.log` that is a table."""
    if ending in (".bag", ".db3"):
        from gyrodrift.session.logs.bag import read_bag  # noqa: PLC0415 - likewise

        return read_bag(path)
    from gyrodrift.session.logs.autopilot import is_ardupilot_text, read_ardupilot, read_px4  # noqa: PLC0415

    if ending == ".ulg":
        return read_px4(path)
    return read_ardupilot(path) if ending == ".bin" or is_ardupilot_text(path) else None


def damages_of(paths: Iterable[Path]) -> list[tuple[Path, RecordingDamage]]:
    """What is damaged in recordings, by path; what else is wrong with one is left to who reads it."""
    found: list[tuple[Path, RecordingDamage]] = []
    for path in paths:
        if path.suffix == ".mcap" and not _is_intact(path):
            try:
                load_session(path)
            except DamagedError as error:
                found += error.damages
            except DataError:
                continue
    return found


def _is_intact(path: Path) -> bool:
    """Whether a checksum says that every byte is as it was written."""
    from gyrodrift.session.mcap.ending import Ending, ending_of  # noqa: PLC0415 - likewise

    try:
        check_ordinary(path)
        with path.open("rb") as file:
            return ending_of(file) is Ending.INTACT
    except (OSError, UnreadableError):  # is told by who reads it
        return False


def write_session(path: Path, chunks: Iterable[Session], metadata: dict[str, dict[str, str]] | None = None) -> None:
    """Write the consecutive chunks of a session; `metadata` goes along where the format has room for it.

    Raises
    ------
    UsageError
        Where the ending is unknown or the place cannot be written to; nothing is left behind then.
    """
    ending = path.suffix.lower()
    if ending == ".csv":
        from gyrodrift.session.csv import csv_pieces  # noqa: PLC0415 - each format costs only who writes it

        write_whole(path, csv_pieces(chunks))
    elif ending == ".mcap":
        _write_mcap(path, chunks, metadata)
    else:
        raise UsageError(_unknown_ending(path))


def _write_mcap(path: Path, chunks: Iterable[Session], metadata: dict[str, dict[str, str]] | None) -> None:
    from gyrodrift.session.mcap.read import add_chunk  # noqa: PLC0415
    from gyrodrift.session.mcap.write import McapWriter  # noqa: PLC0415

    with whole_file(path) as file:
        writer = McapWriter(file, metadata)
        for chunk in chunks:
            add_chunk(writer, chunk)
        writer.finish()


def _unknown_ending(path: Path) -> str:
    return f"{path}: sessions end in {' or '.join(ENDINGS)}, not {path.suffix or 'nothing'}"


def session_paths(paths: Iterable[Path]) -> list[Path]:
    """The sessions that paths stand for: a file is itself, a folder the sessions in it by name.

    A folder that is a bag of ROS 2 is its first file. A folder without sessions stands for those of the folders in it.
    Other files, hidden ones, and recordings that were cut off before anything was written into them are passed over.

    Raises
    ------
    DataError
        Where a path does not exist, or a folder holds no session, nor any folder in it.
    """
    found: list[Path] = []
    for path in paths:
        if not path.is_dir():
            if not path.exists():
                raise DataError(f"{path}: there is no such session or folder")
            found.append(path)
            continue
        if _is_bag_folder(path):
            found.append(min(path.glob("*.db3")))
            continue
        inside = _sessions_in(path) or [p for each in _seen_in(path) if each.is_dir() for p in _sessions_in(each)]
        if not inside:
            raise DataError(f"{path}: there are no sessions in this folder; they end in {' or '.join(ENDINGS)}")
        found += inside
    return list(dict.fromkeys(found))


def _seen_in(folder: Path) -> list[Path]:
    return sorted(p for p in folder.iterdir() if not p.name.startswith("."))


def _sessions_in(folder: Path) -> list[Path]:
    return [p for p in _seen_in(folder) if p.suffix.lower() in ENDINGS and not _is_bare(p)]


def _is_bare(path: Path) -> bool:
    from gyrodrift.session.mcap.interrupted import is_bare  # noqa: PLC0415 - likewise

    if path.suffix != ".mcap" or not path.is_file():
        return False
    try:
        with path.open("rb") as file:
            return is_bare(file)
    except OSError:  # is told by who reads it
        return False
