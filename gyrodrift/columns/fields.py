"""A line of text as fields: numbers in a row, `label: value` pairs, a JSON object, or an NMEA sentence.

Sketches print for serial plotters and people, so the same three numbers have many forms. A unit after a value is kept;
other words after it are ignored.
"""

import re
from enum import StrEnum
from functools import lru_cache, reduce
from operator import xor
from typing import NamedTuple

from gyrodrift.columns.blocks import Blocks, flat_markup
from gyrodrift.columns.log_prefix import LABEL as PREFIX_LABEL
from gyrodrift.columns.log_prefix import SENDER_LABEL, Prefixed, PrefixReader, split_prefix
from gyrodrift.columns.names import kind_of
from gyrodrift.columns.objects import LONGEST_CHARACTERS, leaves_of
from gyrodrift.columns.units import Dimension, unit_in, unit_of

HEADED = re.compile(r"([A-Za-z][\w ()]{0,30}):\s++(?=[A-Za-z]\w{0,7}\s*+[:=])")
WORD = (
    r"(?:info|data|raw|imu\d?|(?:mpu|icm|lsm|bm[ix]|bno)\w*|sensors?|state|meas(?:ured)?|acc\w*|mag\w*"
    r"|att(?:itude)?|angles?|orient(?:ation)?|euler|ypr|rpy|\(\w*\))"
)
PLAIN = re.compile(rf"{WORD}(?: {WORD})*", re.IGNORECASE)
"""Words that do not change the meaning of labels."""

GYRO = re.compile(r"(gyr|rot|omega|ang\w* ?(vel|rate))\w*\b(?! ?(bias|off|std|var|rms|noise))", re.IGNORECASE)
AXIS = re.compile(r"[xyz]|roll|pitch|yaw|[rpy]", re.IGNORECASE)
SINGLE = re.compile(r"[A-Za-z]\d?")
"""Label of an axis alone, `X` or `X1`, which needs the words before it."""

QUANTITY_OF = {
    **dict.fromkeys(("rate", "rates", "gx", "gy"), "rate"),
    **dict.fromkeys(("ax", "ay", "az"), "acceleration"),
    **dict.fromkeys(("mx", "my", "mz"), "field"),
    **dict.fromkeys(("yaw", "pitch", "roll", "angle"), "angle"),
}
"""Quantities whose axes share a unit, by kind."""


def head_of(line: str) -> tuple[str, str]:
    """Word before the first label, or empty, and the line without its colon."""
    match = HEADED.match(line)
    return (match[1].strip(), f"{match[1]} {line[match.end() :]}") if match else ("", line)


def with_head(head: str, labels: tuple[str, ...]) -> tuple[str, ...]:
    """Labels with the head, if it may change their meaning: the yaw of a setpoint is not the yaw."""
    if not head or PLAIN.fullmatch(head.replace("/", " ").strip()):
        return labels
    is_gyro = GYRO.match(head) is not None
    return tuple(
        label if label.startswith(f"{head} ") or (is_gyro and not AXIS.fullmatch(label)) else f"{head} {label}"
        for label in labels
    )


NUMBER = r"[-+]?(?:[0-9]++(?:\.[0-9]*+)?+|\.[0-9]++)(?:[eE][-+]?[0-9]++)?+"
"""Number with ASCII digits; Python also accepts the digits of other scripts."""

WHOLE = re.compile(r"[-+]?[0-9]++")
VALUE = re.compile(rf"(?:{NUMBER}|nan|inf|[-+]inf)", re.IGNORECASE)
LABEL = r"(?<![A-Za-z_])([A-Za-z_][\w .()\[\]/°-]{0,40}?)\s*+"
LABELED = re.compile(
    rf"{LABEL}(?:[:=]{{1,2}}\s*+\[?|\[)\s*+({NUMBER}|nan)(?!:\d)(?![^\[\]]{{0,20}}\]\s*+[:=])", re.IGNORECASE
)
VECTOR = re.compile(
    rf"{LABEL}(?:[:=]\s*+[\[(]?|[\[(])\s*+"
    rf"({NUMBER})[\s,;]++({NUMBER})[\s,;]++({NUMBER})(?![\w.])(?!\s*+[,;]?\s*+[-+.0-9])\s*+[\])]?"
)
"""`Gyr (DPS) [ 1, 2, 3 ]`, `Gyro: 1 2 3`, `gyro=(1, 2, 3)`: three numbers after one label are three axes."""

