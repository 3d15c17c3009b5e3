"""Sessions as files: what a path stands for, and the one way to load it."""

from collections.abc import Iterable
from pathlib import Path

from gyrodrift.errors import DataError
from gyrodrift.session.session import Session

ENDINGS = (".mcap", ".csv")


def load_session(path: Path) -> Session:
    """Load a session by its ending.

    Raises
    ------
    DataError
        Where it is missing, of an unknown kind, or damaged.
    """
    if not path.exists():
        raise DataError(f"{path}: there is no such session")
    if path.is_dir():
        raise DataError(f"{path}: this is a folder; give one session in it")
    if path.suffix == ".csv":
        from gyrodrift.session.csv import read_csv  # noqa: PLC0415 - each format costs only who reads it

        return read_csv(path)
    if path.suffix == ".mcap":
        from gyrodrift.session.mcap.read import read_mcap  # noqa: PLC0415

        return read_mcap(path)
    raise DataError(f"{path}: sessions end in .mcap or .csv, not {path.suffix or 'nothing'}")


def session_paths(paths: Iterable[Path]) -> list[Path]:
    """The sessions that paths stand for: a file is itself, a folder the sessions in it by name.

    A folder without sessions stands for those of the folders in it. Other files, and hidden ones, are passed over.

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
        inside = _sessions_in(path) or [p for each in _seen_in(path) if each.is_dir() for p in _sessions_in(each)]
        if not inside:
            raise DataError(f"{path}: there are no sessions in this folder; they end in {' or '.join(ENDINGS)}")
        found += inside
    return list(dict.fromkeys(found))


def _seen_in(folder: Path) -> list[Path]:
    return sorted(p for p in folder.iterdir() if not p.name.startswith("."))


def _sessions_in(folder: Path) -> list[Path]:
    return [p for p in _seen_in(folder) if p.suffix in ENDINGS]
