"""State of a filter as a table for a file: the differences from a new state."""

import reprlib
from dataclasses import fields, is_dataclass
from typing import Any

MOST = 1e15
"""Largest number in a table, which may come from anywhere; its square is a finite float."""


def saved(state: Any, new: Any) -> dict[str, Any]:
    """Differences of a state from a new one: a nested table by field names, and by indices in lists."""
    table: dict[str, Any] = {}
    for field in fields(state):
        value, usual = getattr(state, field.name), getattr(new, field.name)
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
            table[field.name] = part
    return table


def restore(state: Any, table: dict[str, Any]) -> None:
    """Apply a table from `saved` to a new state.

    Raises
    ------
    ValueError
        If the table does not belong to such a state.
    """
    for name, value in table.items():
        if name not in {field.name for field in fields(state)}:
            raise ValueError(f"{type(state).__name__} has no {name}")
        current = getattr(state, name)
        if is_dataclass(current):
            restore(current, value)
        elif isinstance(current, list):
            for index, inner in value.items():
                restore(current[int(index)], inner)
        elif type(value) is type(current) and abs(value) <= MOST:
            setattr(state, name, value)
        else:
            raise ValueError(f"{name} is {reprlib.repr(value)}")
