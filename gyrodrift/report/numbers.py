"""Numbers for readers: no exponents, three digits, equally many decimals within a column; and numbers as JSON files."""

import json
from collections.abc import Sequence
from math import floor, isfinite, log10
from pathlib import Path

import numpy as np

from gyrodrift.io.files import write_whole
from gyrodrift.io.json_numbers import finite_values

SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")

Numbers = Sequence[float]


def mean(values: Numbers) -> float:
    """Mean; NaN without values."""
    return float(np.mean(values)) if len(values) else float("nan")


def significant(value: float, digits: int) -> str:
    """A number with so many significant digits, without an exponent if it is between 1e-7 and 1e9."""
    if not isfinite(value):
        return _no_number(value)
    if value != 0.0 and not 1e-7 <= abs(value) < 1e9:
        return f"{value:.{digits}g}"
    return np.format_float_positional(value, digits, fractional=False, trim="-")


def minus(words: str) -> str:
    """Text with a true minus."""
    return words.replace("-", "−")


def degrees(value: float) -> str:
    """An angle with three digits."""
    return f"{even([value])[0]}°"


def even(values: Numbers) -> list[str]:
    """Numbers of a column with equally many decimals, three digits at the median."""
    sizes = [abs(value) for value in values if isfinite(value) and value != 0.0]
    middle = float(np.median(sizes)) if sizes else 1.0
    if middle >= 1e9:
        return [significant(value, 3) for value in values]
    decimals = min(max(2 - floor(log10(middle)), 0), 5)
    return [f"{value:.{decimals}f}" if isfinite(value) else _no_number(value) for value in values]


def _no_number(value: float) -> str:
    return "∞" if value > 0.0 else "–"


def log_share(value: float, low: float, high: float) -> float:
    """Position of a value on a logarithmic scale from 0 to 1; a value beyond an end, or none, is at the end."""
    inside = min(max(value, low), high) if isfinite(value) else high
    return log10(inside / low) / log10(high / low)


def factor_label(value: float) -> str:
    """Label of a logarithmic scale: 100 and 0.01 as they are, but 10⁶ instead of many zeros."""
    if value <= 0.0 or 1e-3 <= value < 1e4:
        return f"{value:g}"
    power = int(np.floor(np.log10(value) + 1e-9))
    share = value / 10.0**power
    return ("" if abs(share - 1.0) < 1e-6 else f"{share:.3g}·") + "10" + str(power).translate(SUPERSCRIPTS)


def write_json(path: Path, content: object) -> None:
    """Write a file, whole or not at all; numbers that are not finite are null.

    Raises
    ------
    UsageError
        If the path cannot be written.
    """
    write_whole(path, [json.dumps(finite_values(content), indent=1, allow_nan=False, ensure_ascii=False), "\n"])


def aligned(rows: Sequence[Sequence[str]]) -> list[str]:
    """Lines of aligned columns, the first left-aligned and the others right-aligned."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return ["  ".join([row[0].ljust(widths[0]), *map(str.rjust, row[1:], widths[1:])]).rstrip() for row in rows]
