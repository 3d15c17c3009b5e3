"""The state of a filter as a table of texts and numbers, to be kept in a file: what differs from a new one."""

import reprlib
from dataclasses import fields, is_dataclass
from typing import Any

MOST = 1e15
"""Beyond all that a filter holds; a table may come from anywhere, and squares of it have to be floats."""


def saved(state: Any, new: Any) -> dict[str, Any]:
    """What of a state is not as in a new one: a nested table by the names of fields, by places in lists."""
    found: dict[str, Any] = {}
    for each in fields(state):
        value, usual = getattr(state, each.name), getattr(new, each.name)
        if is_dataclass(value):
            part: Any = saved(value, usual)
        elif isinstance(value, list):
            pairs = enumerate(zip(value, usual, strict=True))
            part = {str(at): inner for at, (one, other) in pairs if (inner := saved(one, other))}
        elif value == usual:
            continue
        else:
            part = value
        if part != {}:
            found[each.name] = part
    return found


def restore(state: Any, table: dict[str, Any]) -> None:
    """Put a table that `saved` made into a new state.

    Raises
    ------
    ValueError
        Where it is none of such a state.
    """
    for name, value in table.items():
        if name not in {each.name for each in fields(state)}:
            raise ValueError(f"{type(state).__name__} has no {name}")
        held = getattr(state, name)
        if is_dataclass(held):
            restore(held, value)
        elif isinstance(held, list):
            for at, inner in value.items():
                restore(held[int(at)], inner)
        elif type(value) is type(held) and abs(value) <= MOST:
            setattr(state, name, value)
        else:
            raise ValueError(f"{name} is {reprlib.repr(value)}")
