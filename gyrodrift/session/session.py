"""A recorded session as arrays, and the one way to load it from a path."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gyrodrift.errors import DataError

Floats = NDArray[np.float64]

ENDINGS = (".mcap", ".csv")


@dataclass(frozen=True, slots=True)
class Session:
    """What a device sent, in the order it came; every array has the shape (n,), n ≥ 1.

    name
        Name of the file, without its folder and ending.
    t_device_s
        The sensor's own clock, s.
    rate_dps
        Measured yaw rate, deg/s.
    t_host_s, seq, encoder_deg, temp_c
        Arrival time in s, counter, reference angle in degrees, temperature in °C; None where there is none.
        Single missing values are NaN (−1 in `seq`).
    metadata
        Named tables of what was kept beside the samples: device, host, note; empty where the format has none.
    """

    name: str
    t_device_s: Floats
    rate_dps: Floats
    t_host_s: Floats | None = None
    seq: NDArray[np.int64] | None = None
    encoder_deg: Floats | None = None
    temp_c: Floats | None = None
    metadata: Mapping[str, Mapping[str, str]] = field(default_factory=dict)


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
        from gyrodrift.session.mcap import read_mcap  # noqa: PLC0415

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
