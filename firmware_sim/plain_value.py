"""Values of words without quotes, as YAML 1.2 has them.

Apart from the parser of files, which takes 2 MB of memory: a service that takes its outputs from the command line does
without it.
"""

import re
from typing import Any

WHOLE_DIGITS = 300
"""Digits of a whole number; longer ones exceed all floats."""

NUMBER = re.compile(r"[-+]?(?:(?:0|[1-9]\d*+)(?:\.\d*+)?+|\.\d++)(?:[eE][-+]?\d++)?+")
INTEGER = re.compile(r"[-+]?(?:0|[1-9]\d*+)")
NOT_FINITE = re.compile(r"[-+]?\.(?:inf|nan)", re.IGNORECASE)
WORDS = {"true": True, "false": False, "null": None, "~": None, "": None}
"""YAML 1.2 has these words in small letters, capitalized and in capitals."""

STYLES = (str.lower, str.capitalize, str.upper)

Key = tuple[str | int, ...]
"""Path from the top of the file to a value: ("hdr", "tau_s")."""


def plain_value(text: str) -> Any:
    """Value of a word without quotes: a number, a truth value, None, or the text."""
    if text.lower() in WORDS and any(text == style(text) for style in STYLES):
        return WORDS[text.lower()]
    if INTEGER.fullmatch(text) and len(text) <= WHOLE_DIGITS:
        return int(text)
    if NUMBER.fullmatch(text):
        return float(text)
    return float(text.replace(".", "", 1)) if NOT_FINITE.fullmatch(text) else text
