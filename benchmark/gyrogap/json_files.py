"""JSON files: written whole or not at all, and read with an error that names the file."""

import json
from pathlib import Path
from typing import Any

from gyrodrift.io import files
from gyrodrift.io.files import UnreadableError, write_whole
from gyrodrift.values.errors import DataError

LONGEST_BYTES = 16 << 20
"""Largest file that is read; the manifest of 10,000 cases has 2 MB."""


def write_json(path: Path, value: Any) -> None:
    """Write a value; its folder is made."""
    path.parent.mkdir(parents=True, exist_ok=True)
    write_whole(path, [json.dumps(value, indent=1, ensure_ascii=False) + "\n"])


def read_json(path: Path) -> Any:
    """Content of a file, which may come from a stranger.

    Raises
    ------
    DataError
        It cannot be read or is no JSON.
    """
    try:
        return files.read_json(path, LONGEST_BYTES)
    except FileNotFoundError as error:
        raise DataError(f"{path}: cannot be read: {error.strerror}") from error
    except UnreadableError as error:
        raise DataError(f"{path}: {error}") from error


def object_of(value: Any, kinds: dict[str, type], path: Path, name: str) -> dict[str, Any]:
    """A JSON object that has these keys, each with a value of its type.

    Raises
    ------
    DataError
        It is something else.
    """
    if not isinstance(value, dict):
        raise DataError(f"{path}: {name} is no object")
    for key, kind in kinds.items():
        if not isinstance(value.get(key), kind) or isinstance(value[key], bool):
            raise DataError(f"{path}: {name} needs the key {key} with a value of the type {kind.__name__}")
    return value
