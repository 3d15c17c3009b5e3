"""Reads lines of other people's text by the columns that a person names."""

from collections.abc import Sequence
from math import isfinite, nan

from gyrodrift.columns.spec import CLOCK_US, IGNORED, Column
from gyrodrift.link.heard import COLOUR
from gyrodrift.link.protocols.lines import MAX_RATE_DPS, OTHER, LineDecoder
from gyrodrift.link.text.fields import fields_of, is_number, is_whole
from gyrodrift.sample import Reading

CLOCK_MASK = 0xFFFFFFFF
COUNTER_MASK = 0xFFFF
NO_CONTROLS = bytes((0x09, *range(0x20, 0x7F), *range(0x80, 0x100)))
"""All bytes but control characters: a line with one of those is noise, and is not looked into any further."""

LONGEST_CLOCK_US = 1e18
"""Thirty thousand years: more digits than that are a damaged line."""


class TextDecoder(LineDecoder):
    """Lines in any form of `fields`; one without the columns that were named is passed over where it has labels."""

    name = "text"
    longest_bytes = 768

    def __init__(self, columns: Sequence[Column]) -> None:
        super().__init__()
        self.read_by(columns)

    def read_by(self, columns: Sequence[Column]) -> None:
        """Read lines by these columns from here on."""
        self._least = len(columns)
        self._wanted = [(place, column) for place, column in enumerate(columns) if column.meaning != IGNORED]

    def parse(self, text: bytes) -> tuple[int, Reading] | None:
        """One line."""
        if b"\x1b" in text:
            text = COLOUR.sub(b"", text)
        if text.translate(None, NO_CONTROLS):
            return None
        fields = fields_of(text.decode("utf-8", "replace"))
        if fields is None:
            return None
        values: dict[str, tuple[Column, str]] = {}
        for place, column in self._wanted:
            at = _place(fields.labels, column.label) if column.label else place
            if 0 <= at < len(fields.values):
                values[column.meaning] = column, fields.values[at]
        if self._wanted[0][1].label:
            if not any(column.label in fields.labels for _, column in self._wanted):
                return OTHER
        elif len(fields.values) < self._least:
            return None
        return _reading(len(fields.values), values) if len(values) == len(self._wanted) else None


def _place(labels: tuple[str, ...], label: str) -> int:
    return labels.index(label) if label in labels else -1


def _reading(count: int, values: dict[str, tuple[Column, str]]) -> tuple[int, Reading] | None:
    t_us = seq = None
    numbers: dict[str, float] = {}
    for meaning, (column, text) in values.items():
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
    rate_dps = numbers["rate"]
    if isfinite(rate_dps) and abs(rate_dps) > MAX_RATE_DPS:
        return None
    encoder_deg, temp_c = _finite(numbers.get("encoder", nan)), _finite(numbers.get("temp", nan))
    clock_us, still = None if t_us is None else t_us & CLOCK_MASK, _finite(numbers.get("still", nan))
    return count, Reading(clock_us, seq, rate_dps, encoder_deg, temp_c, still)


def _finite(value: float) -> float:
    """An angle or temperature without end is none."""
    return value if isfinite(value) else nan
