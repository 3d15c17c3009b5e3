"""Numbers on a command line: decimal digits, within the bounds of the option.

Python takes more for a number: digits of any script, underscores, NaN and infinity, and thousands of digits.
"""

import argparse
import re
from collections.abc import Callable

from gyrodrift.values.errors import UsageError, shortened

DECIMAL = re.compile(r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]{1,4})?")
WHOLE = re.compile(r"[+-]?[0-9]+")
LONGEST_DIGITS = 40
"""Longest number, characters: more than 64 bits need."""

ABOVE_0 = 1e-9
"""Smallest number that counts as above 0: its reciprocal is finite."""

MOST_SECONDS = 1e9
"""Thirty years."""

MOST_JOBS = 1024
MOST_SEED = 2**63 - 1
BAUD = re.compile(r"[0-9]{1,9}")
ROTATION = re.compile(r"([0-9]{1,15}(?:\.[0-9]{1,9})?) ?([A-Za-z]{1,3})")
SIZES = {"kb": 1000, "mb": 1_000_000, "gb": 1_000_000_000}
TIMES_S = {"s": 1.0, "min": 60.0, "h": 3600.0}


def parsed(text: str) -> float | None:
    """Parse a number; None if the text is no number."""
    return float(text) if len(text) <= LONGEST_DIGITS and DECIMAL.fullmatch(text) else None


def number(most: float, expected: str = "a number above 0", least: float = ABOVE_0) -> Callable[[str], float]:
    """Parser of numbers from `least` to `most` for `add_argument`; `expected` is for the error message."""

    def read(text: str) -> float:
        value = parsed(text)
        if value is None or not value >= least:
            raise argparse.ArgumentTypeError(f"expected {expected}")
        if value > most:
            raise argparse.ArgumentTypeError(f"expected {expected}, {most:.10g} at most")
        return value

    return read


def whole(most: int, expected: str = "a number above 0", least: int = 1) -> Callable[[str], int]:
    """Parser of whole numbers."""

    def read(text: str) -> int:
        value = int(text) if len(text) <= LONGEST_DIGITS and WHOLE.fullmatch(text) else None
        if value is None or value < least:
            raise argparse.ArgumentTypeError(f"expected {expected}")
        if value > most:
            raise argparse.ArgumentTypeError(f"expected {expected}, {most} at most")
        return value

    return read


DURATION = "a time in s above 0, or such as 90s, 30min or 1h"


def duration(text: str) -> float:
    """Parse a time with or without a unit, in seconds."""
    match = ROTATION.fullmatch(text)
    factor = TIMES_S.get(match[2].lower()) if match else None
    if match is None or factor is None:
        return number(MOST_SECONDS, DURATION)(text)
    return number(MOST_SECONDS / factor, DURATION)(match[1]) * factor


def minutes(text: str) -> float:
    """Parse a time with or without a unit, in minutes."""
    return duration(text) / TIMES_S["min"]


seed = whole(MOST_SEED, "a whole number from 0", least=0)


def baud(text: str) -> int | None:
    """Line rate in baud; None for `auto`."""
    if text == "auto":
        return None
    if not BAUD.fullmatch(text) or int(text) == 0:
        raise UsageError(f"--baud {shortened(text, 40)}: expected a rate in baud such as 115200, or auto")
    return int(text)


def rotation(text: str | None) -> tuple[int | None, float | None]:
    """Bytes and seconds of `--rotate` at which a new file begins; None for never."""
    if text is None:
        return None, None
    match = ROTATION.fullmatch(text)
    value, unit = (float(match[1]), match[2].lower()) if match else (0.0, "")
    if unit in SIZES and value * SIZES[unit] >= 1.0:
        return round(value * SIZES[unit]), None
    if unit in TIMES_S and value > 0.0:
        return None, value * TIMES_S[unit]
    expected = "a size such as 100MB or 2GB, or a time such as 90s, 30min or 1h"
    raise UsageError(f"--rotate {shortened(text, 40)}: expected {expected}")
