"""Prefix that a terminal or a log puts in front of a line: times, levels and modules.

`12:34:56.789 -> 1,2,3` (Arduino), `[00:00:01.234,000] <inf> imu: gz 1` (Zephyr), `I (1234) imu: gz=1` (ESP-IDF),
`2024-01-02 03:04:05.678 INFO gz=1` (Python), `[123456] gz:1`. A time with a fraction is a clock.
"""

import re
from datetime import UTC, datetime
from typing import NamedTuple

from gyrodrift.columns.names import kind_of

DAY_S = 86400
SENDER_LONGEST = 20
LABEL, SENDER_LABEL = "time", "sender"
"""Labels of the clock and of the sender of a prefix."""

SENDER = re.compile(
    r"[\[(<]?((?:[0-9A-Fa-f]{2}[:-]){5}[0-9A-Fa-f]{2}|\d{1,3}(?:\.\d{1,3}){3}(?::\d{1,5})?+)[\])>]?"
    r"(?:\s*+(?:->|=>|[:>|])\s*+|\s++(?:-\s++)?)(?=[^\s,;])"
)
"""Address of a device in front of a line, MAC or IP: ESP-NOW, BLE hubs and servers print those of several."""

DATE = r"(?:(?P<date>\d{4}[-/.]\d\d[-/.]\d\d)|\d\d-\d\d)[T _]"
STAMP = re.compile(
    rf"(?:{DATE})?(?P<h>\d{{1,2}}):(?P<m>\d\d):(?P<s>\d\d)(?:[.,](?P<part>\d{{1,9}}(?:,\d{{3}})?+))?+"
    r"(?:\s?(?P<half>[AaPp])[Mm])?+(?:\s?(?:Z\b|UTC\b|[-+]\d\d:?\d\d))?+"
)
EPOCH = re.compile(r"(\d{9,10}\.\d{1,9})\s++(?=[A-Za-z{$#\"'<>])")
"""Seconds since 1970 in front of names, as `ts` of moreutils writes them."""

ARROW = re.compile(r"\s*+(?:->|=>|[>|])\s*+|\s++-\s++|:\s++")
BOX = re.compile(r"\[\s*+([^\[\]]{1,40})\]|\(([^()]{1,40})\)(?=\s)")
TICKS = re.compile(r"\d{1,18}(?:\.\d{1,9})?\s*+")
LEVEL = re.compile(
    r"(?:<(?:inf|dbg|wrn|err)>|\[?\b(?:TRACE|DEBUG|INFO|NOTICE|WARN(?:ING)?|ERROR|CRITICAL|FATAL)\b\]?:?|\[[TDIWEV]\]"
    r"|[TDIWEV](?=\s\()|\d{1,6}\s++\d{1,6}\s++[VDIWEF]\s)\s*+(?:-\s++)?"
)
MODULE = re.compile(
    r"(?!target|set_?point|desired|cmd|command|goal|ref|control|pid)([A-Za-z_][\w./-]{0,40})"
    r"(?:(?:\(\))?\s{0,20}:\s*+(?![-+.\d\[({]|nan)|(\s-\s++))",
    re.IGNORECASE,
)
"""Name of a module in a log; not of a setpoint, whose yaw is not the yaw, and not the label of a number."""

DATA = re.compile(r"[A-Za-z_{<>$!#\"'\[(]")
"""First character of a line with names. After a time alone, numbers are the next cells of a table."""

NOT_EMPTY = re.compile(r".")
NO_DATA = re.compile(r"[\],;|:]|$")
FIRST = frozenset("[(<TDIWEVNCF")
"""First characters of boxes and levels."""

NUMBERS_IN_BOX = re.compile(r"[\[(]\s*+[-+.\d]")


class Prefixed(NamedTuple):
    """A line without its prefix.

    rest
        The line.
    stamp
        Clock of the prefix as a number; empty without one.
    unit
        Unit of the clock; empty for ticks.
    sender
        Address of the device that sent the line; empty without one.
    """

    rest: str
    stamp: str = ""
    unit: str = ""
    sender: str = ""


def split_prefix(line: str) -> Prefixed:
    """Split a line after its prefix."""
    prefixed = _split_log(line)
    is_address = prefixed.rest[2:3] in {":", "-"} or prefixed.rest.count(".", 0, SENDER_LONGEST) >= 3
    sender = SENDER.match(prefixed.rest) if is_address or prefixed.rest[:1] in "[(<" else None
    return prefixed._replace(rest=prefixed.rest[sender.end() :], sender=sender[1]) if sender else prefixed


