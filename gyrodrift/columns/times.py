"""Clocks of tables and of text, read without rounding: numbers, dates, times of day, steps, and sums of columns."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import date
from functools import reduce
from itertools import accumulate, islice, pairwise
from math import isfinite
from operator import add, gt, le
from statistics import median

from gyrodrift.columns.spec import CLOCK, COUNTED_US, scale_of
from gyrodrift.values.constants import DELTA_GAP_PERIODS, NS_PER_S

PER_S = {"t_s": 1, "t_ms": 10**3, "t_us": 10**6, "t_ns": 10**9}
DAY_S, HOUR_S = 86400, 3600
OFFSET_S = 1e8
"""A clock that starts after this counts from a date; its first stamp is subtracted before rounding."""

EPOCH_S = (946_684_800, 4_102_444_800)
"""The years 2000 to 2100 in Unix time."""

STEP_S = (1e-6, 10.0)
"""Plausible time between samples; distinguishes seconds since 1970 from microseconds since power-on."""

WRAPS = (1 << 16, 1 << 24, 1 << 32)
WRAP_STEPS = 8
"""A clock that goes back by one of WRAPS, less these steps at most, has wrapped; a restart hits that by chance only."""

DATE = (
    r"(?P<date>\d{4}[-/.]\d\d?[-/.]\d\d?|\d\d?([-/.])\d\d?\2(?:\d{4}|\d\d)"
    r"|\d\d?[- ][A-Za-z]{3,9}\.?[- ]\d{4}|[A-Za-z]{3,9}\.? \d\d?,? \d{4})"
)
TIME = (
    r"(?:(?P<days>\d{1,6}) days?,? )?(?P<time>\d{1,4}:\d\d?(?::\d\d?|(?=[.,])))(?:[.,:](?P<part>\d{1,18}))?"
    r"(?:[ \u00a0\u202f]?(?P<half>[AaPp])(?:\. ?)?[Mm]\.?)?"
)
DATED = re.compile(rf"{DATE}(?:[T ,]{{1,3}}{TIME} ?(?P<zone>Z|UTC|GMT|[-+]\d\d(?::?\d\d)?)?)?")
TIMED = re.compile(TIME)
FORMS = (
    "a number, 14:15:00.250, 2:15:00.250 PM, 15:00.250 (minutes and seconds), 2024-05-01T14:15:00.250Z, 01.05.2024"
    " 14:15:00.250, 5/1/2024 2:15:00.250 PM or 01-May-2024 14:15:00.250"
)
"""Forms of a clock that are read, for messages."""

MONTHS = ("jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec")
ORDERS = {"mdy": (0, 1), "dmy": (1, 0)}
"""Position of month and day in dates without the name of the month."""

DECIMAL = re.compile(r"(\d+)\.(\d*)")
CLOCK_NUMBER = re.compile(r"(\d{1,6}?)(?:\.(\d*)|(?<=\d{4})(\d{3}))?")
"""HHMMSS with a fraction, or HHMMSSmmm."""

COUNTED = re.compile(r"(\d+)[.,](\d{1,9})")
FRACTION = re.compile(r"\d[.,:](\d{1,9})\D*")
LONGEST = 64
LEAST_BACKWARD = 3
"""Steps back that show a fraction without leading zeros."""

LARGEST = 2**63
"""Above, a clock does not fit 64 bits."""


def is_time(text: str) -> bool:
    """Whether a text is a date with a time, or a time of day."""
    return ":" in text and is_stamp(text)


def is_date(text: str) -> bool:
    """Whether a text is a date without a time."""
    return ":" not in text and len(text) <= LONGEST and bool(DATED.fullmatch(text))


def is_time_of_day(text: str) -> bool:
    """Whether a text is a time without a date."""
    return len(text) <= LONGEST and bool(TIMED.fullmatch(text))


def is_stamp(text: str) -> bool:
    """Whether a text is a date, with or without a time, or a time of day."""
    return len(text) <= LONGEST and bool(DATED.fullmatch(text) or TIMED.fullmatch(text))


MINUTE_JUMP, HOUR_JUMP, LARGEST_HMS, SLOWEST_HMS_S = 40.0, 4000.0, 240_000.0, 1.5
"""HHMMSS jumps from 59 to 100, and from 5959 to 10000, and ends at midnight; samples come once a second.

