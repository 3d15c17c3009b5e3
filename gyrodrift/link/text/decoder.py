"""Reads lines of other people's text by the columns that a person names."""

from collections.abc import Sequence
from math import isfinite, nan

from gyrodrift.columns.spec import CLOCK_US, IGNORED, Column
from gyrodrift.link.heard import decoded, plain_text
from gyrodrift.link.protocols.lines import MAX_RATE_DPS, OTHER, LineDecoder
from gyrodrift.link.text.fields import Fields, is_number, is_whole
from gyrodrift.link.text.headings import Headings
from gyrodrift.sample import Reading

CLOCK_MASK = 0xFFFFFFFF
COUNTER_MASK = 0xFFFF
NO_CONTROLS = bytes((0x09, *range(0x20, 0x7F), *range(0x80, 0x100)))
"""All bytes but control characters: a line with one of those is noise, and is not looked into any further."""

LONGEST_CLOCK_US = 1e18
"""Thirty thousand years: more digits than that are a damaged line."""

SEVERAL_LINES = -1
"""In place of the number of values, for a sample that is put together from several lines."""

Named = dict[str, tuple[Column, str]]
"""Column and text of each meaning."""


class TextDecoder(LineDecoder):
    """Lines in any form of `fields`; one without the columns that were named is passed over where it has labels.

    Labelled values may stand in several lines: a sample is whole with the last of its columns.
    """

    name = "text"
    longest_bytes = 4096

    def __init__(self, columns: Sequence[Column]) -> None:
        super().__init__()
        self._headings = Headings()
        self.read_by(columns)

    def read_by(self, columns: Sequence[Column]) -> None:
        """Read lines by these columns from here on."""
        self._least = len(columns)
        self._wanted = [(place, column) for place, column in enumerate(columns) if column.meaning != IGNORED]
        self._has_labels = bool(self._wanted[0][1].label)
        self._collected: Named = {}

    def is_comment(self, text: bytes) -> bool:
        """A line behind `#` may be data: it is one where nothing that was named stands in it."""
        if not text.startswith(b"#"):
            return False
        return not any(column.label and column.label.split()[0].encode() in text for _, column in self._wanted)

    def parse(self, text: bytes) -> tuple[int, Reading] | None:
        """One line."""
        text = plain_text(text).lstrip(b"# ")
        if text.translate(None, NO_CONTROLS):
            return None
        fields = self._headings.fields_of(decoded(text))
        if fields is None:
            return None
        named = self._named(fields)
        if self._has_labels:
            return self._from_lines(len(fields.values), named)
        if len(fields.values) < self._least:
            return None
        return _reading(len(fields.values), named)

    def _named(self, fields: Fields) -> Named:
        named: Named = {}
        for place, column in self._wanted:
            at = _place(fields.labels, column.label) if column.label else place
            if 0 <= at < len(fields.values):
                named[column.meaning] = column, fields.values[at]
        return named

    def _from_lines(self, count: int, named: Named) -> tuple[int, Reading] | None:
        if not named:
            return OTHER
        if len(named) == len(self._wanted):
            self._collected = {}
            return _reading(count, named)
        self._collected |= named
        if len(self._collected) < len(self._wanted):
            return OTHER
        collected, self._collected = self._collected, {}
        return _reading(SEVERAL_LINES, collected)


def _place(labels: tuple[str, ...], label: str) -> int:
    return labels.index(label) if label in labels else -1


def _reading(count: int, named: Named) -> tuple[int, Reading] | None:
    t_us = seq = None
    numbers: dict[str, float] = {}
    for meaning, (column, text) in named.items():
        if not is_number(text):
            return None
        number = float(text) * column.scale
        if meaning in CLOCK_US:
            if not abs(number) < LONGEST_CLOCK_US:
                return None
            t_us = int(text) * round(column.scale) if column.scale >= 1.0 and is_whole(text) else round(number)
        elif meaning == "seq":
            if not is_whole(text):
                return None
            seq = int(text) & COUNTER_MASK
        else:
            numbers[meaning] = number
    rate_dps, yaw_deg = numbers.get("rate", nan), numbers.get("yaw", nan)
    if (isfinite(rate_dps) and abs(rate_dps) > MAX_RATE_DPS) or ("yaw" in numbers and not isfinite(yaw_deg)):
        return None
    encoder_deg, temp_c = _finite(numbers.get("encoder", nan)), _finite(numbers.get("temp", nan))
    clock_us, still = None if t_us is None else t_us & CLOCK_MASK, _finite(numbers.get("still", nan))
    return count, Reading(clock_us, seq, rate_dps, encoder_deg, temp_c, still, yaw_deg)


def _finite(value: float) -> float:
    """An angle or temperature without end is none."""
    return value if isfinite(value) else nan
