"""Parquet as rows of text, times as whole numbers in their own unit."""

from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from typing import Any

from gyrodrift.io.installation import packages_of
from gyrodrift.session.csv import MOST_COLUMNS
from gyrodrift.session.tables.plan import Head
from gyrodrift.values.errors import DataError

LOOKED_AT = 400
PIECE = 20_000


def parquet_head(path: Path) -> Head:
    """Labels of a file, with the units of times, and its first rows.

    Raises
    ------
    DataError
        It is no Parquet file, or the package is missing.
    """
    rows = tuple(row for _, row in islice(parquet_rows(path), LOOKED_AT))
    labels = tuple(map(_label, _opened(path).schema_arrow))
    if len(labels) > MOST_COLUMNS:
        raise DataError(f"{path}: has {len(labels)} columns, more than {MOST_COLUMNS}: it is no session")
    if not rows:
        raise DataError(f"{path}: has a header and no samples")
    return Head(path, labels, len(labels), 0, rows)


def parquet_rows(path: Path) -> Iterator[tuple[int, list[str]]]:
    """Rows with their numbers, from 1."""
    import pyarrow as pa

    number = 0
    try:
        for piece in _opened(path).iter_batches(PIECE):
            for row in zip(*map(_texts, piece.columns), strict=True):
                number += 1
                yield number, list(row)
    except pa.ArrowException as error:
        raise DataError(f"{path}: is damaged after row {number}: {error}") from error


def _opened(path: Path) -> Any:
    with packages_of(path, "parquet"):
        import pyarrow as pa
        import pyarrow.parquet as pq
    try:
        return pq.ParquetFile(path)
    except (pa.ArrowException, OSError) as error:
        raise DataError(f"{path}: is no Parquet file, or damaged: {error}") from error


def _label(field: Any) -> str:
    import pyarrow as pa

    return f"{field.name} ({field.type.unit})" if pa.types.is_timestamp(field.type) else str(field.name)


def _texts(column: Any) -> list[str]:
    import pyarrow as pa

    whole = column.cast(pa.int64()) if pa.types.is_timestamp(column.type) else column
    return ["" if value is None else str(value) for value in whole.to_pylist()]
