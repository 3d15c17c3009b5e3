"""Decoder of foreign text with the columns that the user names."""

from collections.abc import Sequence
from math import hypot, isfinite, nan

from gyrodrift.columns.aids import AidColumns
from gyrodrift.columns.fields import Fields, Form, Headings, as_label, is_number, is_value, is_whole
from gyrodrift.columns.sizes import has_16_bits
from gyrodrift.columns.spec import AID_MEANINGS, IGNORED, QUATERNION, SELECTED, Column
from gyrodrift.columns.times import ClockReader, is_stamp
from gyrodrift.io.plain_text import decoded, plain_text
from gyrodrift.link.protocols.lines import WITHOUT_RATE, LineDecoder
from gyrodrift.link.protocols.plausible import MAX_RATE_DPS
from gyrodrift.values.aid import Aid
from gyrodrift.values.constants import CLOCK_MASK, COUNTER_MASK, INT16_COUNTS
from gyrodrift.values.quaternion import yaw_of
from gyrodrift.values.sample import Inertial, Reading

NO_CONTROLS = bytes((0x09, *range(0x20, 0x7F), *range(0x80, 0x100)))
"""All bytes but control characters: a line with a control character is noise."""

LONGEST_CLOCK_US = 10**18
"""Largest time, 30,000 years; above, the line is damaged."""

RATES = ("gx", "gy", "rate")
AXES = (*RATES, "ax", "ay", "az")
"""Meanings of the axes, in the order of `Inertial`."""

UNIT_NORMS = (0.9, 1.1)
"""Norms of a unit quaternion after rounding; a line with another one is damaged."""

OPTIONAL = AID_MEANINGS | {"still"}
"""Meanings whose cells may be empty: a second source is slower than the gyro, or does not know."""

MISSING = frozenset(("", "null", "none", "nan", "na", "-"))
"""Texts of an empty cell."""

ROW_ENDS = (b",", b";", b"|")
"""Marks behind which the last cell of a row may be empty."""

AIDS_MAX = 32
"""Most measurements that wait for a line with a rate."""

SEQ = "seq"
SEVERAL_LINES = -1
"""Number of columns of a sample from several lines."""

