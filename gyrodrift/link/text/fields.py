"""A line of text as fields: numbers in a row, `label: value` pairs, a JSON object, or an NMEA sentence.

Sketches print what a serial plotter or a person likes to read, so the same three numbers come in many forms. A unit
behind a value is kept beside it; any other word there is passed over.
"""

import re
from enum import StrEnum
from functools import reduce
from operator import xor
from typing import NamedTuple

from gyrodrift.columns.units import unit_of
from gyrodrift.link.text.heads import head_of, with_head
from gyrodrift.link.text.objects import leaves_of

NUMBER = r"[-+]?(?:[0-9]++(?:\.[0-9]*+)?+|\.[0-9]++)(?:[eE][-+]?[0-9]++)?+"
"""In the digits that a device prints; Python takes those of other scripts for numbers too."""

WHOLE = re.compile(r"[-+]?[0-9]++")
VALUE = re.compile(rf"(?:{NUMBER}|nan|inf|[-+]inf)", re.IGNORECASE)
LABEL = r"(?<![A-Za-z_])([A-Za-z_][\w .()\[\]/°-]{0,40}?)\s*+"
LABELLED = re.compile(
    rf"{LABEL}(?:[:=]{{1,2}}\s*+\[?|\[)\s*+({NUMBER}|nan)(?![^\[\]]{{0,20}}\]\s*+[:=])", re.IGNORECASE
)
VECTOR = re.compile(
    rf"{LABEL}(?:[:=]\s*+[\[(]?|[\[(])\s*+"
    rf"({NUMBER})[\s,;]++({NUMBER})[\s,;]++({NUMBER})(?![\w.])(?!\s*+[,;]?\s*+[-+.0-9])\s*+[\])]?"
)
"""`Gyr (DPS) [ 1, 2, 3 ]`, `Gyro: 1 2 3`, `gyro=(1, 2, 3)`: three numbers of one label are those of three axes."""

BRACED = re.compile(r"(?<![A-Za-z_])([A-Za-z_][\w ]{0,40}?)\s*+[:=]\s*+[{(\[]\s*+(?=[A-Za-z_]\w*+\s*+[:=])")
"""`gyro={x=1, y=2}`: what is in the braces belongs to the word before them."""

AXES_NAMED = re.compile(
    rf"(?<![A-Za-z_])([A-Za-z_]\w{{0,15}})\((\w),(\w),(\w)\)\s*+[:=]?\s*+"
    rf"({NUMBER})[\s,;]++({NUMBER})[\s,;]++({NUMBER})(?![\w.])"
)
"""`g(x,y,z) 1 2 3`: the axes stand behind the word, and the values behind them."""

NAMES_FIRST = re.compile(
    rf"([A-Za-z]\w{{0,19}}(?:\s*+,\s*+[A-Za-z]\w{{0,19}}){{1,11}})\s*+[:=]\s*+({NUMBER}(?:[\s,;]++{NUMBER}){{1,11}})(?![\w.])"
)
"""`Yaw, Pitch, Roll: 1, 2, 3`: as many names as values."""

HEADED_ROW = re.compile(
    rf"([A-Za-z][\w/]{{0,15}})(?:\s*+[:=,]\s*+|\s++)({NUMBER}(?:[\s,;|]++{NUMBER}){{1,31}})\s*+[,;|]?+"
)
"""A row behind a word, `gyro 1 2 3` or `a/g: 1 2 3 4 5 6`: lines of several kinds may come in turns."""

TELEPLOT = re.compile(
    rf">\s*+([A-Za-z_][\w .-]{{0,40}})(?:,[^:]*+)?:(?:({NUMBER}):)?({NUMBER})(?:§([^|;\s]{{0,16}}))?(?:\|\w*+)?"
)
"""`>name:value` or `>name:ms:value§unit|flags` (nesnes/teleplot)."""

TELEPLOT_CLOCK = "t_ms"

WRAPPED = (("/*", "*/"), ("<", ">"), ("(", ")"), ("[", "]"))
"""Marks of beginning and end: of Serial Studio, of the Arduino forum, of tuples and of lists."""

STATE = re.compile(rf"'([^']+)'(?:: Sending state|\s*+>>)\s*+({NUMBER}|nan)", re.IGNORECASE)
"""A sensor of ESPHome in its log."""

