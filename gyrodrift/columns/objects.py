"""Object in braces: JSON (RFC 8259), or a dictionary as Python and MicroPython print it.

A device can send anything, so the Python parser is never used. A printed dictionary has only strings, numbers, lists,
tuples and three words. Its tokens are rewritten as JSON in one pass, and parsed as JSON. Numbers remain text, so
nothing overflows.
"""

import json
import re
from typing import Any

LONGEST_CHARACTERS = 4096
"""Longest object; above, the line is damaged. Devices that send an object per sample need a tenth of it."""

BRACKETS_MAX = 64
"""Largest number of opening brackets, which limits the recursion of the JSON parser."""

DEEPEST = 4
"""Largest depth of nested objects that are read."""

STRING = r"b?+'((?:[^'\\]|\\.)*+)'|b?+\"((?:[^\"\\]|\\.)*+)\""
NUMERAL = r"[-+]?(?:[0-9]++(?:\.[0-9]*+)?+|\.[0-9]++)(?:[eE][-+]?[0-9]++)?+|[-+]?(?:nan|inf)"
TOKEN = re.compile(rf"\s*+(?:{STRING}|({NUMERAL})|(None|True|False)|([{{\[(])|(,?+\s*+[\]}})])|([,:]))")
"""Tokens; a comma before a closing bracket belongs to the bracket, as in `(1,)`."""

WORDS = {"None": "null", "True": "true", "False": "false"}
BRACKETS = {"{": "{", "}": "}", "[": "[", "]": "]", "(": "[", ")": "]"}


Leaf = tuple[tuple[str, ...], str]
"""Path of names to a value, and the value as text."""


def leaves_of(line: str) -> list[Leaf] | None:
    """Strings and numbers of an object, with paths such as (`gyro`, `z`); None if the object is damaged.

    An object with a repeated name counts as damaged.
    """
    if len(line) > LONGEST_CHARACTERS or line.count("{") + line.count("[") + line.count("(") > BRACKETS_MAX:
        return None
    text = line if '"' in line else _as_json(line.rstrip())
    try:
        content = json.loads(
            text, parse_int=str, parse_float=str, parse_constant=_constant, object_pairs_hook=_without_repeats
        )
    except ValueError:
        return None
    return _leaves(content, (), DEEPEST)


def _as_json(line: str) -> str:
    """Printed dictionary as JSON, with its numbers in quotes; empty if it has other content."""
    written, position = [], 0
    while position < len(line):
        match = TOKEN.match(line, position)
        if match is None:
            return ""
        written.append(_token(match))
        position = match.end()
    return "".join(written)


def _token(match: re.Match[str]) -> str:
    single, double, numeral, word, opening, closing, mark = match.groups()
    if single is not None or double is not None or numeral is not None:
        return json.dumps(next(text for text in (single, double, numeral) if text is not None))
    return WORDS[word] if word else BRACKETS[opening or closing[-1]] if opening or closing else mark


def _constant(name: str) -> str:
    """NaN, Infinity and -Infinity in Python spelling."""
    return str(float(name))


def _without_repeats(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    content = dict(pairs)
    if len(content) < len(pairs):
        raise ValueError("a name stands twice")
    return content


def _leaves(content: Any, path: tuple[str, ...], deepest: int) -> list[Leaf]:
    if isinstance(content, dict | list) and deepest:
        pairs = content.items() if isinstance(content, dict) else enumerate(content)
        inside = (_leaves(value, (*path, str(key)), deepest - 1) for key, value in pairs)
        return [leaf for leaves in inside for leaf in leaves]
    return [(path, content)] if isinstance(content, str) else []
