"""JSON as rows of text: an object a line, an array of objects, or an object of columns; digits stay as they are."""

import json
from collections.abc import Iterator, Mapping, Sequence
from itertools import islice
from pathlib import Path
from typing import Any

from gyrodrift.errors import DataError
from gyrodrift.session.tables.plan import Head
from gyrodrift.session.tables.text import Lines, opened

LOOKED_AT = 200
DEEPEST = 8
MOST_LABELS = 500
LONGEST_VECTOR = 20
"""A list that is longer is a column, not the axes of one sample."""


def is_json(path: Path) -> bool:
    """Whether a file begins as JSON does."""
    with opened(path) as file:
        first = next(iter(Lines(file)), "").lstrip()
    return first.startswith(("{", "[{", "[\n", "[\r")) or first.strip() == "["


def json_head(path: Path) -> Head:
    """The labels of a file of JSON: those of the objects at its beginning, inner ones as `gyro.z`."""
    objects = list(islice((found for _, found in json_objects(path) if found), LOOKED_AT))
    if not objects:
        raise DataError(f"{path}: has no JSON object with values")
    labels = tuple(islice(dict.fromkeys(label for found in objects for label in found), MOST_LABELS))
    return Head(path, labels, len(labels), 0, tuple(json_rows(objects, labels)))


def json_rows(objects: Sequence[Mapping[str, str]], labels: Sequence[str]) -> Iterator[list[str]]:
    """Each object as a row."""
    return ([found.get(label, "") for label in labels] for found in objects)


def json_objects(path: Path) -> Iterator[tuple[int, dict[str, str]]]:
    """The objects of a file with the numbers of their lines; an empty one stands for a line that is none."""
    with opened(path) as file:
        lines = Lines(file)
        first = next(iter(lines), "")
        found = _parsed(first)
        if isinstance(found, dict) and not any(map(_is_column, found.values())):
            yield lines.number, _flat(found)
            for line in lines:
                found = _parsed(line)
                yield lines.number, _flat(found) if isinstance(found, dict) else {}
            return
    yield from enumerate(_whole(path), 1)


def _is_column(value: Any) -> bool:
    return isinstance(value, list) and len(value) > LONGEST_VECTOR


def _parsed(text: str) -> Any:
    """What a text holds, numbers as they are written; None where it is no JSON."""
    try:
        return json.loads(text, parse_float=str, parse_int=str)
    except (ValueError, RecursionError):
        return None


def _whole(path: Path) -> Iterator[dict[str, str]]:
    """The objects of a file that is one value."""
    with opened(path) as file:
        found = _parsed(file.read())
    if isinstance(found, list):
        yield from (_flat(each) if isinstance(each, dict) else {} for each in found)
    elif isinstance(found, dict):
        columns = {name: values for name, values in found.items() if isinstance(values, list)}
        longest = max(map(len, columns.values()), default=0)
        for at in range(longest):
            yield _flat({name: values[at] for name, values in columns.items() if len(values) == longest})
    else:
        raise DataError(f"{path}: is neither JSON nor JSON lines: expected an object a line, or an array of objects")


def _flat(found: Mapping[str, Any], before: str = "", depth: int = 0) -> dict[str, str]:
    """The values of an object by their paths."""
    flat: dict[str, str] = {}
    for name, value in found.items():
        match value:
            case dict() if depth < DEEPEST:
                flat |= _flat(value, f"{before}{name}.", depth + 1)
            case list() if depth < DEEPEST:
                flat |= _flat({str(at): each for at, each in enumerate(value)}, f"{before}{name}.", depth + 1)
            case bool():
                flat[f"{before}{name}"] = str(int(value))
            case None:
                flat[f"{before}{name}"] = ""
            case _:
                flat[f"{before}{name}"] = str(value)
    return flat
