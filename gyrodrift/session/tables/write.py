"""Tables for other programs as csv, JSON, Parquet or MCAP, by the ending of the path."""

import json
from collections.abc import Iterable, Iterator, Sequence
from itertools import chain, islice
from pathlib import Path
from typing import BinaryIO

from gyrodrift.io.files import whole_file, write_whole
from gyrodrift.io.installation import extra_command
from gyrodrift.io.json_numbers import finite
from gyrodrift.session.session import COLUMNS, Session
from gyrodrift.values.errors import UsageError

WRITTEN = (".csv", ".json", ".jsonl", ".parquet", ".mcap")
PIECE = 50_000
"""Rows per write."""

TOPIC, LATEST_LOG_NS = "/gyro", 2**64 - 1

Value = float | int | None
Row = Sequence[Value]


def written_ending(path: Path, option: str) -> str:
    """Ending of a path to write, in lower case; `.csv` for a device or a pipe.

    Raises
    ------
    UsageError
        The format cannot be written, or its package is missing.
    """
    if path.exists() and not path.is_file() and not path.is_dir():
        return ".csv"
    ending = path.suffix.lower()
    if ending not in WRITTEN:
        raise UsageError(f"{option} {path}: the ending decides the format, expected one of {', '.join(WRITTEN)}")
    if ending == ".parquet":
        _need_parquet(f"{option} {path}")
    return ending


def _need_parquet(what: str) -> None:
    try:
        import pyarrow.parquet  # noqa: F401 - an extra that few have
    except ImportError as error:
        raise UsageError(f"{what}: needs the package {error.name}: {extra_command('parquet')}") from error


def write_rows(path: Path, names: Sequence[str], rows: Iterable[Row]) -> None:
    """Write rows as `.json`, `.jsonl`, `.parquet` or `.mcap`, with null for values that are not finite.

    Raises
    ------
    UsageError
        The file cannot be written; nothing is left behind.
    """
    match path.suffix.lower():
        case ".json":
            write_whole(path, _array(names, rows))
        case ".jsonl":
            write_whole(path, (f"{line}\n" for line in _objects(names, rows)))
        case ".parquet":
            with whole_file(path) as file:
                _write_parquet(file, names, iter(rows))
        case _:
            with whole_file(path) as file:
                _write_mcap(file, names, rows)


def session_table(chunks: Iterable[Session]) -> tuple[list[str], Iterator[Row]]:
    """Columns of the first chunk of a session, and the rows of all chunks."""
    stream = iter(chunks)
    first = next(stream)
    names = [name for name in COLUMNS if first.column(name) is not None]
    return names, (row for chunk in chain([first], stream) for row in _rows(chunk, names))


def _rows(chunk: Session, names: Sequence[str]) -> Iterator[Row]:
    columns = [chunk.filled(name).tolist() for name in names]
    if "seq" in names:
        index = names.index("seq")
        columns[index] = [None if seq < 0 else seq for seq in columns[index]]
    return zip(*columns, strict=True)


def _object(names: Sequence[str], row: Row) -> str:
    return json.dumps(dict(zip(names, map(finite, row), strict=True)), allow_nan=False)


def _objects(names: Sequence[str], rows: Iterable[Row]) -> Iterator[str]:
    return (_object(names, row) for row in rows)


def _array(names: Sequence[str], rows: Iterable[Row]) -> Iterator[str]:
    before = "["
    for line in _objects(names, rows):
        yield f"{before}{line}"
        before = ",\n"
    yield "]\n" if before != "[" else "[]\n"


def _write_parquet(file: BinaryIO, names: Sequence[str], rows: Iterator[Row]) -> None:
    import pyarrow as pa
    import pyarrow.parquet as pq

    schema = pa.schema([(name, pa.int64() if name == "seq" else pa.float64()) for name in names])
    with pq.ParquetWriter(file, schema) as writer:
        while piece := list(islice(rows, PIECE)):
            columns = zip(*(map(finite, row) for row in piece), strict=True)
            arrays = [pa.array(column, part.type) for column, part in zip(columns, schema, strict=True)]
            writer.write_table(pa.Table.from_arrays(arrays, schema=schema))


def _write_mcap(file: BinaryIO, names: Sequence[str], rows: Iterable[Row]) -> None:
    from mcap.writer import Writer

    writer = Writer(file)
    writer.start(library="gyrodrift")
    channel = writer.register_channel(TOPIC, "json", 0)
    time_index = list(names).index("t_device_s")
    for row in rows:
        log_ns = min(max(round((finite(row[time_index]) or 0.0) * 1e9), 0), LATEST_LOG_NS)
        writer.add_message(channel, log_ns, _object(names, row).encode(), log_ns)
    writer.finish()  # type: ignore[no-untyped-call]  # the package leaves it unannotated