LOG_HEAD = re.compile(r"(?:\[[^\[\]\s]++\])++:?\s++(?=['A-Za-z])")
"""`[12:34:56][D][sensor:094]: ` before a message."""

TAIL = re.compile(r"\s*+[\])}]?\s*+\[?(?=[A-Za-z°ºµμ%/])([^\s,;|=:()\[\]{}]{1,20})\]?")
"""The word behind a value, in brackets or not."""

UNIT_HEAD = re.compile(r"^(\S{1,20})\s++(?=\S)")
"""The unit of the value before stands in front of a label where nothing parts them: `gx: 1 deg/s gy: 2 deg/s`."""

WITH_UNIT = re.compile(rf"({NUMBER})\s*+([A-Za-z°ºµμ%][\w/²^°]*+)")
BETWEEN = re.compile(r"[\s,;|]+")
LABEL_END, BRACKET = re.compile(r"[:=]"), re.compile(r"[({\[]")
MARK = re.compile(r"[:=\[(]")
"""Without one of those there is no label."""

AXES = "xyz"
UNSAID = re.compile(r"[^\w .()\[\]/°-]")
"""What no label holds: labels are told to people and pasted into shells, whatever a device calls its values."""

SENTENCE = re.compile(r"[$!]([^*]*+)\*([0-9A-Fa-f]{2})")
SEPARATORS = (";", "\t", "|", ",")
"""Asked in this order: with a semicolon or a tab, a comma may be the decimal point of a language."""

DECIMAL_COMMA = re.compile(r"[-+]?[0-9]++,[0-9]++")


class Form(StrEnum):
    """How the values of a line are told apart."""

    ROW = "a row of values"
    LABELLED = "label:value pairs"
    JSON = "a JSON object"
    NMEA = "an NMEA sentence"


class Fields(NamedTuple):
    """What stands in a line.

    labels
        One for each value; values in a row have an empty one, unless a word stands before the row, as in a sentence.
    values
        As text; numbers have a decimal point.
    units
        Word behind each value that is a unit, empty where there is none; no entries where no value has one.
    """

    form: Form
    labels: tuple[str, ...]
    values: tuple[str, ...]
    units: tuple[str, ...] = ()


def fields_of(line: str) -> Fields | None:
    """The fields of a line; None where it is damaged: an object cut short, or a checksum that is wrong."""
    if line.startswith("{"):
        return _object(line)
    if line[:1] in {"$", "!"} and "*" in line:
        return _sentence(line)
    if line.startswith(">") and (point := TELEPLOT.fullmatch(line)):
        return _teleplot(point)
    if line.startswith("["):
        line = LOG_HEAD.sub("", line, count=1)
        if state := STATE.match(line):
            return Fields(Form.LABELLED, (as_label(state[1]),), (state[2],), _units(line, [state]))
    line = _unwrapped(line)
    if line[:1].isalpha() and (headed := HEADED_ROW.fullmatch(line)):
        return _headed_row(headed)
    found = _labelled(line) if MARK.search(line) else None
    return found or _row(line)


def _unwrapped(line: str) -> str:
    for begin, end in WRAPPED:
        if line.startswith(begin) and line.endswith(end):
            return line[len(begin) : -len(end)].strip()
    return line


def _labelled(line: str) -> Fields | None:
    """Values behind labels; None where there are none, or where one word stands before a row."""
    if "," in LABEL_END.split(line, 1)[0]:
        line = NAMES_FIRST.sub(_names_first, line)
    head, line = head_of(line)
    if BRACKET.search(line):
        line = AXES_NAMED.sub(_named_axes, BRACED.sub(r"\1 ", line))
    line = VECTOR.sub(_axes, line)
    matches = list(LABELLED.finditer(line))
    if not matches or (len(matches) == 1 and sum(map(is_number, _row(line).values)) > 1):
        return None
    labels = with_head(head, _headed(tuple(as_label(match[1]) for match in matches)))
    return Fields(Form.LABELLED, labels, tuple(match[2] for match in matches), _units(line, matches))


def _units(line: str, matches: list[re.Match[str]]) -> tuple[str, ...]:
    """The unit behind each value, which ends its match."""
    units = [_unit_behind(line, match.end()) for match in matches]
    return tuple(units) if any(units) else ()


def _unit_behind(line: str, at: int) -> str:
    tail = TAIL.match(line, at)
    return tail[1] if tail and unit_of(tail[1]) else ""


