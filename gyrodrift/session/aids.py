"""Measurements of second sources in a session, each with the sample that it came with, and as text in files.

Without numpy, because the service writes them.
"""

import json
from collections.abc import Iterable, Mapping, Sequence
from math import isfinite, nan
from typing import Any
from urllib.parse import quote, unquote

from gyrodrift.values.aid import AID_KINDS, Aid

COLUMN = "aids"
"""Name of the column in a file of text."""

RowAid = tuple[int, Aid]
"""Index of a sample, and a measurement that came with it or since the sample before; in the order of the samples."""

RowAids = tuple[RowAid, ...]
BETWEEN = " | "
"""Between the measurements of a cell; a quoted name has neither blanks nor bars."""

NUMBERS = ("t_s", "sigma", "period_deg", "speed")
PLAIN = Aid("", "standing", nan)
"""Numbers of a measurement that are not written."""


def aids_by_row(aids: Iterable[RowAid]) -> dict[int, tuple[Aid, ...]]:
    """Measurements by the index of their sample."""
    by_row: dict[int, tuple[Aid, ...]] = {}
    for row, aid in aids:
        by_row[row] = (*by_row.get(row, ()), aid)
    return by_row


def aid_values(aid: Aid) -> dict[str, Any]:
    """A measurement as plain values, without the numbers that are unknown."""
    values: dict[str, Any] = {"name": aid.name, "kind": aid.kind, "value": aid.value}
    return values | {
        name: number for name in NUMBERS if isfinite(number := getattr(aid, name)) and number != getattr(PLAIN, name)
    }


def aid_of(values: Mapping[str, Any]) -> Aid:
    """Measurement of plain values.

    Raises
    ------
    ValueError
        They are none.
    """
    try:
        name, kind, value = values["name"], values["kind"], float(values["value"])
        numbers = [float(values.get(number, getattr(PLAIN, number))) for number in NUMBERS]
    except (KeyError, TypeError, OverflowError, AttributeError) as error:
        raise ValueError(f"is no measurement of a second source: {error}") from error
    if kind not in AID_KINDS or not isinstance(name, str) or not isfinite(value):
        raise ValueError(f"is no measurement of a second source, such as {AID_KINDS[0]}")
    return Aid(name, kind, value, *numbers)


def numbered_aid(content: bytes) -> RowAid:
    """Number of the sample and measurement of a JSON object.

    Raises
    ------
    ValueError
        It is none.
    """
    try:
        values = json.loads(content)
        return int(values["sample"]), aid_of(values)
    except (KeyError, TypeError, OverflowError, RecursionError) as error:
        raise ValueError(f"is no measurement: {error}") from error


def aids_text(aids: Sequence[Aid]) -> str:
    """Measurements as a cell of a table without commas and quotes: `course heading 87.1 t_s=12.3 sigma=2.0`."""
    return BETWEEN.join(map(_text, aids))


def _text(aid: Aid) -> str:
    name, kind, value, *further = aid_values(aid).items()
    words = [quote(name[1], safe=""), kind[1], repr(value[1]), *(f"{key}={number!r}" for key, number in further)]
    return " ".join(words)


def aids_in(text: str) -> tuple[Aid, ...]:
    """Measurements of a cell.

    Raises
    ------
    ValueError
        It has another form.
    """
    return tuple(_aid_in(part.split()) for part in text.split("|")) if text.strip() else ()


def _aid_in(words: Sequence[str]) -> Aid:
    names = ("name", "kind", "value")
    values = dict(zip(names, words, strict=False)) | dict(word.split("=", 1) for word in words[len(names) :])
    return aid_of(values | {"name": unquote(values.get("name", ""))})
