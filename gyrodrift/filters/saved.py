"""State of a filter as a table for a file: the differences from a new state."""

import reprlib
from dataclasses import fields, is_dataclass
from typing import Any

MOST = 1e15
"""Largest number in a table, which may come from anywhere. Chosen: its square is a finite float."""

FILE_KEYS = {
    ("BlockStats", "angle_deg"): "turned_deg",
    ("Hypothesis", "safe"): "settled",
    ("MeanTurns", "angle_deg"): "turned_deg",
    ("MeanTurns", "count"): "seen",
    ("NoiseModel", "same_blocks"): "mute_blocks",
    ("Witness", "agreeing_blocks"): "alike",
    ("Witness", "contradictions"): "doubt",
    ("Witness", "is_reporting_rest"): "is_claiming",
}
"""Key in a file of a record's field, if it is not the field's name. Recordings of all versions have this key."""


def saved(state: Any, new: Any) -> dict[str, Any]:
    """Differences of a state from a new one: a nested table by the keys of fields, and by indices in lists."""
    table: dict[str, Any] = {}
    for key, name in _fields_by_key(state).items():
        value, usual = getattr(state, name), getattr(new, name)
        if is_dataclass(value):
            part: Any = saved(value, usual)
        elif isinstance(value, list):
            pairs = enumerate(zip(value, usual, strict=True))
            part = {str(index): inner for index, (item, new_item) in pairs if (inner := saved(item, new_item))}
        elif value == usual:
            continue
        else:
            part = value
        if part != {}:
            table[key] = part
    return table


def restore(state: Any, table: dict[str, Any]) -> None:
    """Apply a table from `saved` to a new state.

    Raises
    ------
    ValueError
        If the table does not belong to such a state.
    """
    names = _fields_by_key(state)
    for key, value in table.items():
        if key not in names:
            raise ValueError(f"{type(state).__name__} has no {key}")
        current = getattr(state, names[key])
        if is_dataclass(current):
            restore(current, value)
        elif isinstance(current, list):
            for index, inner in value.items():
                restore(current[int(index)], inner)
        elif type(value) is type(current) and abs(value) <= MOST:
            setattr(state, names[key], value)
        else:
            raise ValueError(f"{key} is {reprlib.repr(value)}")


def _fields_by_key(record: Any) -> dict[str, str]:
    """Name of each field of a record by its key in a file."""
    kind = type(record).__name__
    return {FILE_KEYS.get((kind, field.name), field.name): field.name for field in fields(record)}
