"""A line of text as fields: numbers in a row, `label: value` pairs, a JSON object, or an NMEA sentence.

Sketches print what a serial plotter or a person likes to read, so the same three numbers come in many forms. What is
behind a value, such as its unit, belongs to nobody and is passed over.
"""

import re
from enum import StrEnum
from functools import reduce
from operator import xor
from typing import NamedTuple

from gyrodrift.link.text.objects import leaves_of

NUMBER = r"[-+]?(?:[0-9]++(?:\.[0-9]*+)?+|\.[0-9]++)(?:[eE][-+]?[0-9]++)?+"
"""In the digits that a device prints; Python takes those of other scripts for numbers too."""

WHOLE = re.compile(r"[-+]?[0-9]++")
VALUE = re.compile(rf"(?:{NUMBER}|nan|inf|[-+]inf)", re.IGNORECASE)
LABEL = r"(?<![A-Za-z_])([A-Za-z_][\w .()\[\]/°-]{0,40}?)\s*+"
LABELLED = re.compile(rf"{LABEL}(?:[:=]\s*+\[?|\[)\s*+({NUMBER}|nan)", re.IGNORECASE)
VECTOR = re.compile(
    rf"{LABEL}(?:[:=]\s*+[\[(]?|[\[(])\s*+"
    rf"({NUMBER})[\s,;]++({NUMBER})[\s,;]++({NUMBER})(?![\w.])(?!\s*+[,;]?\s*+[-+.0-9])\s*+[\])]?"
)
"""`Gyr (DPS) [ 1, 2, 3 ]`, `Gyro: 1 2 3`, `gyro=(1, 2, 3)`: three numbers of one label are those of three axes."""

BRACED = re.compile(r"(?<![A-Za-z_])([A-Za-z_][\w ]{0,40}?)\s*+[:=]\s*+[{(\[]\s*+(?=[A-Za-z_]\w*+\s*+[:=])")
"""`gyro={x=1, y=2}`: what is in the braces belongs to the word before them."""

STATE = re.compile(rf"'([^']+)'(?:: Sending state|\s*+>>)\s*+({NUMBER}|nan)", re.IGNORECASE)
"""A sensor of ESPHome in its log."""

LOG_HEAD = re.compile(r"(?:\[[^\[\]\s]++\])++:?\s++(?=['A-Za-z])")
"""`[12:34:56][D][sensor:094]: ` before a message."""

UNIT_HEAD = re.compile(
    r"^(?:°|m?deg(?:rees)?/s(?:ec(?:ond)?)?|m?dps|m?rad/s|/s|m/s\^?2|m/s²|deg[CF]?|degrees|mg|g|[mun]?s|C|F|uT)\s++(?=\S\S)"
)
"""The unit of the value before stands in front of a label where nothing parts them: `gx: 1 deg/s gy: 2 deg/s`."""

WITH_UNIT = re.compile(rf"({NUMBER})\s*+[A-Za-z°µ%][\w/²^°]*+")
MARK = re.compile(r"[:=\[(]")
"""Without one of those there is no label."""

AXES = "xyz"
UNSAID = re.compile(r"[^\w .()\[\]/°-]")
"""What no label holds: labels are told to people and pasted into shells, whatever a device calls its values."""

SENTENCE = re.compile(r"[$!]([^*]*+)\*([0-9A-Fa-f]{2})")
SEPARATORS = (";", "\t", "|", ",")
"""Asked in this order: with a semicolon or a tab, a comma may be the decimal point of a language."""

DECIMAL_COMMA = re.compile(r"[-+]?[0-9]++,[0-9]++")
BRACKETS = {"(": ")", "[": "]"}


class Form(StrEnum):
    """How the values of a line are told apart."""

    ROW = "a row of values"
    LABELLED = "label:value pairs"
    JSON = "a JSON object"
    NMEA = "an NMEA sentence"


class Fields(NamedTuple):
    """What stands in a line.

    labels
        One for each value; the first word of an NMEA sentence and values in a row have an empty one.
    values
        As text; numbers have a decimal point.
    """

    form: Form
    labels: tuple[str, ...]
    values: tuple[str, ...]


def fields_of(line: str) -> Fields | None:
    """The fields of a line; None where it is damaged: an object cut short, or a checksum that is wrong."""
    if line.startswith("{"):
        return _object(line)
    if line[:1] in {"$", "!"} and "*" in line:
        return _sentence(line)
    if line.startswith("["):
        line = LOG_HEAD.sub("", line, count=1)
        if state := STATE.match(line):
            return Fields(Form.LABELLED, (as_label(state[1]),), (state[2],))
    if line[:1] in BRACKETS and line[-1:] == BRACKETS[line[:1]]:
        line = line[1:-1].strip()
    found = LABELLED.findall(VECTOR.sub(_axes, BRACED.sub(r"\1 ", line))) if MARK.search(line) else []
    values = _row(line)
    if found and not (len(found) == 1 and sum(map(is_number, values)) > 1):  # one word may stand before a row
        labels, labelled = zip(*found, strict=True)
        return Fields(Form.LABELLED, _headed(labels), labelled)
    return Fields(Form.ROW, ("",) * len(values), values)


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
    return Fields(Form.NMEA, ("",) * len(values), values)


def _headed(labels: tuple[str, ...]) -> tuple[str, ...]:
    """`Gyro X: 1 Y: 2 Z: 3` names three of a gyro: a letter alone takes over the words before the first one."""
    head = ""
    full = []
    for label in (" ".join(UNIT_HEAD.sub("", label, count=1).split()) for label in labels):
        words, _, last = label.rpartition(" ")
        if len(last) == 1 and words:
            head = words
        full.append(f"{head} {label}" if len(label) == 1 and head else label)
    return tuple(full)


def _axes(found: re.Match[str]) -> str:
    label, *numbers = found.groups()
    return ", ".join(f"{label} {axis}={number}" for axis, number in zip(AXES, numbers, strict=True)) + ", "


def _row(line: str) -> tuple[str, ...]:
    mark = next((each for each in SEPARATORS if each in line), None)
    parts = line.split() if mark is None else [part.strip() for part in line.split(mark)]
    if len(parts) > 1 and not parts[-1]:
        parts.pop()  # a sketch that prints a separator behind each value
    if mark is not None:
        parts = [unit[1] if (unit := WITH_UNIT.fullmatch(part)) else part for part in parts]
    if mark != ",":
        parts = [part.replace(",", ".") if DECIMAL_COMMA.fullmatch(part) else part for part in parts]
    return tuple(parts)
