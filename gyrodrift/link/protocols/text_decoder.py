"""Decoder of foreign text with the columns that the user names."""

from collections.abc import Sequence
from math import isfinite, nan

from gyrodrift.columns.fields import Fields, Headings, is_number, is_whole
from gyrodrift.columns.spec import CLOCK_US, IGNORED, Column
from gyrodrift.io.plain_text import decoded, plain_text
from gyrodrift.link.protocols.lines import WITHOUT_RATE, LineDecoder
from gyrodrift.link.protocols.plausible import MAX_RATE_DPS
from gyrodrift.values.constants import CLOCK_MASK, COUNTER_MASK
from gyrodrift.values.sample import Inertial, Reading

NO_CONTROLS = bytes((0x09, *range(0x20, 0x7F), *range(0x80, 0x100)))
"""All bytes but control characters: a line with a control character is noise."""

LONGEST_CLOCK_US = 1e18
"""Largest time, 30,000 years; above, the line is damaged."""

RATES = ("gx", "gy", "rate")
AXES = (*RATES, "ax", "ay", "az")
"""Meanings of the axes, in the order of `Inertial`."""

SEVERAL_LINES = -1
"""Number of columns of a sample from several lines."""

Named = dict[str, tuple[Column, str]]
"""Column and text by meaning."""


class TextDecoder(LineDecoder):
    """Decoder of lines in any form of `fields`; labeled lines without a named column are ignored.

    Labeled values may come in several lines: a sample is complete with the last of its columns.
    """

    name = "text"
    longest_bytes = 4096

    def __init__(self, columns: Sequence[Column]) -> None:
        super().__init__()
        self._headings = Headings()
        self.read_by(columns)

    def read_by(self, columns: Sequence[Column]) -> None:
        """Use these columns from now on."""
        self._columns_min = len(columns)
        self._used_columns = [(index, column) for index, column in enumerate(columns) if column.meaning != IGNORED]
        self._has_labels = bool(self._used_columns[0][1].label)
        self._collected: Named = {}

    def is_comment(self, text: bytes) -> bool:
        """Whether a line with `#` is a comment: it has no named label."""
        if not text.startswith(b"#"):
            return False
        return not any(column.label and column.label.split()[0].encode() in text for _, column in self._used_columns)

    def parse(self, text: bytes) -> tuple[int, Reading] | None:
        """Number of columns and reading of a line."""
        text = plain_text(text).lstrip(b"# ")
        if text.translate(None, NO_CONTROLS):
            return None
        fields = self._headings.fields_of(decoded(text))
        if fields is None:
            return None
        named = self._named(fields)
        if self._has_labels:
            return self._from_lines(len(fields.values), named)
        if len(fields.values) < self._columns_min:
            return None
        return _reading(len(fields.values), named)

    def _named(self, fields: Fields) -> Named:
        named: Named = {}
        for index, column in self._used_columns:
            position = _label_index(fields.labels, column.label) if column.label else index
            if 0 <= position < len(fields.values):
                named[column.meaning] = column, fields.values[position]
        return named

    def _from_lines(self, count: int, named: Named) -> tuple[int, Reading] | None:
        if not named:
            return WITHOUT_RATE
        if len(named) == len(self._used_columns):
            self._collected = {}
            return _reading(count, named)
        self._collected |= named
        if len(self._collected) < len(self._used_columns):
            return WITHOUT_RATE
        collected, self._collected = self._collected, {}
        return _reading(SEVERAL_LINES, collected)


def _label_index(labels: tuple[str, ...], label: str) -> int:
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
    rates_dps = [numbers[name] for name in RATES if name in numbers]
    is_too_fast = any(isfinite(dps) and abs(dps) > MAX_RATE_DPS for dps in rates_dps)
    if is_too_fast or ("yaw" in numbers and not isfinite(yaw_deg)):
        return None
    encoder_deg, temp_c = _finite(numbers.get("encoder", nan)), _finite(numbers.get("temp", nan))
    clock_us, still = None if t_us is None else t_us & CLOCK_MASK, _finite(numbers.get("still", nan))
    return count, Reading(clock_us, seq, rate_dps, encoder_deg, temp_c, still, yaw_deg, _inertial(numbers))


def _inertial(numbers: dict[str, float]) -> Inertial | None:
    """All axes of a line; None without three finite rates."""
    if not all(isfinite(numbers.get(name, nan)) for name in RATES):
        return None
    return Inertial(*(_finite(numbers.get(name, nan)) for name in AXES))


def _finite(value: float) -> float:
    """NaN for an infinite angle or temperature."""
    return value if isfinite(value) else nan
