"""JSON files: written whole or not at all, and read with an error that names the file."""

import json
from pathlib import Path
from typing import Any

from gyrodrift.io.files import write_whole
from gyrodrift.values.errors import DataError


def write_json(path: Path, value: Any) -> None:
    """Write a value; its folder is made."""
    path.parent.mkdir(parents=True, exist_ok=True)
    write_whole(path, [json.dumps(value, indent=1, ensure_ascii=False) + "\n"])


def read_json(path: Path) -> Any:
    """Content of a file.

    Raises
    ------
    DataError
        It cannot be read or is no JSON.
    """
    try:
        return json.loads(path.read_text())
    except OSError as error:
        raise DataError(f"{path}: cannot be read: {error.strerror}") from error
    except ValueError as error:
        raise DataError(f"{path}: is no JSON: {error}") from error
