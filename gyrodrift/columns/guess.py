"""Verdict on an unknown text from some of its lines: the usual layout of a line, and the columns in it."""

import re
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from gyrodrift.columns.fields import Fields, Form, Headings, as_label, is_number
from gyrodrift.columns.judge import ColumnVerdict, judged
from gyrodrift.columns.names import name_by_label
from gyrodrift.columns.naming import seen_columns
from gyrodrift.columns.spec import IGNORED

LINES_MIN = 3
LINES_MAX = 400
LINES_OF_HEAD = 40
"""First lines, among which a header may be, and last lines that are judged."""

TIMES = re.compile(r"\s?[*×]\s?")
"""Factor in a name, such as `gz*100`, which the label keeps."""


@dataclass(frozen=True, slots=True)
class TextGuess(ColumnVerdict):
    """Verdict on the lines of a text; `example` is one of them."""

    form: Form = Form.ROW
    example: str = ""

    def meaning(self, index: int) -> str:
        """Name of a column; IGNORED without one."""
        return self.columns[index].looks_like if index < len(self.columns) else IGNORED


def guess(lines: Iterable[str], lines_per_s: float | None = None) -> TextGuess | None:
    """Judge the columns of a text; None without repeated lines with numbers.

    `lines_per_s` is the rate of the lines, or None; it gives the unit of a clock.
    """
    heard = [line for line in (line.strip() for line in lines) if line]
    heard = heard[:LINES_OF_HEAD] + heard[LINES_OF_HEAD:][-LINES_MAX:]
    guessed = _guess([line for line in heard if not line.startswith("#")], lines_per_s)
    if guessed is None or guessed.turn is None:  # all data may have a comment mark
        guessed = _guess([line.lstrip("# ") for line in heard], lines_per_s) or guessed
    return guessed


def _guess(heard: list[str], lines_per_s: float | None) -> TextGuess | None:
    headings = Headings()
    parsed = [(line, fields) for line in heard if (fields := headings.fields_of(line)) is not None]
    parsed = _below_header(parsed)
    layouts = _usual_layouts([fields for _, fields in parsed])
    if not layouts:
        return None
    layout = layouts[0]
    similar = [(line, fields) for line, fields in parsed if _layout(fields) == layout and _has_numbers(fields)]
    labels = _header(parsed, layout, headings) or layout.labels
    units = next((fields.units for _, fields in similar if fields.units), ("",) * len(labels))
    texts = list(zip(*(fields.values for _, fields in similar), strict=True))
    pace = lines_per_s * len(similar) / len(heard) if lines_per_s else None
    verdict = judged(labels, units, texts, pace, layout.labels)
    question = verdict.question
    if len(layouts) > 1:
        firsts = " and ".join(dict.fromkeys(next(filter(None, similar_layout.labels)) for similar_layout in layouts))
        question = f"lines of several kinds have a yaw rate: {firsts} come first in them"
    return TextGuess(verdict.columns, layout.labels, question, layout.form, similar[-1][0])


def _below_header(parsed: list[tuple[str, Fields]]) -> list[tuple[str, Fields]]:
    """Lines in which a word at the beginning of a row is a value, if a row of as many names stands above them."""
    rows = [fields for _, fields in parsed if fields.form is Form.ROW and len(fields.values) > 1]
    if not rows or _has_numbers(rows[0]):
        return parsed
    named = len(rows[0].values)
    return [
        (line, fields._replace(labels=("",) * named) if fields in rows and len(fields.values) == named else fields)
        for line, fields in parsed
    ]


@dataclass(frozen=True, slots=True)
class _Layout:
    """Layout of a line: lines of a kind have the same."""

    form: Form
    labels: tuple[str, ...]
    count: int


def _layout(fields: Fields) -> _Layout:
    return _Layout(fields.form, fields.labels, len(fields.values))


def _has_numbers(fields: Fields) -> bool:
    return any(map(is_number, fields.values))


def _usual_layouts(parsed: Sequence[Fields]) -> list[_Layout]:
    """Most common layout with numbers; if several alternate, those with a labeled rate, or else with a labeled yaw."""
    counts = Counter(_layout(fields) for fields in parsed if _has_numbers(fields))
    common = [layout for layout, times in counts.items() if times >= LINES_MIN]
    highest = max((counts[layout] for layout in common), default=0)
    frequent = [layout for layout in common if counts[layout] >= 0.5 * highest]
    units = {_layout(fields): fields.units for fields in parsed}
    for kind in ("rate", "yaw", "heading"):
        named = [layout for layout in frequent if kind in _kinds(layout, units[layout])]
        if named:
            return named if kind == "rate" else named[:1]
    return sorted(frequent, key=lambda layout: -counts[layout])[:1]


def _kinds(layout: _Layout, units: tuple[str, ...]) -> set[str]:
    """Kinds of the columns from labels and units only."""
    columns = seen_columns(layout.labels, units or ("",) * layout.count, [("0",)] * layout.count)
    name_by_label(columns)
    return {column.kind for column in columns}


def _header(parsed: Sequence[tuple[str, Fields]], layout: _Layout, headings: Headings) -> tuple[str, ...] | None:
    """Names in the last line above the first row of values."""
    names = None
    for _, fields in parsed:
        if fields.form is Form.ROW is layout.form and len(fields.values) == layout.count:
            if _has_numbers(fields):
                return names
            names = tuple(headings.full(as_label(TIMES.sub(" x ", value))) for value in fields.values)
    return None
