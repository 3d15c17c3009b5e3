"""An object in braces: JSON (RFC 8259), or a dictionary as Python and MicroPython print it.

A device can send anything, so a line is never handed to a parser of Python. A printed dictionary has no more than
strings, numbers, lists, tuples and three words: its tokens are written as JSON in one pass, and the JSON parser judges
the outcome. Numbers stay the text that they were. Thus no digits are too many, and nothing overflows here.
"""

import json
import re
from typing import Any

LONGEST_CHARACTERS = 4096
"""A longer object is damaged. Devices that send one for each measurement need a tenth of that."""

MOST_BRACKETS = 64
"""So many opening brackets at most, which bounds the depth: the JSON parser calls itself once for each level."""

DEEPEST = 4
"""Objects within objects that are looked into."""

STRING = r"b?+'((?:[^'\\]|\\.)*+)'|b?+\"((?:[^\"\\]|\\.)*+)\""
NUMERAL = r"[-+]?(?:[0-9]++(?:\.[0-9]*+)?+|\.[0-9]++)(?:[eE][-+]?[0-9]++)?+|[-+]?(?:nan|inf)"
TOKEN = re.compile(rf"\s*+(?:{STRING}|({NUMERAL})|(None|True|False)|([{{\[(])|(,?+\s*+[\]}})])|([,:]))")
"""A comma before a closing bracket belongs to it: `(1,)` is a tuple of one."""

WORDS = {"None": "null", "True": "true", "False": "false"}
BRACKETS = {"{": "{", "}": "}", "[": "[", "]": "]", "(": "[", ")": "]"}


Leaf = tuple[tuple[str, ...], str]
"""The names that lead to a value, and the value as text."""


def leaves_of(line: str) -> list[Leaf] | None:
    """Strings and numbers of an object, `gyro`, `z` or `gyro`, `2` before each; None where the object is damaged.

    An object that says a name twice is damaged: nobody knows which of the two values counts.
    """
    if len(line) > LONGEST_CHARACTERS or line.count("{") + line.count("[") + line.count("(") > MOST_BRACKETS:
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
    """A printed dictionary as JSON, its numbers in quotes; empty where there is something else in it."""
    written, at = [], 0
    while at < len(line):
        found = TOKEN.match(line, at)
        if found is None:
            return ""
        written.append(_token(found))
        at = found.end()
    return "".join(written)


def _token(found: re.Match[str]) -> str:
    single, double, numeral, word, opening, closing, mark = found.groups()
    if single is not None or double is not None or numeral is not None:
        return json.dumps(next(text for text in (single, double, numeral) if text is not None))
    return WORDS[word] if word else BRACKETS[opening or closing[-1]] if opening or closing else mark


def _constant(name: str) -> str:
    """NaN, Infinity and -Infinity in the words that other numbers without end have."""
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
