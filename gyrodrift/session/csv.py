"""Sessions as people have them: a header with any of the columns below, in any order, then numbers.

Other columns, such as those that `filter` adds, are passed over.
"""

import csv
import warnings
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TextIO

import numpy as np
from numpy.typing import NDArray

from gyrodrift.arrays import Floats
from gyrodrift.errors import DataError
from gyrodrift.nearest import nearest, question
from gyrodrift.session.session import Session

COLUMNS = ("t_device_s", "t_host_s", "seq", "rate_dps", "encoder_deg", "temp_c", "still")
OLD_NAMES = {"t_s": "t_device_s"}
"""Names that columns had in files of earlier versions."""

ALIKE = 0.8
"""A column this like one that is not there is taken for a slip of the keyboard."""

REQUIRED = ("t_device_s", "rate_dps")

MOST_COLUMNS = 1000
"""Each unknown column is compared with the known ones, which takes a while; no table of a session has more."""


def read_csv(path: Path) -> Session:
    """Load a `.csv` session. Lines starting with `#` are comments, an empty cell is NaN.

    Raises
    ------
    DataError
        With the line and column of the first value that is no number, or what the header lacks.
    """
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            names, header_line = _header(path, file)
            table = _table(path, file, names, header_line)
    except OSError as error:
        raise DataError(f"{path}: cannot be read: {error.strerror}") from error
    except (UnicodeDecodeError, csv.Error) as error:
        raise DataError(f"{path}: is not text: {error}") from error
    columns = dict(zip([name for name in names if name in COLUMNS], table.T, strict=True))
    seq = columns.get("seq")
    return Session(
        name=path.stem,
        t_device_s=columns["t_device_s"],
        rate_dps=columns["rate_dps"],
        t_host_s=columns.get("t_host_s"),
        seq=None if seq is None else _counter(seq),
        encoder_deg=columns.get("encoder_deg"),
        temp_c=columns.get("temp_c"),
        still=columns.get("still"),
    )


def _header(path: Path, file: TextIO) -> tuple[list[str], int]:
    number, line = next(
        ((number, line) for number, line in enumerate(iter(file.readline, ""), 1) if _is_content(line)), (0, "")
    )
    if not line:
        raise DataError(f"{path}: is empty; expected a header with {', '.join(REQUIRED)}")
    words = [word.strip() for word in line.split(",")]
    if len(words) > MOST_COLUMNS:
        raise DataError(f"{path}:{number}: has {len(words)} columns, more than {MOST_COLUMNS}: this is no session")
    names = [OLD_NAMES.get(word, word) if OLD_NAMES.get(word) not in words else word for word in words]
    known = f"columns are {', '.join(COLUMNS)}"
    for column, name in enumerate(names, 1):
        meant = [] if name in COLUMNS else nearest(name, set(COLUMNS) - set(names), alike=ALIKE)
        if meant:
            raise DataError(f"{path}:{number}: column {column} is {name!r}; {question(meant)} {known}")
        if name in COLUMNS and name in names[: column - 1]:
            raise DataError(f"{path}:{number}: column {name} stands twice; {known}")
    for name in REQUIRED:
        if name not in names:
            said = ", ".join(words)
            raise DataError(f"{path}:{number}: there is no column {name}, which is required, in {said}; {known}")
    return names, number


def _is_content(line: str) -> bool:
    return bool(line.strip()) and not line.startswith("#")


def _table(path: Path, file: TextIO, names: list[str], header_line: int) -> Floats:
    """All rows, shape (n, known columns): by numpy's C reader, or cell by cell where that one stumbles."""
    taken = [at for at, name in enumerate(names) if name in COLUMNS]
    start = file.tell()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # numpy warns of a file without rows
            columns = taken if len(taken) < len(names) else None  # without them numpy sees rows of other lengths
            table: Floats = np.loadtxt(file, delimiter=",", comments="#", ndmin=2, dtype=np.float64, usecols=columns)
    except (ValueError, UserWarning):
        file.seek(start)
        table = _cell_by_cell(path, file, names, header_line)
    if table.size == 0:
        raise DataError(f"{path}: has a header and no samples")
    if table.shape[1] != len(taken):
        raise DataError(f"{path}: rows have {table.shape[1]} values, the header has {len(names)} columns")
    return table


def _cell_by_cell(path: Path, file: TextIO, names: list[str], header_line: int) -> Floats:
    reader = csv.reader(file)
    rows = []
    for row in reader:
        if not _is_content(",".join(row)):
            continue
        line = header_line + reader.line_num
        if len(row) != len(names):
            raise DataError(f"{path}:{line}: has {len(row)} values, the header has {len(names)} columns")
        rows.append([_number(path, line, *cell) for cell in zip(names, row, strict=True) if cell[0] in COLUMNS])
    return np.array(rows, dtype=np.float64).reshape(-1, sum(name in COLUMNS for name in names))


def _number(path: Path, line: int, name: str, text: str) -> float:
    try:
        return float(text) if text.strip() else float("nan")
    except ValueError:
        raise DataError(f"{path}:{line}: {name} is {text!r}, expected a number") from None


def _counter(column: Floats) -> NDArray[np.int64]:
    """A counter beyond all that is counted is none."""
    return np.where(np.abs(column) < WHOLE, column, -1).astype(np.int64)


def csv_pieces(chunks: Iterable[Session]) -> Iterator[str]:
    """The text of a `.csv` session from its consecutive chunks, every value with all its digits.

    The columns are those of the first chunk; a value that is not there is an empty cell.
    """
    columns: list[str] = []
    texts: dict[str, _Texts] = {}
    fractions = _Fractions()
    for chunk in chunks:
        if not columns:
            columns = [name for name in COLUMNS if getattr(chunk, name) is not None]
            texts = {name: _Texts() for name in columns}
            yield ",".join(columns) + "\n"
        cells = [_cells(name, getattr(chunk, name), texts[name], fractions) for name in columns]
        yield "\n".join(map(",".join, zip(*cells, strict=True))) + "\n"


REMEMBERED = 100_000
"""Texts of numbers that are kept: most columns of a session hold few different values."""


WHOLE = 2.0**53
"""Below it floats are exact whole numbers."""


class _Texts(dict[float, str]):
    """Every digit of a number; nothing for NaN."""

    def __missing__(self, value: float) -> str:
        if len(self) >= REMEMBERED:
            self.clear()
        text = self[value] = "" if value != value else repr(value)  # noqa: PLR0124 - NaN alone differs from itself
        return text


class _Fractions(dict[int, str]):
    """`.000001` by number of microseconds."""

    def __missing__(self, micros: int) -> str:
        if len(self) >= REMEMBERED:
            self.clear()
        text = self[micros] = f".{micros:06d}"
        return text


def _cells(name: str, values: NDArray[np.float64] | NDArray[np.int64], texts: _Texts, tails: _Fractions) -> list[str]:
    if name == "seq":
        return ["" if seq < 0 else str(seq) for seq in values.tolist()]
    if not name.startswith("t_"):
        return list(map(texts.__getitem__, values.tolist()))
    with np.errstate(over="ignore"):
        micros = np.rint(values * 1e6)
    if not np.array_equal(micros / 1e6, values) or not ((micros >= 0.0) & (micros < WHOLE)).all():
        return list(map(repr, values.tolist()))
    # Whole microseconds: the seconds repeat, and so do their fractions at any steady rate.
    seconds, fractions = np.divmod(micros.astype(np.int64), 1_000_000)
    parts = zip(map(str, seconds.tolist()), map(tails.__getitem__, fractions.tolist()), strict=True)
    return list(map("".join, parts))
