"""Numbers of an analysis as a JSON file, and as columns for a terminal."""

import json
from collections.abc import Sequence
from pathlib import Path

from gyrodrift.io.files import write_whole
from gyrodrift.io.json_numbers import finite_values


def write_json(path: Path, content: object) -> None:
    """Write a file, whole or not at all; numbers that are not finite are null.

    Raises
    ------
    UsageError
        If the path cannot be written.
    """
    write_whole(path, [json.dumps(finite_values(content), indent=1, allow_nan=False, ensure_ascii=False), "\n"])


def aligned(rows: Sequence[Sequence[str]]) -> list[str]:
    """Lines of aligned columns, the first left-aligned and the others right-aligned."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return ["  ".join([row[0].ljust(widths[0]), *map(str.rjust, row[1:], widths[1:])]).rstrip() for row in rows]
