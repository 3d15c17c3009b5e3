"""Text as a device prints it, captured in a file: labelled lines, sentences, objects behind the prefix of a log.

Its lines are read as at a port, by `Headings`. Each label is a column. A sample may have several lines: it ends when
one of its labels comes again.
"""

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from gyrodrift.columns.fields import Fields, Form, Headings, is_number
from gyrodrift.columns.units import unit_in
from gyrodrift.session.tables.plan import Head
from gyrodrift.session.tables.text import Lines

LINES_MIN = 3
"""Least number of lines of a kind."""

RARE = 0.02
"""Kinds of lines with a smaller share of the most frequent kind are messages."""

OFTEN = 0.5
"""Labelled lines with a smaller share of the most frequent kind are messages between rows."""

Numbered = Iterable[tuple[int, str]]
"""Lines with their numbers."""


@dataclass(frozen=True, slots=True)
class TextLayout:
    """How the lines of a text become rows.

    labels
        Label per column, as at a port; empty labels in a row after a word.
    form
        Form of most lines.
    has_comments
        Whether lines with a comment mark are data.
    """

    head: Head
    labels: tuple[str, ...]
    form: Form
    has_comments: bool

    has_decimal_comma = False

    def __str__(self) -> str:
        return str(self.form)

    def rows(self, lines: Lines) -> Iterator[tuple[int, list[str]]]:
        """Rows with the number of their last line."""
        return _rows(_parsed((lines.number, line) for line in lines), self.labels)


def text_layout(path: Path, lines: Sequence[tuple[int, str]], *, has_comments: bool = False) -> TextLayout | None:
    """Layout of lines with labels, or else of rows of the most frequent width; None for lines without numbers."""
    parsed = list(_parsed(lines))
    counts = Counter((fields.form, fields.labels) for _, fields in parsed)
    usual = [layout for layout, count in counts.most_common() if count >= LINES_MIN]
    if not usual:
        return None
    labelled = [layout for layout in usual if any(layout[1])]
    if not labelled or counts[labelled[0]] < OFTEN * counts[usual[0]]:
        labelled = usual[:1]
    frequent = [layout for layout in labelled if counts[layout] >= RARE * counts[labelled[0]]]
    form, labels = labelled[0]
    if len(frequent) > 1:
        labels = tuple(dict.fromkeys(label for _, names in frequent for label in _distinct(names) if label))
    units: dict[str, str] = {}
    for _, fields in parsed:
        units = dict(zip(_distinct(fields.labels), fields.units, strict=True)) | units if fields.units else units
    shown = tuple(f"{name} ({units[name]})" if units.get(name) and not unit_in(name) else name for name in labels)
    rows = tuple(row for _, row in _rows(iter(parsed), labels))
    return TextLayout(Head(path, shown if any(labels) else (), len(labels), 0, rows), labels, form, has_comments)


def _parsed(lines: Numbered) -> Iterator[tuple[int, Fields]]:
    """Fields of the lines with numbers."""
    headings = Headings()
    for number, line in lines:
        fields = headings.fields_of(line.strip())
        if fields is not None and any(map(is_number, fields.values)):
            yield number, fields


def _distinct(labels: tuple[str, ...]) -> tuple[str, ...]:
    """Labels of a line; one that comes again gets a number, as `gz #2`."""
    if len(set(labels)) == len(labels):
        return labels
    counts: Counter[str] = Counter()
    distinct = []
    for label in labels:
        counts[label] += 1
        distinct.append(f"{label} #{counts[label]}" if label and counts[label] > 1 else label)
    return tuple(distinct)


def _rows(parsed: Iterator[tuple[int, Fields]], labels: tuple[str, ...]) -> Iterator[tuple[int, list[str]]]:
    """Rows of values by label; a row ends before a line with a label that it has."""
    if not any(labels):
        yield from ((line, list(fields.values)) for line, fields in parsed if fields.labels == labels)
        return
    indices = {label: index for index, label in enumerate(_distinct(labels)) if label}
    places: dict[tuple[str, ...], list[tuple[int, int]]] = {}
    word = labels.index("") if "" in labels else -1
    row: list[str] = []
    number = 0
    for line, fields in parsed:
        if (pairs := places.get(fields.labels)) is None:
            named = enumerate(_distinct(fields.labels))
            pairs = places[fields.labels] = [(indices[label], at) for at, label in named if label in indices]
        if not pairs:
            continue
        if not row or any(row[index] for index, _ in pairs):
            if row:
                yield number, row
            row = [""] * len(labels)
        number = line
        for index, at in pairs:
            row[index] = fields.values[at]
        if word >= 0:
            row[word] = fields.values[0]
    if row:
        yield number, row
