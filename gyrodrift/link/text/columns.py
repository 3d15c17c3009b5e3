"""The columns of other people's text as a person writes them down: `t_ms, _, _, rate:lsb/131:-`."""

import re
from dataclasses import dataclass
from math import degrees

from gyrodrift.errors import UsageError
from gyrodrift.nearest import did_you_mean

IGNORED = "_"
CLOCK_US = {"t_us": 1.0, "t_ms": 1e3, "t_s": 1e6, "t_ns": 1e-3}
"""Microseconds in one unit of a clock."""

MEANINGS = (IGNORED, *CLOCK_US, "seq", "rate", "encoder", "temp", "still")
OTHER_NAMES = {"gz": "rate", "temp_c": "temp", "rate_dps": "rate", "encoder_deg": "encoder"}
RATE_DPS = {"dps": 1.0, "mdps": 1e-3, "rads": degrees(1.0), "mrads": degrees(1e-3)}
EXAMPLE = '--columns "t_ms, _, _, rate:lsb/131"'
EXPECTED = (
    f"expected one entry a column: {', '.join(MEANINGS)}; rate may say :dps, :mdps, :rads, :mrads or :lsb/N and :- for"
    f" the other sign, encoder :deg or :counts/N, as in {EXAMPLE}"
)
PER = re.compile(r"(lsb|counts)/(\d+(?:\.\d*)?)")


@dataclass(frozen=True, slots=True)
class Column:
    """What one column holds.

    meaning
        One of MEANINGS.
    scale
        What the number is multiplied by to get µs, deg/s or degrees, with its sign.
    label
        By which it is found in a line; empty where its place says it.
    """

    meaning: str
    scale: float = 1.0
    label: str = ""


def columns_of(spec: str) -> tuple[Column, ...]:
    """The columns of the option `--columns SPEC`.

    Raises
    ------
    UsageError
        With the entry that is wrong, and what is expected.
    """
    try:
        return parsed(spec)
    except ValueError as error:
        raise UsageError(f"--columns: {error}") from error


def parsed(spec: str) -> tuple[Column, ...]:
    """The columns of a SPEC.

    Raises
    ------
    ValueError
        With the entry that is wrong, and what is expected.
    """
    columns = tuple(_column(entry.strip()) for entry in spec.split(","))
    for meaning in MEANINGS[1:]:
        named = [column for column in columns if column.meaning == meaning]
        if len(named) > 1:
            raise ValueError(f"{spec!r}: {meaning} is given twice; call the other one {IGNORED}")
    if sum(column.meaning in CLOCK_US for column in columns) > 1:
        raise ValueError(f"{spec!r}: there are two clocks; call one of them {IGNORED}")
    if not any(column.meaning == "rate" for column in columns):
        raise ValueError(f"{spec!r}: no column is the rate; {EXPECTED}")
    if len({bool(column.label) for column in columns}) > 1:
        raise ValueError(f"{spec!r}: either all columns have a label (LABEL=rate), or none has")
    return columns


def _column(entry: str) -> Column:
    label, mark, said = entry.rpartition("=")
    name, *options = said.strip().split(":")
    meaning = OTHER_NAMES.get(name.strip(), name.strip())
    if meaning not in MEANINGS or (mark and not label.strip()):
        meant = f"{did_you_mean(name, [*MEANINGS, *OTHER_NAMES])} ".lstrip()
        raise ValueError(f"{entry!r} is no column; {meant}{EXPECTED}")
    return Column(meaning, _scale(entry, meaning, options), " ".join(label.split()))


def _scale(entry: str, meaning: str, options: list[str]) -> float:
    scale = CLOCK_US.get(meaning, 1.0)
    for option in (option.strip() for option in options):
        found = PER.fullmatch(option)
        per = float(found[2]) if found else 0.0
        if option == "-" and meaning in {"rate", "encoder"}:
            scale = -scale
        elif meaning == "rate" and option in RATE_DPS:
            scale *= RATE_DPS[option]
        elif meaning == "rate" and found and found[1] == "lsb" and per:
            scale /= per
        elif meaning == "encoder" and found and found[1] == "counts" and per:
            scale *= 360.0 / per
        elif not (meaning == "encoder" and option == "deg"):
            raise ValueError(f"{entry!r}: {option!r} is no unit of {meaning}; {EXPECTED}")
    return scale