BRACED = re.compile(r"(?<![A-Za-z_])([A-Za-z_][\w ]{0,40}?)\s*+(?:[:=]\s*+[{(\[]|\{)\s*+(?=[A-Za-z_]\w*+\s*+[:=])")
"""`gyro={x=1, y=2}` and `gyro { x: 1 }`: the word before the braces belongs to all labels in them."""

AXES_NAMED = re.compile(
    rf"(?<![A-Za-z_])([A-Za-z_]\w{{0,15}})\((\w),(\w),(\w)\)\s*+[:=]?\s*+"
    rf"({NUMBER})[\s,;]++({NUMBER})[\s,;]++({NUMBER})(?![\w.])"
)
"""`g(x,y,z) 1 2 3`: a word, its axes, and their values."""

NAMES_FIRST = re.compile(
    rf"([A-Za-z]\w{{0,19}}(?:\s*+,\s*+[A-Za-z]\w{{0,19}}){{1,11}})\s*+[:=]\s*+({NUMBER}(?:[\s,;]++{NUMBER}){{1,11}})(?![\w.])"
)
"""`Yaw, Pitch, Roll: 1, 2, 3`: as many names as values."""

HEADED_ROW = re.compile(
    rf"([A-Za-z][\w/]{{0,15}})(?:\s*+[:=,;|]\s*+|\s++)({NUMBER}(?:[\s,;|]++{NUMBER}){{1,31}})\s*+[,;|]?+"
)
"""A row after a word, `gyro 1 2 3` or `a/g: 1 2 3 4 5 6`: lines of several kinds may alternate."""

TELEPLOT = re.compile(
    rf">\s*+([A-Za-z_][\w .-]{{0,40}})(?:,[^:]*+)?:(?:({NUMBER}):)?({NUMBER})(?:§([^|;\s]{{0,16}}))?(?:\|\w*+)?"
)
"""`>name:value` or `>name:ms:value§unit|flags` (nesnes/teleplot)."""

TELEPLOT_CLOCK = "t_ms"

WRAPPED = (("/*", "*/"), ("<", ">"), ("(", ")"), ("[", "]"))
"""Pairs of marks around a line: Serial Studio, Arduino forum, tuples, lists."""

STATE = re.compile(rf"'([^']+)'(?:: Sending state|\s*+>>)\s*+({NUMBER}|nan)", re.IGNORECASE)
"""Sensor value in a log of ESPHome."""

NAME_QUOTED = re.compile(r"([\"'])([A-Za-z_][\w .-]{0,40})\1(?=\s*+[:=])")
NUMBER_QUOTED = re.compile(rf"([:=]\s*+)([\"'])({NUMBER})\2")
"""`"x": 0.5` in an object over several lines, `x="0.5"`."""

EMBEDDED = re.compile(r"([A-Za-z/][\w/.-]{0,60})\s*+[:=]?\s*+(\{\s*+[\"'].*\})")
"""Object after a word: `data: {"gz": 1}`, `imu/left {"gz": 1}` (mosquitto_sub -v)."""

LABELED_COMMA = re.compile(r"([:=]\s*+[-+]?[0-9]++),([0-9]++)(?![0-9]*[.,][0-9])")
POINT = re.compile(r"[0-9]\.[0-9]")

PAIR = re.compile(
    rf"([A-Za-z_][\w.]{{0,30}})\s++({NUMBER})(?![\w.])"
    r"(?:\s*+([A-Za-z°µ%][^\s,;|0-9]{0,15})(?=[\s,;|]++[A-Za-z_]|[\s,;|]*+$))?[\s,;|]*+"
)
"""`gx 0.1 gy 0.2 dps`: a label, a number, and maybe a unit."""

HEX = re.compile(r"(?:0[xX])?[0-9A-Fa-f]{4}(?:[0-9A-Fa-f]{4})?|0[xX][0-9A-Fa-f]{1,8}")
HEX_LINES = 100
"""Lines after a hexadecimal one in which digits alone may be such numbers; of small counts half are negative, FFxx."""

