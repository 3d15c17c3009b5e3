"""Parquet as rows of text, times as whole numbers in their own unit."""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from itertools import islice
from pathlib import Path
from typing import Any

from gyrodrift.io.files import opened_limit
from gyrodrift.io.installation import packages_of
from gyrodrift.session.csv import MOST_COLUMNS
from gyrodrift.session.tables.plan import Head
from gyrodrift.session.tables.rows import PIECE
from gyrodrift.values.errors import DataError

LOOKED_AT = 400
ROWS_MIN, ROWS_PER_BYTE = 100_000, 10
"""Rows of any file, and rows per byte of a larger one; a rate with noise takes a byte a row, however it is packed."""


def parquet_head(path: Path) -> Head:
    """Labels of a file, with the units of times, and its first rows.

    Raises
    ------
    DataError
        It is no Parquet file, or the package is missing.
    """
    with _reading(path):
        labels = tuple(map(_label, _opened(path).schema_arrow))
    if len(labels) > MOST_COLUMNS:
        raise DataError(f"{path}: has {len(labels)} columns, more than {MOST_COLUMNS}: it is no session")
    rows = tuple(row for _, row in islice(parquet_rows(path, range(len(labels)), LOOKED_AT), LOOKED_AT))
    if not rows:
        raise DataError(f"{path}: has a header and no samples")
    return Head(path, labels, len(labels), 0, rows)


def parquet_rows(path: Path, columns: Iterable[int], piece: int = PIECE) -> Iterator[tuple[int, list[str]]]:
    """Rows with their numbers, from 1; only some columns are read, the cells of others are empty."""
    number = 0
    used = set(columns)
    with _reading(path):
        file = _opened(path)
        fields = list(file.schema_arrow)
        names = [field.name for index, field in enumerate(fields) if index in used and _is_scalar(field)]
        for batch in file.iter_batches(piece, columns=names):
            texts = {name: _texts(column) for name, column in zip(batch.schema.names, batch.columns, strict=True)}
            empty = [""] * batch.num_rows
            for row in zip(*(texts.get(field.name, empty) for field in fields), strict=True):
                number += 1
                yield number, list(row)


@contextmanager
def _reading(path: Path) -> Iterator[None]:
    """Turn any error of pyarrow into an error for the user.

    Raises
    ------
    DataError
        The file is damaged, or needs too much memory.
    """
    import pyarrow as pa

    try:
        yield
    except (pa.ArrowException, OSError, ValueError, MemoryError) as error:
        if isinstance(error, DataError):
            raise
        raise DataError(f"{path}: is no Parquet file, or damaged: {error}") from error


def _opened(path: Path) -> Any:
    with packages_of(path, "parquet"):
        import pyarrow.parquet as pq
    file = pq.ParquetFile(path)
    size, groups = path.stat().st_size, range(file.metadata.num_row_groups)
    claimed = sum(file.metadata.row_group(group).total_byte_size for group in groups)
    if claimed > opened_limit(size) or file.metadata.num_rows > max(ROWS_MIN, ROWS_PER_BYTE * size):
        raise DataError(f"{path}: claims {claimed} bytes in {file.metadata.num_rows} rows, too many for its size")
    return file


def _is_scalar(field: Any) -> bool:
    """Whether its cells may be numbers, times or texts; others are of no use, and may be large."""
    import pyarrow as pa

    return not (pa.types.is_nested(field.type) or pa.types.is_binary(field.type))


def _label(field: Any) -> str:
    import pyarrow as pa

    return f"{field.name} ({field.type.unit})" if pa.types.is_timestamp(field.type) else str(field.name)


def _texts(column: Any) -> list[str]:
    import pyarrow as pa

    whole = column.cast(pa.int64()) if pa.types.is_timestamp(column.type) else column
    return ["" if value is None else str(value) for value in whole.to_pylist()]