Named = dict[int, str]
"""Text by the index of its column in the SPEC."""


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
        used = [(index, column) for index, column in enumerate(columns) if column.meaning != IGNORED]
        self._spec = dict(used)
        self._has_labels = bool(used[0][1].label)
        self._labels = [(as_label(column.label), index) for index, column in used]
        self._selects = [index for index, column in used if column.meaning == SELECTED]
        self._clocks = [index for index, column in used if column.clock]
        self._values = [
            (index, column.meaning, column.scale, column.meaning in RATES and has_16_bits(column.scale))
            for index, column in used
            if index not in self._clocks and index not in self._selects
        ]
        self._aids = AidColumns(columns)
        self._optional = {index for index, column in used if column.meaning in OPTIONAL}
        sources = [index for index, column in used if column.meaning in AID_MEANINGS]
        self._required, self._blank = self._spec.keys() - set(sources), dict.fromkeys(sources, "")
        self._waiting: tuple[Aid, ...] = ()
        self._clock = ClockReader([self._spec[index].clock for index in self._clocks])
        self._collected: Named = {}

    def is_comment(self, text: bytes) -> bool:
        """Whether a line with `#` is a comment: it has no named label."""
        if not text.startswith(b"#"):
            return False
        return not any(label and label.split()[0].encode() in text for label, _ in self._labels)

    def parse(self, text: bytes) -> tuple[int, Reading] | None:
        """Number of columns and reading of a line."""
        text = plain_text(text).lstrip(b"# ")
        if text.translate(None, NO_CONTROLS):
            return None
        fields = self._headings.fields_of(decoded(text))
        if fields is None:
            return None
        if self._has_labels:
            count = sum(map(is_number, fields.values)) if fields.form is Form.JSON else len(fields.values)
            named = {i: value for label, i in self._labels if (value := _value(fields, label)) is not None}
            if self._blank:  # their number does not tell a damaged line
                count -= sum(is_number(named[i]) or fields.form is not Form.JSON for i in self._blank if i in named)
            return self._from_lines(count, named)
        values = self._padded(text, fields.values) if self._optional else fields.values
        if len(values) < self._columns_min:
            return None
        return self._reading(len(values), {index: values[index] for index in self._spec})

    def _padded(self, text: bytes, values: Sequence[str]) -> Sequence[str]:
        """Values with the empty cells at the end of a row, of which the last has no mark behind it."""
        absent = range(len(values), self._columns_min)
        is_ended = text.endswith(ROW_ENDS) or b"\t" in text
        return [*values, *("" for _ in absent)] if is_ended and self._optional.issuperset(absent) else values

    def _from_lines(self, count: int, named: Named) -> tuple[int, Reading] | None:
        """Sample of one line or several; it begins with the line of the value to select by."""
        if not named:
            return WITHOUT_RATE
        aids = {index: text for index, text in named.items() if index in self._blank}
        if aids and named.keys() - aids.keys() <= set(self._clocks):
            self._aids_alone(aids)
            named = {index: text for index, text in named.items() if index not in aids}
            if not named:
                return WITHOUT_RATE
        if named.keys() >= self._required:
            self._collected = {}
            return self._reading(count, self._blank | named)
        if self._selects and self._selects[0] in named:
            self._collected = {}
        elif self._selects and not self._collected:
            return WITHOUT_RATE
        self._collected |= named
        if not self._collected.keys() >= self._required:
            return WITHOUT_RATE
        collected, self._collected = self._blank | self._collected, {}
        return self._reading(SEVERAL_LINES, collected)

    def _reading(self, count: int, texts: Named) -> tuple[int, Reading] | None:
        if self._selects and not all(is_value(texts[index], self._spec[index].unit) for index in self._selects):
            return WITHOUT_RATE
        if self._aids and all(_is_missing(texts[index]) for index, *_ in self._values if index not in self._optional):
            return self._aids_alone({index: texts[index] for index in self._blank})
        numbers: dict[str, float] = {}
        for index, meaning, scale, is_short in self._values:
            text = texts[index]
            if index in self._optional and _is_missing(text):
                continue
            if not (is_whole(text) if meaning == SEQ else is_number(text)):
                return None
            number = int(text) & COUNTER_MASK if meaning == SEQ else float(text)
            numbers[meaning] = (number - 2 * INT16_COUNTS if is_short and number >= INT16_COUNTS else number) * scale
        motion = _motion(numbers)
        if motion is None:
            return None
        t_us = self._stamp_us(texts)
        if self._clocks and t_us is None:
            return None
        rate_dps, yaw_deg, delta_deg = motion
        aids = self._taken(numbers) if self._aids else ()
        return count, Reading(
            t_us,
            int(numbers[SEQ]) if SEQ in numbers else None,
            rate_dps,
            _finite(numbers.get("encoder", nan)),
            _finite(numbers.get("temp", nan)),
            _finite(numbers.get("still", nan)),
            yaw_deg,
            _inertial(numbers),
            delta_deg=delta_deg,
            aids=aids,
        )

    def _aids_alone(self, named: Named) -> tuple[int, Reading]:
        """Keep the measurements of a line without a rate for the next one that has one."""
        numbers = {
            self._spec[index].meaning: float(text) * self._spec[index].scale
            for index, text in named.items()
            if is_number(text)
        }
        self._waiting = (self._waiting + self._aids.aids_of(numbers))[-AIDS_MAX:]
        return WITHOUT_RATE

    def _taken(self, numbers: dict[str, float]) -> tuple[Aid, ...]:
        """Measurements of second sources for a reading."""
        waiting, self._waiting = self._waiting, ()
        return waiting + self._aids.aids_of(numbers)

    def _stamp_us(self, texts: Named) -> int | None:
        """Clock of 32 bits; None without one, or if it is no time."""
        cells = [texts[index] for index in self._clocks]
        if not cells or not all(is_number(cell) or is_stamp(cell) for cell in cells):
            return None
        try:
            t_us = self._clock.stamp_us(cells)
        except (ValueError, OverflowError):
            return None
        return t_us & CLOCK_MASK if abs(t_us) < LONGEST_CLOCK_US else None


def _is_missing(text: str) -> bool:
    return text.strip().lower() in MISSING


def _value(fields: Fields, label: str) -> str | None:
    return fields.values[fields.labels.index(label)] if label in fields.labels else None


def _motion(numbers: dict[str, float]) -> tuple[float, float, float] | None:
    """Rate, yaw, and angle since the last sample; None if they are no numbers of a gyro."""
    if any(isfinite(dps) and abs(dps) > MAX_RATE_DPS for name in RATES for dps in [numbers.get(name, nan)]):
        return None
    yaw_deg, delta_deg = numbers.get("yaw", nan), numbers.get("delta", nan)
    parts = [numbers[name] for name in QUATERNION if name in numbers]
    if parts:
        if not UNIT_NORMS[0] <= hypot(*parts) <= UNIT_NORMS[1]:
            return None
        yaw_deg = yaw_of(*parts)
    is_damaged = ("yaw" in numbers and not isfinite(yaw_deg)) or ("delta" in numbers and not isfinite(delta_deg))
    return None if is_damaged else (numbers.get("rate", nan), yaw_deg, delta_deg)


def _inertial(numbers: dict[str, float]) -> Inertial | None:
    """All axes of a line; None without three finite rates."""
    if not all(isfinite(numbers.get(name, nan)) for name in RATES):
        return None
    return Inertial(*(_finite(numbers.get(name, nan)) for name in AXES))


def _finite(value: float) -> float:
    """NaN for an infinite angle or temperature."""
    return value if isfinite(value) else nan
