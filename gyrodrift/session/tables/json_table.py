"""JSON as rows: an object per line, objects over several lines, an array of objects, or lists of values."""

import json
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import islice
from pathlib import Path
from typing import Any

from gyrodrift.columns.units import Dimension, unit_in
from gyrodrift.session.tables.plan import Head
from gyrodrift.session.tables.text import Lines, opened
from gyrodrift.values.errors import DataError

LOOKED_AT = 200
DEEPEST = 8
MOST_LABELS = 500
LONGEST_VECTOR = 20
"""A longer list is a column, not the axes of a sample."""

VALUE = re.compile(r"[^\s,]")
NUMERIC = re.compile(r"[-+]?\.?\d")
INTERVAL = re.compile(r"interval|period|step|\bdt\b", re.IGNORECASE)
FREQUENCY = re.compile(r"freq|sampl\w*[ _]?rate|_hz$|^hz$|^fs$", re.IGNORECASE)


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
        if isinstance(value, dict) and not any(map(_is_column, value.values())) and not list(_table_in(value)):
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
    """Objects of a file with a single JSON value, or with objects over several lines each."""
    with opened(path) as file:
        values = list(_values(file.read()))
    content = values[0] if len(values) == 1 else values
    if isinstance(content, list) and content:
        yield from (_flat(item) if isinstance(item, dict) else {} for item in content)
    elif isinstance(content, dict):
        if rows := list(_table_in(content)):
            yield from rows
            return
        columns = dict(_columns_in(content))
        longest = max(map(len, columns.values()), default=0)
        for index in range(longest):
            yield _flat({name: values[index] for name, values in columns.items() if len(values) == longest})
    else:
        raise DataError(f"{path}: is neither JSON nor JSON lines: expected objects, or an array of objects")


def _columns_in(
    content: Mapping[str, Any], before: str = "", deepest: int = DEEPEST
) -> Iterator[tuple[str, list[Any]]]:
    """Lists in an object with their paths."""
    for name, value in content.items():
        if isinstance(value, list):
            yield f"{before}{name}", value
        elif isinstance(value, dict) and deepest:
            yield from _columns_in(value, f"{before}{name}.", deepest - 1)


def _values(text: str) -> Iterator[Any]:
    """JSON values one after another; None for a damaged one."""
    decoder, position = json.JSONDecoder(parse_float=str, parse_int=str), 0
    while first := VALUE.search(text, position):
        try:
            value, position = decoder.raw_decode(text, first.start())
        except (ValueError, RecursionError):
            value, position = None, text.find("\n{", first.end())
        yield value
        if position < 0:
            return


def _table_in(content: Mapping[str, Any], deepest: int = 3) -> Iterator[dict[str, str]]:
    """Rows of an object that has a list of objects, or lists of values beside the names of their columns.

    Edge Impulse and pandas write such names. An interval or a rate beside them gives the time.
    """
    lists = {name: values for name, values in content.items() if isinstance(values, list) and values}
    for rows in lists.values():
        if len(rows) > LONGEST_VECTOR and all(isinstance(row, dict) for row in rows):
            yield from map(_flat, rows)
            return
        width = len(rows[0]) if isinstance(rows[0], list) else 0
        names = next((labels for values in lists.values() if len(labels := _labels(values)) == width > 0), None)
        if names is not None and all(isinstance(row, list) and len(row) == width for row in rows):
            clock = _clock(content)
            for index, row in enumerate(rows):
                yield clock(index) | _flat(dict(zip(names, row, strict=True)))
            return
    if deepest:
        for inner in content.values():
            if isinstance(inner, dict):
                yield from _table_in(inner, deepest - 1)


def _labels(values: Sequence[Any]) -> list[str]:
    """Names of columns with their units; empty for other lists."""
    labels = []
    for value in values:
        name = value.get("name") if isinstance(value, dict) else value
        unit = value.get("units", value.get("unit")) if isinstance(value, dict) else None
        if not isinstance(name, str) or NUMERIC.match(name):
            return []
        labels.append(f"{name} ({unit})" if isinstance(unit, str) and unit else name)
    return labels


def _clock(content: Mapping[str, Any]) -> Callable[[int], dict[str, str]]:
    """Time of a row by its index; empty without an interval in a unit of time, or a rate in Hz."""
    for name, value in content.items():
        unit = unit_in(name)
        if not isinstance(value, str) or not NUMERIC.match(value) or not float(value) > 0.0:
            continue
        if INTERVAL.search(name) and unit is not None and unit.dimension is Dimension.TIME:
            return lambda index: {f"time ({unit.option.removeprefix('t_')})": f"{index * float(value):.9g}"}
        if FREQUENCY.search(name):
            return lambda index: {"time (s)": f"{index / float(value):.9g}"}
    return lambda _: {}


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
