"""Clocks of tables, read without rounding: integers of any unit, decimals, ISO 8601, and times of day."""

import re
from collections.abc import Sequence
from datetime import UTC, datetime, timedelta, timezone
from math import isfinite

import numpy as np

from gyrodrift.values.arrays import Floats
from gyrodrift.values.constants import NS_PER_S

PER_S = {"t_s": 1, "t_ms": 10**3, "t_us": 10**6, "t_ns": 10**9}
DAY_S = 86400
OFFSET_S = 1e8
"""A clock that starts after this counts from a date; its first stamp is subtracted before rounding."""

EPOCH_S = (946_684_800, 4_102_444_800)
"""The years 2000 to 2100 in Unix time."""

STEP_S = (1e-6, 10.0)
"""Plausible time between samples; distinguishes seconds since 1970 from microseconds since power-on."""

DATED = re.compile(
    r"(?:(?P<ymd>\d{4}[-/]\d\d[-/]\d\d)|(?P<dmy>\d\d?\.\d\d?\.\d{4}))[T ,]+"
    r"(?P<time>\d\d?:\d\d:\d\d)(?:[.,](?P<part>\d{1,18}))?\s*(?P<zone>Z|UTC|[-+]\d\d:?\d\d)?"
)
TIMED = re.compile(r"(?P<time>\d\d?:\d\d:\d\d)(?:[.,:](?P<part>\d{1,18}))?")
WHOLE = re.compile(r"[-+]?\d+")
DECIMAL = re.compile(r"(\d+)\.(\d*)")
LONGEST = 64


def is_time(text: str) -> bool:
    """Whether a text is a date with a time, or a time of day."""
    return ":" in text and len(text) <= LONGEST and bool(DATED.fullmatch(text) or TIMED.fullmatch(text))


def epoch_unit(texts: Sequence[str]) -> str:
    """Unit of a clock without a stated unit, as in a SPEC; empty if the numbers are no Unix time of these years."""
    try:
        stamps = [float(text.replace(",", ".")) for text in texts if text.strip()]
    except ValueError:
        return ""
    if len(stamps) < 2 or not all(map(isfinite, stamps)):
        return ""
    step = float(np.median(np.abs(np.diff(stamps))))
    for unit, per_s in PER_S.items():
        is_date = all(EPOCH_S[0] <= stamp / per_s <= EPOCH_S[1] for stamp in stamps)
        if is_date and STEP_S[0] <= step / per_s <= STEP_S[1]:
            return unit
    return ""


class StampReader:
    """Reads the stamps of a clock in pieces, as seconds; `began` is the first stamp if it counts as 0 s.

    unit
        As in a SPEC, such as `t_us`; ignored for a date or a time of day.
    """

    def __init__(self, unit: str) -> None:
        self.began = ""
        self._per_s = PER_S[unit]
        self._base: int | None = None
        self._base_part = 0.0
        self._dates: dict[tuple[str, str], int] = {}
        self._days, self._last_s = 0, 0

    def read(self, texts: Sequence[str]) -> Floats:
        """Seconds, shape (n,).

        Raises
        ------
        ValueError
            A text is no time.
        """
        if any(":" in text for text in texts[:1]):
            return self._since([self._time_ns(text.strip()) for text in texts], NS_PER_S, texts[0])
        try:
            whole = list(map(int, texts))
        except ValueError:
            return self._decimals(texts)
        return self._since(whole, self._per_s, texts[0])

    def _since(self, stamps: list[int], per_s: int, first: str) -> Floats:
        if self._base is None:
            far = abs(stamps[0]) >= OFFSET_S * per_s or ":" in first
            self._base, self.began = (stamps[0], first.strip()) if far else (0, "")
        try:
            since = np.array(stamps, dtype=np.int64) - self._base
        except OverflowError as error:
            raise ValueError("a clock has too many digits for 64 bits") from error
        return since / float(per_s)

    def _decimals(self, texts: Sequence[str]) -> Floats:
        values = [float(text) for text in texts]
        if self._base is None:
            far = isfinite(values[0]) and abs(values[0]) >= OFFSET_S * self._per_s
            self._base, self.began = (int(values[0]), texts[0].strip()) if far else (0, "")
            self._base_part = _part_of(texts[0]) if far else 0.0
        if not self._base:
            return np.array(values) / float(self._per_s)
        parts = (DECIMAL.fullmatch(text.strip()) for text in texts)
        exact = [
            int(part[1]) - self._base + (float(f"0.{part[2]}") - self._base_part) if part else value - self._base
            for part, value in zip(parts, values, strict=True)
        ]
        return np.array(exact) / float(self._per_s)

    def _time_ns(self, text: str) -> int:
        match = DATED.fullmatch(text) or TIMED.fullmatch(text)
        if match is None:
            raise ValueError(f"{text!r} is no time")
        part_ns = int((match["part"] or "0").ljust(9, "0")[:9])
        if "ymd" not in match.re.groupindex:
            return self._of_day_s(match["time"]) * NS_PER_S + part_ns
        date, zone = match["ymd"] or ".".join(reversed(match["dmy"].split("."))), match["zone"] or ""
        key = f"{date} {match['time']}", zone
        if key not in self._dates:
            self._dates.clear()
            self._dates[key] = _unix_s(date, match["time"], zone)
        return self._dates[key] * NS_PER_S + part_ns

    def _of_day_s(self, time: str) -> int:
        """Seconds since the first midnight; a step back by half a day begins the next day."""
        hours, minutes, seconds = map(int, time.split(":"))
        of_day_s = 3600 * hours + 60 * minutes + seconds
        if of_day_s < self._last_s - DAY_S // 2:
            self._days += 1
        self._last_s = of_day_s
        return self._days * DAY_S + of_day_s


def _part_of(text: str) -> float:
    match = DECIMAL.fullmatch(text.strip())
    return float(f"0.{match[2]}") if match else 0.0


def _unix_s(date: str, time: str, zone: str) -> int:
    year, month, day = (int(part) for part in re.split(r"[-/.]", date))
    hours, minutes, seconds = (int(part) for part in time.split(":"))
    leap, seconds = (1, 59) if seconds == 60 else (0, seconds)
    stamp = datetime(year, month, day, hours, minutes, seconds, tzinfo=_zone(zone))
    return round(stamp.timestamp()) + leap


def _zone(zone: str) -> timezone:
    if zone in {"", "Z", "UTC"}:
        return UTC
    hours, minutes = int(zone[1:3]), int(zone[-2:])
    offset = timedelta(hours=hours, minutes=minutes)
    return timezone(offset if zone[0] == "+" else -offset)
