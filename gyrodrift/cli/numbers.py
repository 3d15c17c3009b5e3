"""Numbers on a command line: plain decimal digits, and within what the option can mean.

Python takes more for a number: digits of any script, underscores, NaN and infinity, and thousands of digits.
"""

import argparse
import re
from collections.abc import Callable

from gyrodrift.errors import UsageError, shortened

DECIMAL = re.compile(r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]{1,4})?")
WHOLE = re.compile(r"[+-]?[0-9]+")
LONGEST_DIGITS = 40
"""More than any number needs that fits into 64 bits."""

ABOVE_0 = 1e-9
"""The least number that counts as above 0: its reciprocal is still one."""

MOST_SECONDS = 1e9
"""Thirty years."""

MOST_JOBS = 1024
MOST_SEED = 2**63 - 1
BAUD = re.compile(r"[0-9]{1,9}")
ROTATION = re.compile(r"([0-9]{1,15}(?:\.[0-9]{1,9})?) ?([A-Za-z]{1,3})")
SIZES = {"kb": 1000, "mb": 1_000_000, "gb": 1_000_000_000}
TIMES_S = {"s": 1.0, "min": 60.0, "h": 3600.0}


def parsed(text: str) -> float | None:
    """The number that a text is; None where it is none."""
    return float(text) if len(text) <= LONGEST_DIGITS and DECIMAL.fullmatch(text) else None


def number(most: float, expected: str = "a number above 0", least: float = ABOVE_0) -> Callable[[str], float]:
    """A reader of numbers from `least` to `most`, for `add_argument`; `expected` is what a person is told."""

    def read(text: str) -> float:
        value = parsed(text)
        if value is None or not value >= least:
            raise argparse.ArgumentTypeError(f"expected {expected}")
        if value > most:
            raise argparse.ArgumentTypeError(f"expected {expected}, {most:.10g} at most")
        return value

    return read


def whole(most: int, expected: str = "a number above 0", least: int = 1) -> Callable[[str], int]:
    """The same of whole numbers."""

    def read(text: str) -> int:
        value = int(text) if len(text) <= LONGEST_DIGITS and WHOLE.fullmatch(text) else None
        if value is None or value < least:
            raise argparse.ArgumentTypeError(f"expected {expected}")
        if value > most:
            raise argparse.ArgumentTypeError(f"expected {expected}, {most} at most")
        return value

    return read


seconds = number(MOST_SECONDS)
seed = whole(MOST_SEED, "a whole number from 0", least=0)


def baud(text: str) -> int | None:
    """A line rate; None for `auto`."""
    if text == "auto":
        return None
    if not BAUD.fullmatch(text) or int(text) == 0:
        raise UsageError(f"--baud {shortened(text, 40)}: expected a rate in baud such as 115200, or auto")
    return int(text)


def rotation(text: str | None) -> tuple[int | None, float | None]:
    """Bytes and seconds at which a new file begins, from `--rotate`; None for never."""
    if text is None:
        return None, None
    found = ROTATION.fullmatch(text)
    value, unit = (float(found[1]), found[2].lower()) if found else (0.0, "")
    if unit in SIZES and value * SIZES[unit] >= 1.0:
        return round(value * SIZES[unit]), None
    if unit in TIMES_S and value > 0.0:
        return None, value * TIMES_S[unit]
    expected = "a size such as 100MB or 2GB, or a time such as 90s, 30min or 1h"
    raise UsageError(f"--rotate {shortened(text, 40)}: expected {expected}")