HEX_VALUE = re.compile(r"[:=]\s*+([0-9A-Fa-fxX]++)(?=[\s,;|]|$)")

TAIL = re.compile(r"\s*+[\])}]?\s*+\[?(?=[A-Za-z°ºµμ%/])([^\s,;|=:()\[\]{}]{1,20})\]?")
"""Word after a value, with or without brackets."""

UNIT_HEAD = re.compile(r"^(\S{1,20})\s++(?=\S)")
"""Unit of the previous value at the beginning of a label: `gx: 1 deg/s gy: 2 deg/s`."""

WITH_UNIT = re.compile(rf"({NUMBER})\s*+([A-Za-z°ºµμ%][\w/²^°]*+)")
BETWEEN = re.compile(r"[\s,;|]+")
LABEL_END, BRACKET = re.compile(r"[:=]"), re.compile(r"[({\[]")
MARK = re.compile(r"[:=\[(]")
"""Characters without which a line has no label."""

AXES = "xyz"
NOT_IN_LABEL = re.compile(r"[^\w .()\[\]/°-]")
"""Characters that are removed from labels, because labels are shown to users and pasted into shells."""

SENTENCE = re.compile(r"[$!]([^*]*+)\*([0-9A-Fa-f]{2})")
SEPARATORS = (";", "\t", "|", ",")
"""Separators in the order of their search: with a semicolon or a tab, a comma may be a decimal comma."""

DECIMAL_COMMA = re.compile(r"[-+]?[0-9]++,[0-9]++(?:[eE][-+]?[0-9]++)?+")


class Form(StrEnum):
    """How the values of a line are told apart."""

    ROW = "a row of values"
    LABELED = "label:value pairs"
    JSON = "a JSON object"
    NMEA = "an NMEA sentence"


class Fields(NamedTuple):
    """Fields of a line.

    labels
        Label per value; empty in a row, unless a word precedes the row, as in a sentence.
    values
        Values as text; numbers have a decimal point.
    units
        Unit after every value, or empty; no entries if no value has a unit.
    """

    form: Form
    labels: tuple[str, ...]
    values: tuple[str, ...]
    units: tuple[str, ...] = ()


def fields_of(line: str) -> Fields | None:
    """Fields of a line; None if it is damaged: an incomplete object, or a wrong checksum."""
    return _stamped(split_prefix(line))


def _stamped(line: Prefixed) -> Fields | None:
    """Fields of a line, with the clock of its prefix as the last one."""
    fields = _fields_of(line.rest)
    if fields is not None and line.sender:
        label = SENDER_LABEL if any(fields.labels) or fields.form is not Form.ROW else ""
        units = (*fields.units, "") if fields.units else ()
        fields = Fields(fields.form, (*fields.labels, label), (*fields.values, line.sender), units)
    if fields is None or not line.stamp or PREFIX_LABEL in fields.labels:
        return fields
    label = PREFIX_LABEL if any(fields.labels) else ""
    is_head = fields.form is Form.ROW and not any(map(is_number, fields.values))
    units = (*(fields.units or ("",) * len(fields.values)), line.unit) if line.unit or fields.units else ()
    return Fields(
        fields.form, (*fields.labels, label), (*fields.values, PREFIX_LABEL if is_head else line.stamp), units
    )


def _fields_of(line: str) -> Fields | None:
    if line.startswith("{") or (line[:1] in {"$", "!"} and "*" in line):
        return _object(line) if line.startswith("{") else _sentence(line)
    if point := TELEPLOT.fullmatch(line):
        return _teleplot(point)
    if state := STATE.match(line):
        return Fields(Form.LABELED, (as_label(state[1]),), (state[2],), _units(line, [state]))
    if embedded := EMBEDDED.fullmatch(line):
        fields = _object(embedded[2])
        return fields and fields._replace(labels=with_head(as_label(embedded[1]), fields.labels))
    line = _unwrapped(flat_markup(line))
    if '"' in line or "'" in line:
        line = NUMBER_QUOTED.sub(r"\1\3", NAME_QUOTED.sub(r"\2", line))
    return None if is_hex(line) else _written(line)


