"""Units as boards, libraries and tables write them: `gz (rad/s)`, `wz [°/s]`, `1.2 deg/s`, `accel_m_s2`, `time_us`."""

import re
from dataclasses import dataclass
from enum import StrEnum
from functools import lru_cache

from gyrodrift.columns.spec import CLOCK_US, RATE_DPS


class Dimension(StrEnum):
    """Dimension of a unit."""

    RATE = "rate"
    ANGLE = "angle"
    ACCELERATION = "acceleration"
    TIME = "time"
    TEMPERATURE = "temperature"
    FREQUENCY = "frequency"
    FIELD = "magnetic field"
    PRESSURE = "pressure"
    VOLTAGE = "voltage"
    SHARE = "share"
    LENGTH = "length"
    COUNTS = "counts"


@dataclass(frozen=True, slots=True)
class Unit:
    """Unit of a dimension.

    option
        Name in a SPEC: `rads` of a rate, `t_us` of a time; empty without one.
    """

    dimension: Dimension
    option: str = ""


def _units(dimension: Dimension, **spellings: str) -> dict[str, Unit]:
    """Units by spelling; the names of the keywords are options, with `per_N` for lsb/N."""
    named = {option.replace("per_", "lsb/").replace("_", "."): words for option, words in spellings.items()}
    return {
        word: Unit(dimension, "" if option == "other" else option)
        for option, words in named.items()
        for word in words.split()
    }


TIMES = {
    word: Unit(Dimension.TIME, option)
    for option, words in {
        "t:days": "day days",
        "t:lsb/0.000277777778": "h hour hours",
        "t:min": "min mins minute minutes",
        "t_s": "s sec secs",
        "t_ms": "ms msec msecs millis millisecond milliseconds",
        "t_us": "us usec usecs micros microsecond microseconds",
        "t_ns": "ns nsec nsecs nanos nanosecond nanoseconds nanosec",
    }.items()
    for word in words.split()
}
SPELLINGS: dict[str, Unit] = {
    **_units(
        Dimension.RATE,
        dps="dps deg/s degs-1 deg.s-1 d/s degps",
        mdps="mdps mdeg/s millideg/s millidps",
        rads="rad/s rads rads-1 rad.s-1 radps",
        mrads="mrad/s mrads millirad/s",
        per_60="deg/min dpm",
        per_1_11111111="gon/s",
        per_3600="deg/h deg/hr deg/hour dph",
        per_0_166667="rpm rev/min r/min",
    ),
    **_units(Dimension.ANGLE, deg="deg degs", rad="rad"),
    **_units(
        Dimension.ACCELERATION,
        mps2="m/s2 m/s/s ms-2 m.s-2 mps2 m/s^2",
        g="g gs gee",
        mg="mg millig",
    ),
    **TIMES,
    **_units(Dimension.TEMPERATURE, other="degc c celsius degf f fahrenheit kelvin"),
    **_units(Dimension.FREQUENCY, other="hz khz mhz fps sps"),
    **_units(Dimension.FIELD, other="ut mt nt tesla gauss milligauss microtesla"),
    **_units(Dimension.PRESSURE, other="pa hpa kpa mbar bar inhg mmhg"),
    **_units(Dimension.VOLTAGE, other="v mv volt volts ma amp amps"),
    **_units(Dimension.SHARE, other="% percent ppm"),
    **_units(Dimension.LENGTH, other="m mm cm km ft m/s km/h mph kn knots"),
    **_units(Dimension.COUNTS, other="lsb lsbs count counts raw adc"),
}
"""Units by the normalized spelling of `_plain`."""

MIXED_CASE = {"mG": Unit(Dimension.FIELD), "MHz": Unit(Dimension.FREQUENCY), "mT": Unit(Dimension.FIELD)}
"""Spellings whose case matters: mg is an acceleration, mG a magnetic field."""

AMBIGUOUS = {"G"}
"""Spellings with two meanings: gauss or gravity."""

TURNS_OR_RADIANS = re.compile(r"\brps\b", re.IGNORECASE)
"""Unit of a label that says revolutions or radians per second, which differ by 6.3."""

FACTOR = re.compile(r"[x×]?\s?(\d{1,9}(?:\.\d{1,9})?(?:[eE]-?\d{1,2})?)\s?[*·×]?\s?(?=[^\d\s])")
"""Number before a unit: `0.1 deg/s`."""

