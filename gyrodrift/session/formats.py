"""Writing a session by the ending of its path, whole or not at all."""

from collections.abc import Iterable
from pathlib import Path

from gyrodrift.errors import UsageError
from gyrodrift.files import whole_file, write_whole
from gyrodrift.session.session import Session


def write_session(path: Path, chunks: Iterable[Session], metadata: dict[str, dict[str, str]] | None = None) -> None:
    """Write the consecutive chunks of a session; `metadata` goes along where the format has room for it.

    Raises
    ------
    UsageError
        Where the ending is unknown or the place cannot be written to; nothing is left behind then.
    """
    if path.suffix == ".csv":
        from gyrodrift.session.csv import csv_pieces  # noqa: PLC0415 - each format costs only who writes it

        write_whole(path, csv_pieces(chunks))
    elif path.suffix == ".mcap":
        _write_mcap(path, chunks, metadata)
    else:
        raise UsageError(f"{path}: sessions end in .mcap or .csv, not {path.suffix or 'nothing'}")


def _write_mcap(path: Path, chunks: Iterable[Session], metadata: dict[str, dict[str, str]] | None) -> None:
    from gyrodrift.session.mcap.read import add_chunk  # noqa: PLC0415
    from gyrodrift.session.mcap.write import McapWriter  # noqa: PLC0415

    with whole_file(path) as file:
        writer = McapWriter(file, metadata)
        for chunk in chunks:
            add_chunk(writer, chunk)
        writer.finish()