def _written(line: str) -> Fields:
    """Fields of a line as sketches print it for people."""
    headed = HEADED_ROW.fullmatch(line) if line[:1].isalpha() else None
    if headed:
        return _headed_row(headed)
    pairs = _pairs(line) if line[:1].isalpha() else None
    return pairs or (_labeled(line) if MARK.search(line) else None) or _row(line)


def is_hex(line: str) -> bool:
    """Whether the values of a line are hexadecimal: all have four or eight such digits, or `0x`, and some a letter."""
    values = HEX_VALUE.findall(line) or BETWEEN.split(line)
    texts = [value for value in values if value]
    are_hex = bool(texts) and len(set(map(len, texts))) == 1 and all(map(HEX.fullmatch, texts))
    return are_hex and any(character.isdigit() for character in line) and not all(map(is_number, texts))


def _pairs(line: str) -> Fields | None:
    """Labels and numbers in turn; None for other lines, and for a single pair whose label is no quantity."""
    pairs, position = [], 0
    while pair := PAIR.match(line, position):
        pairs.append(pair)
        position = pair.end()
    units = tuple(pair[3] or "" for pair in pairs)
    are_units = all(unit_of(unit) for unit in units if unit)
    if position < len(line) or not are_units or not pairs or (len(pairs) == 1 and not kind_of(pairs[0][1])):
        return None
    labels = tuple(as_label(pair[1]) for pair in pairs)
    return Fields(Form.LABELED, labels, tuple(pair[2] for pair in pairs), _shared(labels, units))


def _unwrapped(line: str) -> str:
    for begin, end in WRAPPED:
        if line.startswith(begin) and line.endswith(end):
            return line[len(begin) : -len(end)].strip()
    return line


def _labeled(line: str) -> Fields | None:
    """Values after labels; None without labels, or for a single word before a row."""
    if "," in LABEL_END.split(line, 1)[0]:
        line = NAMES_FIRST.sub(_names_first, line)
    head, line = head_of(_with_points(line))
    if BRACKET.search(line):
        line = AXES_NAMED.sub(_named_axes, BRACED.sub(r"\1 ", line))
    line = VECTOR.sub(_axes, line)
    matches = list(LABELED.finditer(line))
    if not matches or (len(matches) == 1 and sum(map(is_number, _row(line).values)) > 1):
        return None
    labels = with_head(head, _headed(tuple(as_label(match[1]) for match in matches)))
    units = _shared(labels, _units(line, matches))
    return Fields(Form.LABELED, labels, tuple(match[2] for match in matches), units)


def _with_points(line: str) -> str:
    """Line with decimal points, if all numbers after its labels have a decimal comma: `gx: 0,5; gz: 1,0`."""
    commas = LABELED_COMMA.findall(line)
    if not commas or POINT.search(line):
        return line
    is_list = len(commas) == 1 and ";" not in line and len(LABEL_END.findall(line)) == 1
    return line if is_list else LABELED_COMMA.sub(r"\1.\2", line)


@lru_cache(maxsize=64)
def _shared(labels: tuple[str, ...], units: tuple[str, ...]) -> tuple[str, ...]:
    """Units, where one that stands once holds for all axes of its quantity: `gx: 1 gy: 2 gz: 3 dps`."""
    if not any(units) or all(units):
        return units if any(units) else ()
    quantities = ["" if unit_in(label) else QUANTITY_OF.get(kind_of(label)) or _head_of_axis(label) for label in labels]
    stated = {
        quantity: {
            unit for unit, of_unit in zip(units, quantities, strict=True) if of_unit == quantity and _is_of_axis(unit)
        }
        for quantity in set(quantities) - {""}
    }
    only = {quantity: next(iter(texts)) for quantity, texts in stated.items() if len(texts) == 1}
    return tuple(unit or only.get(quantity, "") for unit, quantity in zip(units, quantities, strict=True))


def _is_of_axis(text: str) -> bool:
    unit = unit_of(text)
    return unit is not None and unit.dimension is not Dimension.FREQUENCY  # `rate = 50 Hz`


def _head_of_axis(label: str) -> str:
    head, _, axis = label.rpartition(" ")
    return head if AXIS.fullmatch(axis) else ""


def _units(line: str, matches: list[re.Match[str]]) -> tuple[str, ...]:
    """Unit after every value, which ends its match."""
    units = [_unit_behind(line, match.end()) for match in matches]
    return tuple(units) if any(units) else ()


