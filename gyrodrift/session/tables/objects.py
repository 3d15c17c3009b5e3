"""JSON as rows of text: an object per line, an array of objects, or an object of columns; all digits stay."""

import json
from collections.abc import Iterator, Mapping, Sequence
from itertools import islice
from pathlib import Path
from typing import Any

from gyrodrift.session.tables.plan import Head
from gyrodrift.session.tables.text import Lines, opened
from gyrodrift.values.errors import DataError

LOOKED_AT = 200
DEEPEST = 8
MOST_LABELS = 500
LONGEST_VECTOR = 20
"""A longer list is a column, not the axes of a sample."""


def is_json(path: Path) -> bool:
    """Whether a file begins like JSON."""
    with opened(path) as file:
        first = next(iter(Lines(file)), "").lstrip()
    return first.startswith(("{", "[{", "[\n", "[\r")) or first.strip() == "["


def json_head(path: Path) -> Head:
    """Labels of the first objects of a JSON file, nested ones as `gyro.z`, and their rows."""
    objects = list(islice((values for _, values in json_objects(path) if values), LOOKED_AT))
    if not objects:
        raise DataError(f"{path}: has no JSON object with values")
    labels = tuple(islice(dict.fromkeys(label for values in objects for label in values), MOST_LABELS))
    return Head(path, labels, len(labels), 0, tuple(json_rows(objects, labels)))


def json_rows(objects: Sequence[Mapping[str, str]], labels: Sequence[str]) -> Iterator[list[str]]:
    """Objects as rows."""
    return ([values.get(label, "") for label in labels] for values in objects)


def json_objects(path: Path) -> Iterator[tuple[int, dict[str, str]]]:
    """Objects of a file with their line numbers; empty for a line without an object."""
    with opened(path) as file:
        lines = Lines(file)
        first = next(iter(lines), "")
        value = _parsed(first)
        if isinstance(value, dict) and not any(map(_is_column, value.values())):
            yield lines.number, _flat(value)
            for line in lines:
                value = _parsed(line)
                yield lines.number, _flat(value) if isinstance(value, dict) else {}
            return
    yield from enumerate(_whole(path), 1)


def _is_column(value: Any) -> bool:
    return isinstance(value, list) and len(value) > LONGEST_VECTOR


def _parsed(text: str) -> Any:
    """Value of a JSON text, numbers as text; None if it is not JSON."""
    try:
        return json.loads(text, parse_float=str, parse_int=str)
    except (ValueError, RecursionError):
        return None


def _whole(path: Path) -> Iterator[dict[str, str]]:
    """Objects of a file that is a single JSON value."""
    with opened(path) as file:
        content = _parsed(file.read())
    if isinstance(content, list):
        yield from (_flat(item) if isinstance(item, dict) else {} for item in content)
    elif isinstance(content, dict):
        columns = {name: values for name, values in content.items() if isinstance(values, list)}
        longest = max(map(len, columns.values()), default=0)
        for index in range(longest):
            yield _flat({name: values[index] for name, values in columns.items() if len(values) == longest})
    else:
        raise DataError(f"{path}: is neither JSON nor JSON lines: expected an object per line, or an array of objects")


def _flat(values: Mapping[str, Any], before: str = "", depth: int = 0) -> dict[str, str]:
    """Values of an object by their paths."""
    flat: dict[str, str] = {}
    for name, value in values.items():
        match value:
            case dict() if depth < DEEPEST:
                flat |= _flat(value, f"{before}{name}.", depth + 1)
            case list() if depth < DEEPEST:
                flat |= _flat({str(index): item for index, item in enumerate(value)}, f"{before}{name}.", depth + 1)
            case bool():
                flat[f"{before}{name}"] = str(int(value))
            case None:
                flat[f"{before}{name}"] = ""
            case _:
                flat[f"{before}{name}"] = str(value)
    return flat