def _split_log(line: str) -> Prefixed:
    has_time = line[:1].isdigit() and (":" in line[:20] or "." in line[9:11])
    if not has_time and line[:1] not in FIRST:
        return Prefixed(line)
    rest, stamp, unit, is_log = line, "", "", False
    while True:
        level = LEVEL.match(rest)
        if level and (DATA if not stamp else NOT_EMPTY).match(rest, level.end()):
            rest, is_log = rest[level.end() :], True
        elif (piece := _clock(rest, is_log=is_log, is_first=rest is line)) is not None:
            rest, stamp, unit, _ = piece if piece.stamp else piece._replace(stamp=stamp, unit=unit)
        elif (module := _module(rest, is_log=is_log)) and rest is not line:
            rest = rest[module:]
        else:
            return Prefixed(rest, stamp, unit)


class PrefixReader:
    """Splits consecutive lines; after midnight the time of the day goes on."""

    def __init__(self) -> None:
        self._days, self._last_s = 0, 0

    def split(self, line: str) -> Prefixed:
        """Split the next line after its prefix."""
        prefixed = split_prefix(line)
        if prefixed.unit != "s":
            return prefixed
        whole, point, part = prefixed.stamp.partition(".")
        of_day_s = int(whole)
        if of_day_s >= DAY_S:
            return prefixed
        self._days += of_day_s < self._last_s - DAY_S // 2
        self._last_s = of_day_s
        return prefixed._replace(stamp=f"{self._days * DAY_S + of_day_s}{point}{part}")


def _module(rest: str, *, is_log: bool) -> int:
    """Length of the name of a module, which is no quantity; 0 without one, or without a level or a dash."""
    module = MODULE.match(rest)
    is_module = module and (is_log or module[2]) and module.end() < len(rest)
    return module.end() if module and is_module and not kind_of(f"{module[1]} z") else 0


def _clock(rest: str, *, is_log: bool, is_first: bool) -> Prefixed | None:
    """Rest after the next time or box; None if something else begins."""
    box = BOX.match(rest)
    inner, end = (box[1] or box[2], box.end()) if box else (rest, 0)
    if is_first and (epoch := EPOCH.match(rest)):
        return _after(rest, epoch.end(), epoch[1], "s")
    stamp = STAMP.match(inner)
    if stamp and box and stamp.end() == len(inner.rstrip()):
        return _after(rest, end, *_seconds(stamp))
    if stamp and not box and is_first:
        arrow = ARROW.match(rest, stamp.end())
        end = arrow.end() if arrow else stamp.end()
        rest_line = rest[end:].lstrip()
        is_prefix = arrow or (
            rest[end : end + 1] in " [" and (DATA.match(rest_line) or LEVEL.match(rest_line) or SENDER.match(rest_line))
        )
        return _after(rest, end, *_seconds(stamp)) if is_prefix else None
    if not box:
        return None
    if TICKS.fullmatch(inner):
        unit = "s" if "." in inner else "ms" if is_log else ""
        is_list = NUMBERS_IN_BOX.match(rest[end:].lstrip())
        return _after(rest, end, inner.strip(), unit) if not is_list and (box[1] or is_log) else None
    is_name = box[1] and not is_first and inner[0].isalpha() and not kind_of(f"{inner} z")
    return _after(rest, end) if is_name else None


def _after(rest: str, end: int, stamp: str = "", unit: str = "") -> Prefixed | None:
    """Rest from `end` on; None if no data follow, as in a list of numbers in brackets."""
    arrow = ARROW.match(rest, end)
    rest = rest[arrow.end() if arrow else end :].lstrip()
    return None if NO_DATA.match(rest) else Prefixed(rest, stamp, unit)


def _seconds(stamp: re.Match[str]) -> tuple[str, str]:
    """Seconds of a day, or since 1970, and their unit; empty without a fraction, which is too coarse for a clock."""
    if not stamp["part"]:
        return "", ""
    hour = int(stamp["h"]) % 12 + 12 * (stamp["half"] in "Pp") if stamp["half"] else int(stamp["h"])
    whole_s = 3600 * hour + 60 * int(stamp["m"]) + int(stamp["s"])
    if stamp["date"]:
        year, month, day = (int(part) for part in re.split(r"\D", stamp["date"]))
        try:
            whole_s += round(datetime(year, month, day, tzinfo=UTC).timestamp())
        except ValueError:
            return "", ""
    return f"{whole_s}.{stamp['part'].replace(',', '')}", "s"