def _unit_behind(line: str, position: int) -> str:
    tail = TAIL.match(line, position)
    return tail[1] if tail and unit_of(tail[1]) else ""


def _teleplot(point: re.Match[str]) -> Fields:
    name, ms, value, unit = point.groups()
    labels, values = ((TELEPLOT_CLOCK, name), (ms, value)) if ms else ((name,), (value,))
    units = ("",) * (len(values) - 1) + (unit,) if unit and unit_of(unit) else ()
    return Fields(Form.LABELED, tuple(map(as_label, labels)), values, units)


def _headed_row(headed: re.Match[str]) -> Fields:
    """Fields of a row after a word; the word is the first column, and part of the labels."""
    word, numbers = as_label(headed[1]), BETWEEN.split(headed[2])
    axes = AXES if len(numbers) == len(AXES) else range(1, len(numbers) + 1)
    return Fields(Form.ROW, ("", *(f"{word} {axis}" for axis in axes)), (headed[1], *numbers))


def checksum(body: str) -> int:
    """Checksum of an NMEA sentence: exclusive or of all characters between `$` and `*` (NMEA 0183)."""
    return reduce(xor, body.encode(errors="replace"), 0)


def as_label(text: str) -> str:
    """Label without forbidden characters."""
    return NOT_IN_LABEL.sub("", text).strip()


def is_number(text: str) -> bool:
    """Whether a text is a number, including nan and inf."""
    return VALUE.fullmatch(text) is not None


def is_value(text: str, value: str) -> bool:
    """Whether a text is the value of a row to use; numbers compare as numbers, and case does not matter."""
    if is_number(text) and is_number(value):
        return float(text) == float(value)
    return text.casefold() == value.casefold()


def is_whole(text: str) -> bool:
    """Whether a text is a whole number."""
    return WHOLE.fullmatch(text) is not None


def _object(line: str) -> Fields | None:
    leaves = leaves_of(line)
    if leaves is None:
        return None
    labels = tuple(".".join(map(as_label, path)) for path, _ in leaves)
    return Fields(Form.JSON, labels, tuple(value for _, value in leaves))


def _sentence(line: str) -> Fields | None:
    match = SENTENCE.fullmatch(line)
    if match is None or checksum(match[1]) != int(match[2], 16):
        return None
    values = tuple(match[1].split(","))
    word = as_label(values[0])
    return Fields(Form.NMEA, ("", *(f"{word} {index}" for index in range(1, len(values)))), values)


def _headed(labels: tuple[str, ...]) -> tuple[str, ...]:
    """Complete the labels of axes: in `Gyro X: 1 Y: 2 Z: 3` the word Gyro belongs to all three."""
    head = ""
    full = []
    for label in map(_without_unit, labels):
        words, _, last = label.rpartition(" ")
        if SINGLE.fullmatch(last) and words:
            head = words
        full.append(f"{head} {label}" if SINGLE.fullmatch(label) and head else label)
    return tuple(full)


def _without_unit(label: str) -> str:
    head = UNIT_HEAD.match(label)
    is_unit = head is not None and unit_of(head[1].strip("[]()")) is not None
    if head is None or not is_unit or (len(label) - head.end() < 2 and head[1].isalnum()):  # `g x` is an axis
        return " ".join(label.split())
    return " ".join(label[head.end() :].split())


def _axes(match: re.Match[str]) -> str:
    label, *numbers = match.groups()
    return ", ".join(f"{label} {axis}={number}" for axis, number in zip(AXES, numbers, strict=True)) + " "


def _named_axes(match: re.Match[str]) -> str:
    word, *rest = match.groups()
    return ", ".join(f"{word} {axis}={number}" for axis, number in zip(rest[:3], rest[3:], strict=True)) + " "


def _names_first(match: re.Match[str]) -> str:
    names, values = [name.strip() for name in match[1].split(",")], BETWEEN.split(match[2])
    if len(names) != len(values):
        return match[0]
    return ", ".join(f"{name}={value}" for name, value in zip(names, values, strict=True)) + " "