def _teleplot(point: re.Match[str]) -> Fields:
    name, ms, value, unit = point.groups()
    labels, values = ((TELEPLOT_CLOCK, name), (ms, value)) if ms else ((name,), (value,))
    units = ("",) * (len(values) - 1) + (unit,) if unit and unit_of(unit) else ()
    return Fields(Form.LABELLED, tuple(map(as_label, labels)), values, units)


def _headed_row(headed: re.Match[str]) -> Fields:
    """The word keeps its place in the row, and the values can be asked for by it."""
    word, numbers = as_label(headed[1]), BETWEEN.split(headed[2])
    axes = AXES if len(numbers) == len(AXES) else range(1, len(numbers) + 1)
    return Fields(Form.ROW, ("", *(f"{word} {axis}" for axis in axes)), (headed[1], *numbers))


def checksum(body: str) -> int:
    """Of an NMEA sentence: all characters between `$` and `*`, exclusive or (NMEA 0183)."""
    return reduce(xor, body.encode(errors="replace"), 0)


def as_label(text: str) -> str:
    """A label without what none may hold."""
    return UNSAID.sub("", text).strip()


def is_number(text: str) -> bool:
    """Whether it is one, nan and inf among them."""
    return VALUE.fullmatch(text) is not None


def is_whole(text: str) -> bool:
    """Whether it is a number without a decimal point."""
    return WHOLE.fullmatch(text) is not None


def _object(line: str) -> Fields | None:
    leaves = leaves_of(line)
    if leaves is None:
        return None
    found = [(".".join(map(as_label, path)), value) for path, value in leaves if is_number(value)]
    return Fields(Form.JSON, tuple(label for label, _ in found), tuple(value for _, value in found))


def _sentence(line: str) -> Fields | None:
    found = SENTENCE.fullmatch(line)
    if found is None or checksum(found[1]) != int(found[2], 16):
        return None
    values = tuple(found[1].split(","))
    word = as_label(values[0])
    return Fields(Form.NMEA, ("", *(f"{word} {place}" for place in range(1, len(values)))), values)


def _headed(labels: tuple[str, ...]) -> tuple[str, ...]:
    """`Gyro X: 1 Y: 2 Z: 3` names three of a gyro: a letter alone takes over the words before the first one."""
    head = ""
    full = []
    for label in map(_without_unit, labels):
        words, _, last = label.rpartition(" ")
        if len(last) == 1 and words:
            head = words
        full.append(f"{head} {label}" if len(label) == 1 and head else label)
    return tuple(full)


def _without_unit(label: str) -> str:
    head = UNIT_HEAD.match(label)
    is_unit = head is not None and unit_of(head[1].strip("[]()")) is not None
    if head is None or not is_unit or (len(label) - head.end() < 2 and head[1].isalnum()):  # `g x` is an axis
        return " ".join(label.split())
    return " ".join(label[head.end() :].split())


def _axes(found: re.Match[str]) -> str:
    label, *numbers = found.groups()
    return ", ".join(f"{label} {axis}={number}" for axis, number in zip(AXES, numbers, strict=True)) + " "


def _named_axes(found: re.Match[str]) -> str:
    word, *rest = found.groups()
    return ", ".join(f"{word} {axis}={number}" for axis, number in zip(rest[:3], rest[3:], strict=True)) + " "


def _names_first(found: re.Match[str]) -> str:
    names, values = [name.strip() for name in found[1].split(",")], BETWEEN.split(found[2])
    if len(names) != len(values):
        return found[0]
    return ", ".join(f"{name}={value}" for name, value in zip(names, values, strict=True)) + " "


def _row(line: str) -> Fields:
    mark = next((each for each in SEPARATORS if each in line), None)
    parts = line.split() if mark is None else [part.strip() for part in line.split(mark)]
    if len(parts) > 1 and not parts[-1]:
        parts.pop()  # a sketch that prints a separator behind each value
    units = [""] * len(parts)
    if mark is not None:
        for at, part in enumerate(parts):
            if found := WITH_UNIT.fullmatch(part):
                parts[at], units[at] = found[1], found[2] if unit_of(found[2]) else ""
    if mark != ",":
        parts = [part.replace(",", ".") if DECIMAL_COMMA.fullmatch(part) else part for part in parts]
    return Fields(Form.ROW, ("",) * len(parts), tuple(parts), tuple(units) if any(units) else ())
