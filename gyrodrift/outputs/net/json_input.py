"""JSON parser for the input of clients, with a limit on depth and one kind of error.

The connection limits the bytes (`limits`). The parser of the standard library raises RecursionError for deep nesting
and ValueError for long integers, and it takes NaN and Infinity, which are no JSON.
"""

import json
from typing import Any, NoReturn

DEEPEST = 16
"""Deepest nesting; no protocol of an output needs more than five levels."""


class NotJsonError(ValueError):
    """The text is no JSON, or is nested too deeply; the message is for the client."""


def _refuse_constant(name: str) -> NoReturn:
    raise ValueError(f"{name} is no JSON")


_DECODER = json.JSONDecoder(parse_constant=_refuse_constant)


def parse_json(text: str | bytes) -> Any:
    """Parse a JSON text.

    Raises
    ------
    NotJsonError
        If the text is no JSON.
    """
    try:
        decoded = text if isinstance(text, str) else text.decode()
        value, end = _DECODER.raw_decode(decoded, _blanks(decoded, 0))
    except (ValueError, RecursionError):  # a JSONDecodeError and a UnicodeDecodeError are ValueErrors
        raise NotJsonError("this is no JSON") from None
    if _blanks(decoded, end) != len(decoded):
        raise NotJsonError("this is no JSON")
    _check_depth(decoded, value)
    return value


def parse_json_at(text: str, start: int) -> tuple[Any, int]:
    """Parse the JSON value at an index; returns it with the index behind it.

    Raises
    ------
    NotJsonError
        If the text is no JSON.
    """
    try:
        value, end = _DECODER.raw_decode(text, start)
    except (ValueError, RecursionError):
        raise NotJsonError("this is no JSON") from None
    _check_depth(text[start:end], value)
    return value, end


def _blanks(text: str, start: int) -> int:
    """Index of the first character that is no JSON blank."""
    return len(text) - len(text[start:].lstrip(" \t\r\n"))


def _check_depth(text: str, value: Any) -> None:
    if text.count("[") + text.count("{") <= DEEPEST:
        return
    level = _containers([value])
    for _ in range(DEEPEST):
        level = [inner for container in level for inner in _containers(container)]
    if level:
        raise NotJsonError(f"this is nested more than {DEEPEST} deep")


def _containers(value: Any) -> list[Any]:
    """Arrays and objects directly inside a value."""
    inside = value.values() if isinstance(value, dict) else value
    return [item for item in inside if isinstance(item, (dict, list))]