def _row(line: str) -> Fields:
    mark = next((separator for separator in SEPARATORS if separator in line), None)
    parts = line.split() if mark is None else [part.strip() for part in line.split(mark)]
    if len(parts) > 1 and not parts[-1]:
        parts.pop()  # some sketches print a separator after every value
    units = [""] * len(parts)
    if mark is not None:
        for index, part in enumerate(parts):
            if match := WITH_UNIT.fullmatch(part):
                parts[index], units[index] = match[1], match[2] if unit_of(match[2]) else ""
    if mark != ",":
        parts = [part.replace(",", ".") if DECIMAL_COMMA.fullmatch(part) else part for part in parts]
    return Fields(Form.ROW, ("",) * len(parts), tuple(parts), tuple(units) if any(units) else ())


HEADING = re.compile(r"[^A-Za-z0-9]*+([A-Za-z][\w ()\[\]/²°.^-]{0,60}?)\s*+(:?)[^A-Za-z0-9)\]]*+")
UNIT_NAMED = re.compile(r"\s{1,4}in\s{1,4}(\S{1,20})$")
"""`Gyroscope in degrees/second` names its unit."""


LABELED_NUMBER = re.compile(r"([:=]\s*+)([-+]?[0-9]++(?:\.[0-9]++)?+)(?![\w.:)\]}]|\s*+,\s*+[-+.0-9]|\s++[-+.0-9])")
"""Number after a label, and not one of a list."""

TEMPLATES_MAX = 64


class Headings:
    """Fields of consecutive lines, as ports and files hold them.

    A label of a single letter gets the heading above it, a label in blocks their names. After the first line of
    hexadecimal numbers, a line whose digits may be such a number is none.
    """

    def __init__(self) -> None:
        self.heading = ""
        self._blocks = Blocks()
        self._prefix = PrefixReader()
        self._hex_lines = 0
        self._templates: dict[tuple[str | bool, ...], Fields] = {}

    def fields_of(self, line: str) -> Fields | None:
        """Fields of the next line, with complete labels; None for a line longer than a device sends."""
        if len(line) > LONGEST_CHARACTERS:
            return None
        prefixed = self._prefix.split(line)
        if self._blocks.take(prefixed.rest):
            return Fields(Form.ROW, ("",), (prefixed.rest,))
        if item := self._blocks.item(prefixed.rest):
            return Fields(Form.LABELED, (self._blocks.label(item[0]),), (item[1],))
        fields = self._by_template(prefixed)
        self._hex_lines = HEX_LINES if fields is None and is_hex(prefixed.rest) else max(0, self._hex_lines - 1)
        if fields is None or self._may_be_hex(prefixed.rest):
            return None
        if fields.form is Form.LABELED:
            labels = tuple(map(self.full, fields.labels)) if self.heading or self._blocks else fields.labels
            return fields._replace(labels=labels)
        if match := HEADING.fullmatch(prefixed.rest):
            name = as_label(UNIT_NAMED.sub(r" (\1)", match[1]))
            if match[2] or kind_of(f"{name} z"):
                self.heading = name
        return fields

    def _by_template(self, line: Prefixed) -> Fields | None:
        """Fields of a line; one that differs from an earlier one only in numbers after labels has its labels."""
        parts = LABELED_NUMBER.split(line.rest)
        values = tuple(parts[2::3])
        if not values:
            return _stamped(line)
        key = (line.unit, bool(line.stamp), bool(line.sender), *parts[::3], *parts[1::3])
        template = self._templates.get(key)
        if template is not None:
            return template._replace(values=(*values, line.stamp) if len(template.values) > len(values) else values)
        fields = _stamped(line)
        is_usual = fields is not None and fields.values in (values, (*values, line.stamp))
        if fields is not None and is_usual and fields.form is Form.LABELED:
            if len(self._templates) >= TEMPLATES_MAX:
                self._templates.clear()
            self._templates[key] = fields
        return fields

    def _may_be_hex(self, line: str) -> bool:
        values = HEX_VALUE.findall(line) if self._hex_lines else ()
        return bool(values) and all(map(HEX.fullmatch, values))

    def full(self, label: str) -> str:
        """Label with its heading, if it is a single axis, or with its blocks."""
        if (in_blocks := self._blocks.label(label)) != label:
            return in_blocks
        return f"{self.heading} {label}" if SINGLE.fullmatch(label) and self.heading else label
