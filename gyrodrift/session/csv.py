"""Sessions as CSV: a header with any of the columns below, in any order, then numbers.

Other columns, such as those of `filter`, are ignored.
"""

import warnings
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, TextIO

import numpy as np
from numpy.typing import NDArray

from gyrodrift.session.aids import COLUMN, RowAid, RowAids, aids_by_row, aids_in, aids_text
from gyrodrift.session.session import AXIS_COLUMNS, COLUMNS, DEVICE_COLUMNS, SAMPLE_COLUMNS, Session, session_of_columns
from gyrodrift.values.arrays import Floats
from gyrodrift.values.errors import DataError
from gyrodrift.values.words import nearest

OLD_NAMES = {"t_s": "t_device_s"}
"""Column names in files of earlier versions."""

OTHER_NAMES = {**OLD_NAMES, "gyro_z_dps": "rate_dps"}
"""Also the name that stands next to `gyro_x_dps` and `gyro_y_dps` in files of other programs."""

SIMILAR = 0.8
"""An unknown column with this similarity to a missing one counts as misspelled."""

REQUIRED = ("t_device_s", "rate_dps")
LONGEST_HEADER = 1 << 16

MOST_COLUMNS = 1000
"""Limit for the comparison of unknown names with known ones; no session has more."""


def read_exact(path: Path) -> Session | None:
    """Read a `.csv` session as this program writes it; None for any other form.

    Lines starting with `#` are comments.

    Raises
    ------
    DataError
        The file cannot be read.
    """
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            names = _names(file)
            table = _table(file, names) if names else None
    except OSError as error:
        raise DataError(f"{path}: cannot be read: {error.strerror}") from error
    except UnicodeDecodeError:
        return None
    if table is None:
        return None
    columns: dict[str, NDArray[Any]] = dict(zip([name for name in names if name in COLUMNS], table.T, strict=True))
    if "seq" in columns:
        columns["seq"] = counter(columns["seq"])
    return session_of_columns(path.stem, columns, aids=_aids(path) if COLUMN in names else None)


def _aids(path: Path) -> RowAids:
    """Measurements of second sources in their column.

    Raises
    ------
    DataError
        A cell has another form.
    """
    aids: list[RowAid] = []
    with path.open(encoding="utf-8-sig", newline="") as file:
        content = (line for line in file if _is_content(line))
        index = [word.strip() for word in next(content).split(",")].index(COLUMN)
        for row, line in enumerate(content):
            try:
                aids += ((row, aid) for aid in aids_in(line.split(",")[index]))
            except ValueError as error:
                raise DataError(f"{path}: sample {row + 1}: {COLUMN} {error}") from error
    return tuple(aids)


def _names(file: TextIO) -> list[str]:
    """Names in the header; empty if it is no header of this program."""
    line = next((line for line in iter(lambda: file.readline(LONGEST_HEADER), "") if _is_content(line)), "")
    words = [word.strip() for word in line.split(",")]
    if len(words) > MOST_COLUMNS:
        return []
    names = present_names(words)
    columns = [name for name in names if name in COLUMNS]
    is_session = set(REQUIRED) <= set(columns) and len(columns) == len(set(columns)) and not slips_in(names)
    return names if is_session else []


def present_names(labels: Sequence[str]) -> list[str]:
    """Labels with the present names of columns; another name stays if the present one is there, too."""
    return [OTHER_NAMES.get(label, label) if OTHER_NAMES.get(label) not in labels else label for label in labels]


def slips_in(names: Sequence[str]) -> dict[int, list[str]]:
    """Indices of misspelled names, with the missing names that they resemble."""
    groups = (SAMPLE_COLUMNS, *(group for group in (AXIS_COLUMNS, DEVICE_COLUMNS) if set(names) & set(group)))
    absent = set().union(*groups) - set(names)
    nearest_names = {
        index: nearest(name, absent, similarity=SIMILAR) for index, name in enumerate(names) if name not in COLUMNS
    }
    return {index: meant for index, meant in nearest_names.items() if meant}


def _is_content(line: str) -> bool:
    return bool(line.strip()) and not line.startswith("#")


def _table(file: TextIO, names: list[str]) -> Floats | None:
    """All rows, shape (n, known columns), by the C reader of numpy; None if it fails."""
    indices = [index for index, name in enumerate(names) if name in COLUMNS]
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # numpy warns of a file without rows
            columns = indices if len(indices) < len(names) else None  # with None numpy checks the lengths of rows
            table: Floats = np.loadtxt(file, delimiter=",", comments="#", ndmin=2, dtype=np.float64, usecols=columns)
    except (ValueError, UserWarning):
        return None
    return table if table.size and table.shape[1] == len(indices) else None


def counter(column: Floats) -> NDArray[np.int64]:
    """Counter of each sample; -1 for values beyond exact integers."""
    return np.where(np.abs(column) < WHOLE, column, -1).astype(np.int64)


def csv_pieces(chunks: Iterable[Session]) -> Iterator[str]:
    """Text of a `.csv` session from its consecutive chunks, with all digits.

    The first chunk decides the columns; a missing value is an empty cell.
    """
    columns: list[str] = []
    texts: dict[str, _Texts] = {}
    fractions = _Fractions()
    for chunk in chunks:
        if not columns:
            columns = [name for name in COLUMNS if chunk.column(name) is not None]
            texts = {name: _Texts() for name in columns}
            yield ",".join([*columns, *([] if chunk.aids is None else [COLUMN])]) + "\n"
        cells = [_cells(name, chunk.filled(name), texts[name], fractions) for name in columns]
        if chunk.aids is not None:
            by_row = aids_by_row(chunk.aids)
            cells.append([aids_text(by_row.get(row, ())) for row in range(len(chunk.rate_dps))])
        yield "\n".join(map(",".join, zip(*cells, strict=True))) + "\n"


REMEMBERED = 100_000
"""Texts of numbers in the cache; most columns of a session have few different values."""

WHOLE = 2.0**53
"""Floats below this represent all integers exactly."""


class _Texts(dict[float, str]):
    """Text of a number with all digits; empty for NaN."""

    def __missing__(self, value: float) -> str:
        if len(self) >= REMEMBERED:
            self.clear()
        text = self[value] = "" if value != value else repr(value)  # noqa: PLR0124 - NaN alone differs from itself
        return text


class _Fractions(dict[int, str]):
    """Text such as `.000001`, by number of microseconds."""

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
    # Times are whole microseconds: seconds and fractions repeat, and their texts come from the cache.
    seconds, fractions = np.divmod(micros.astype(np.int64), 1_000_000)
    parts = zip(map(str, seconds.tolist()), map(tails.__getitem__, fractions.tolist()), strict=True)
    return list(map("".join, parts))