A larger number is HHMMSSmmm.
"""


def is_hms(numbers: Sequence[float]) -> bool:
    """Whether numbers are times of day as HHMMSS: no part is above 59, and they jump where a minute ends."""
    if max(numbers, default=0.0) >= LARGEST_HMS:
        numbers = [number / 1e3 for number in numbers]
    if not all(
        0.0 <= number < LARGEST_HMS and number % 100.0 < 60.0 and number // 100.0 % 100.0 < 60.0 for number in numbers
    ):
        return False
    steps = [after - before for before, after in pairwise(numbers)]
    jumps = [step % HOUR_JUMP - MINUTE_JUMP for step in steps if step > MINUTE_JUMP]
    return bool(jumps) and median(steps) < SLOWEST_HMS_S and max(jumps) < DELTA_GAP_PERIODS * median(steps)


def epoch_unit(texts: Sequence[str]) -> str:
    """Unit of a clock without a stated unit, as in a SPEC; empty if the numbers are no Unix time of these years."""
    try:
        stamps = [float(text.replace(",", ".")) for text in texts if text.strip()]
    except ValueError:
        return ""
    if len(stamps) < 2 or not all(map(isfinite, stamps)):
        return ""
    step = median(abs(after - before) for before, after in pairwise(stamps))
    for unit, per_s in PER_S.items():
        is_date = all(EPOCH_S[0] <= stamp / per_s <= EPOCH_S[1] for stamp in stamps)
        if is_date and STEP_S[0] <= step / per_s <= STEP_S[1]:
            return unit
    return ""


def counted_unit(texts: Sequence[str]) -> str:
    """Unit of COUNTED_US of times whose fraction has no leading zeros, as `%ld.%ld` prints it; empty for others."""
    digits = max((len(match[1]) for text in texts if (match := FRACTION.search(text))), default=0)
    unit = "s.ms" if digits <= 3 else "s.us" if digits <= 6 else "s.ns"
    try:
        read_s, counted_s = (_StampColumn(f"t:{name}").times_s(texts) for name in ("s", unit))
    except ValueError:
        return ""
    return unit if _backward(read_s) >= LEAST_BACKWARD and not _backward(counted_s) else ""


@dataclass(frozen=True, slots=True)
class StatedClock:
    """Clock of a recording as the user states it; empty values leave it to the recording.

    unit
        One of CLOCK_UNITS_US, or lsb/N.
    sample_rate_hz
        Rate of the samples, in place of a clock.
    """

    unit: str = ""
    sample_rate_hz: float = 0.0

    def entry(self, entry: str) -> str:
        """Entry of a clock in the stated unit; a part of a clock stays."""
        if not self.unit or entry.startswith("+"):
            return entry
        return f"dt:{self.unit}" if entry.startswith("d") else f"t:{self.unit}"


AS_READ = StatedClock()


def unit_of_clock(entry: str) -> str:
    """Unit of the entry of a clock: `us` of `t_us`, `days` of `t:days`."""
    return re.split("[_:]", entry)[-1]


class ClockReader:
    """Reads a clock that stands in one or several columns, in pieces for a file or one by one for a port.

    A piece that cannot be read changes nothing.

    entries
        As in a SPEC: `t_us`, `t:days`, `dt_ms`, or `t_s` and `+t_ns`, whose sum counts.
    """

    def __init__(self, entries: Sequence[str]) -> None:
        self._columns = [_StampColumn(entry) for entry in entries]

    @property
    def began(self) -> str:
        """First stamp, if it counts as 0 s; empty otherwise."""
        return " ".join(column.began for column in self._columns if column.began)

    @property
    def counted(self) -> str:
        """Unit of COUNTED_US in which the clock goes forward, if its fraction has no leading zeros; empty otherwise."""
        return next((column.counted for column in self._columns if column.counted), "")

    def read(self, cells: Sequence[Sequence[str]]) -> list[float]:
        """Seconds from the texts of each column.

        Raises
        ------
        ValueError
            A text is no time.
        """
        self._look_for_dates([texts[0] for texts in cells])
        before = [column.state() for column in self._columns]
        try:
            parts = [column.read(texts) for column, texts in zip(self._columns, cells, strict=True)]
        except ValueError:
            for column, state in zip(self._columns, before, strict=True):
                column.restore(state)
            raise
        return reduce(lambda sums, part: list(map(add, sums, part)), parts)

    def stamp_us(self, cells: Sequence[str]) -> int:
        """Microseconds, not wrapped, from a text of each column.

        Raises
        ------
        ValueError
            A text is no time.
        """
        if len(cells) == 1:
            return self._columns[0].stamp_us(cells[0])
        self._look_for_dates(cells)
        return sum(column.stamp_us(text) for column, text in zip(self._columns, cells, strict=True))

    def _look_for_dates(self, cells: Sequence[str]) -> None:
        """With a date beside it, a time of day does not count the days."""
        if len(self._columns) > 1 and any(DATED.fullmatch(text.strip()) for text in cells):
            for column in self._columns:
                column.counts_days = False


class _StampColumn:
    """Stamps of one column."""

    def __init__(self, entry: str) -> None:
        self.began, self.counted, self.counts_days = "", "", True
        self._is_step, self._unit = entry.startswith("d"), unit_of_clock(entry)
        self._is_text = self._unit in ("hms", *COUNTED_US)
        us = scale_of(CLOCK, self._unit) or 1.0
        self._per_s: float = PER_S.get(f"t_{self._unit}", 1e6 / us)
        self._us = round(us) if us >= 1.0 and us == round(us) else us
        self._base: int | None = None
        self._base_part = 0.0
        self._sum = 0.0
        self._wraps = () if entry.startswith("+") else WRAPS
        self._wrapped = self._step = 0
        self._last: int | None = None
        self._day_text, self._day = "", 0
        self._order, self._shift = "", 0
        self._days_s, self._last_s = 0, 0

    def state(self) -> dict[str, object]:
        """Snapshot for `restore`."""
        return dict(vars(self))

    def restore(self, state: dict[str, object]) -> None:
        """Forget what was read since this state."""
        vars(self).update(state)

    def read(self, texts: Sequence[str]) -> list[float]:
        """Seconds of texts; notes a fraction without leading zeros."""
        t_s = self.times_s(texts)
        if not self.counted and self._unit not in COUNTED_US and _backward(t_s) >= LEAST_BACKWARD:
            self.counted = counted_unit(texts)
        return t_s

    def times_s(self, texts: Sequence[str]) -> list[float]:
        """Seconds of texts."""
        if self._is_step:
            _, *sums = accumulate(map(_finite, texts), initial=self._sum)
            self._sum = sums[-1]
            return [value / self._per_s for value in sums]
        if self._is_text or is_stamp(texts[0].strip()):
            return self._since([self._time_ns(text.strip()) for text in texts], NS_PER_S, texts[0])
        try:
            whole = self._unwrapped(list(map(int, texts)))
        except ValueError:
            return self._decimals(texts)
        return self._since(whole, self._per_s, texts[0])

    def stamp_us(self, text: str) -> int:
        """Microseconds of a text."""
        if self._is_step:
            self._sum += _finite(text)
            return round(self._sum * self._us)
        if self._is_text:
            return self._time_ns(text) // 1000
        try:
            (whole,) = self._unwrapped([int(text)])
        except ValueError:
            return self._time_ns(text) // 1000 if is_stamp(text) else round(_finite(text) * self._us)
        return round(whole * self._us)

    def _unwrapped(self, stamps: list[int]) -> list[int]:
        """Whole numbers that go on where a counter of 16, 24 or 32 bits, signed or not, has wrapped."""
        last = stamps[0] if self._last is None else self._last
        if not self._wrapped and last <= stamps[0] and all(map(le, stamps, islice(stamps, 1, None))):
            self._step = (stamps[-1] - stamps[-2] if len(stamps) > 1 else stamps[0] - last) or self._step
            self._last = stamps[-1]
            return stamps
        unwrapped = []
        for stamp in stamps:
            step = stamp - last
            if step < 0:
                self._wrapped += next((wrap for wrap in self._wraps if 0 < step + wrap <= WRAP_STEPS * self._step), 0)
            self._step = step if step > 0 else self._step
            last = stamp
            unwrapped.append(stamp + self._wrapped)
        self._last = last
        return unwrapped

    def _since(self, stamps: list[int], per_s: float, first: str) -> list[float]:
        if self._base is None:
            far = abs(stamps[0]) >= OFFSET_S * per_s or is_stamp(first.strip())
            self._base, self.began = (stamps[0], first.strip()) if far else (0, "")
        if max(map(abs, stamps)) > LARGEST:
            raise ValueError("a clock has too many digits for 64 bits")
        base, divisor = self._base, float(per_s)
        return [(stamp - base) / divisor for stamp in stamps]

    def _decimals(self, texts: Sequence[str]) -> list[float]:
        values = [float(text) for text in texts]
        if self._base is None:
            far = isfinite(values[0]) and abs(values[0]) >= OFFSET_S * self._per_s
            self._base, self.began = (int(values[0]), texts[0].strip()) if far else (0, "")
            self._base_part = _part_of(texts[0]) if far else 0.0
        if self._base:
            parts = (DECIMAL.fullmatch(text.strip()) for text in texts)
            values = [
                int(part[1]) - self._base + (float(f"0.{part[2]}") - self._base_part) if part else value - self._base
                for part, value in zip(parts, values, strict=True)
            ]
        return [value / float(self._per_s) for value in values]

    def _time_ns(self, text: str) -> int:
        """Nanoseconds of a date, of a time of day, or of a number in parts."""
        if self._unit == "hms" and (number := CLOCK_NUMBER.fullmatch(text)):
            whole = int(number[1])
            of_day_s = whole // 10_000 * HOUR_S + whole // 100 % 100 * 60 + whole % 100
            if of_day_s >= DAY_S:
                raise ValueError(f"{text!r} is no time of day")
            return self._after_midnight(of_day_s, DAY_S) * NS_PER_S + self._part_ns(number[2] or number[3])
        if self._unit in COUNTED_US and (number := COUNTED.fullmatch(text)):
            return int(number[1]) * NS_PER_S + self._part_ns(number[2])
        match = DATED.fullmatch(text) or TIMED.fullmatch(text)
        if match is None:
            raise ValueError(f"{text!r} is no time")
        of_day_s = _of_day_s(match["time"] or "0:0:0", match["half"])
        named = match.groupdict()
        if "date" in named:
            t_s = self._day_of(match["date"]) * DAY_S + of_day_s - _zone_s(named["zone"])
        elif match["days"]:
            t_s = int(match["days"]) * DAY_S + of_day_s
        else:
            t_s = self._after_midnight(of_day_s, DAY_S if match["time"].count(":") > 1 else HOUR_S)
        return t_s * NS_PER_S + self._part_ns(match["part"])

    def _part_ns(self, part: str | None) -> int:
        """Nanoseconds of the digits after the point."""
        if self._unit in COUNTED_US:
            return round(int(part or 0) * COUNTED_US[self._unit] * 1e3)
        return int((part or "0").ljust(9, "0")[:9])

    def _after_midnight(self, of_day_s: int, period_s: int) -> int:
        """Seconds since the first midnight, or full hour; a step back by half of it begins the next one."""
        if self.counts_days and of_day_s < self._last_s - period_s // 2:
            self._days_s += period_s
        self._last_s = of_day_s
        return self._days_s + of_day_s

    def _day_of(self, text: str) -> int:
        """Day of a date since 1970.

        Which of two numbers is the month is open until a date has a number above 12, or follows another date: a day
        later is likelier than a month. Until then the times are the same.
        """
        if text == self._day_text:
            return self._day
        orders = _days_of(text)
        before = _days_of(self._day_text) if self._day_text else {}
        if not self._order and len(set(orders.values())) > 1 and before:
            self._order = min(orders, key=lambda order: abs(orders[order] - before.get(order, 0)))
        elif not self._order and len(orders) == 1:
            (self._order,) = orders
        if self._order not in orders and self._order:
            raise ValueError(f"{text!r} is no date beside the others")
        if self._order and self._order in before and not self._shift:
            self._shift = self._day - before[self._order]
        self._day_text, self._day = text, orders[self._order or next(iter(orders))] + self._shift
        return self._day


def _of_day_s(time: str, half: str | None) -> int:
    *hours, minutes, seconds = map(int, time.rstrip(":").split(":"))
    hour = hours[0] if hours else 0
    if half:
        hour = hour % 12 + (12 if half in "pP" else 0)
    if minutes > 59 or seconds > 60:
        raise ValueError(f"{time!r} is no time")
    return HOUR_S * hour + 60 * minutes + seconds


def _days_of(text: str) -> dict[str, int]:
    """Days since 1970 of a date, by the possible orders of month and day."""
    words = [word for word in re.split(r"[-/., ]+", text) if word]
    numbers = [int(word) for word in words if word.isdigit()]
    if len(numbers) == 2:
        name = next(word for word in words if not word.isdigit())[:3].lower()
        if name not in MONTHS:
            raise ValueError(f"{text!r}: the month is not written in English")
        return {"": _day(numbers[1], MONTHS.index(name) + 1, numbers[0])}
    if len(words[0]) == 4:
        return {"": _day(*numbers)}
    year = numbers[2] + (2000 if numbers[2] < 100 else 0)
    possible = {"dmy": ORDERS["dmy"]} if "." in text else ORDERS
    days = {
        order: _day(year, numbers[month], numbers[day])
        for order, (month, day) in possible.items()
        if 1 <= numbers[month] <= 12
    }
    if not days:
        raise ValueError(f"{text!r} is no date")
    return days


def _day(year: int, month: int, day: int) -> int:
    return date(year, month, day).toordinal() - date(1970, 1, 1).toordinal()


def _zone_s(zone: str | None) -> int:
    if not zone or zone[0] not in "+-":
        return 0
    offset_s = int(zone[1:3]) * HOUR_S + int(zone[3:].lstrip(":") or 0) * 60
    return offset_s if zone[0] == "+" else -offset_s


def _part_of(text: str) -> float:
    match = DECIMAL.fullmatch(text.strip())
    return float(f"0.{match[2]}") if match else 0.0


def _finite(text: str) -> float:
    value = float(text)
    if not isfinite(value):
        raise ValueError(f"{text!r} is no time")
    return value


def _backward(t_s: Sequence[float]) -> int:
    """Number of steps back."""
    return sum(map(gt, t_s, islice(t_s, 1, None)))