REPLACED = tuple(
    (re.compile(pattern), text)
    for pattern, text in (
        (r"µ|μ", "u"),
        (r"º|˚", "°"),
        (r"²", "2"),
        (r"⁻¹|\^-1|\*\*-1", "-1"),
        (r"\^2|\*\*2", "2"),
        (r"radians?", "rad"),
        (r"degrees?|°", "deg"),
        (r"(?<=[a-z\d\s/._-])(?:sec(?:ond)?s?|seg|sek)\b|^sec(?:ond)?s?$", "s"),
        (r"minutes?", "min"),
        (r"\s{0,8}\bper\b\s*+|_per_|\s{0,8}/\s*+", "/"),
        (r"[·⋅*]", "."),
        (r"\s+", ""),
    )
)
REMEMBERED = 256
"""Size of the cache: a stream repeats a few words in every line."""

LONGEST = 40
"""Largest number of characters of a unit or a label that are read."""

REPEATED = re.compile(r"(?<=[A-Za-z)\]])\.[1-9]\d?$")
"""Number that pandas appends to a label that comes again: `gz_dps.1`."""

AXES = {"x", "y", "z"}
BRACKETED = re.compile(r"[(\[{<]([^()\[\]{}<>]{1,40})[)\]}>]")
TAILS = re.compile(r"[\s_,;|-]+")


@lru_cache(maxsize=REMEMBERED)
def unit_of(text: str) -> Unit | None:
    """Unit of a text such as `rad/s`, `°/s` or `m/s^2`; None if it is not a unit."""
    word = text.strip(" .,;:")
    if not word or len(word) > LONGEST or word in AMBIGUOUS:
        return None
    return MIXED_CASE.get(word) or SPELLINGS.get(_plain(word))


def unit_in(label: str) -> Unit | None:
    """Unit in a label, in brackets or as its last words: `Gyro Z (rad/s)`, `gyro_z_rad_s`, `time us`."""
    label = REPEATED.sub("", label.strip()[:LONGEST])
    for bracketed in BRACKETED.findall(label):
        if unit := unit_of(bracketed) or _scaled(bracketed):
            return unit
    if unit := _time_in_path(label):
        return unit
    words = [word for word in TAILS.split(BRACKETED.sub(" ", label)) if word and word.lower() != "per"]
    if len(words) > 1 and words[-1].lower() in AXES:
        words.pop()
    if len(words) > 2 and (unit := unit_of("/".join(words[-2:]))):  # rad_s, m_s2
        return unit
    if len(words) > 1 and len(words[-1]) > 1:
        return unit_of(words[-1]) or _scaled(words[-1])
    return _short_tail(words)


def _time_in_path(label: str) -> Unit | None:
    """Unit of time at the end of a path: `header.stamp.nsecs`."""
    path, _, name = label.rpartition(".")
    unit = unit_of(name) if path else None
    return unit if unit is not None and unit.dimension is Dimension.TIME else None


def _scaled(text: str) -> Unit | None:
    """Unit of a rate or a time with a factor, such as `0.1 deg/s` or `25us`, as counts; None for other texts."""
    factor = FACTOR.match(text)
    unit = unit_of(text[factor.end() :]) if factor else None
    if factor is None or unit is None or not float(factor[1]):
        return None
    if unit.option in CLOCK_US:
        return Unit(Dimension.TIME, f"t:lsb/{1e6 / (float(factor[1]) * CLOCK_US[unit.option]):.10g}")
    if unit.option not in RATE_DPS:
        return None
    return Unit(Dimension.RATE, f"lsb/{1.0 / (float(factor[1]) * RATE_DPS[unit.option]):.10g}")


def _short_tail(words: list[str]) -> Unit | None:
    """Unit of a single last letter, usually an axis: only s after a time counts."""
    is_time = len(words) > 1 and words[-1] == "s" and words[-2].lower() in {"t", "time", "timestamp", "stamp", "clock"}
    return SPELLINGS["s"] if is_time else None


def _plain(word: str) -> str:
    plain = word.lower()
    for pattern, text in REPLACED:
        plain = pattern.sub(text, plain)
    return plain


def without_unit(label: str) -> str:
    """Label without the unit of `unit_in`: `gyro_z_rad_s` is `gyro z`."""
    label = label.strip()[:LONGEST]
    named = BRACKETED.sub(lambda match: " " if unit_of(match[1]) or _scaled(match[1]) else match[0], label)
    name = " ".join(word for word in TAILS.split(named) if word)
    if _time_in_path(label):
        return label.rpartition(".")[0]
    if unit_in(label) is None or any(unit_of(text) or _scaled(text) for text in BRACKETED.findall(label)):
        return name
    words = [word for word in name.split() if word.lower() != "per"]
    is_pair = len(words) > 2 and unit_of("/".join(words[-2:])) is not None
    return " ".join(words[: -2 if is_pair else -1])
