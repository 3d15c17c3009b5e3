"""In which units a clock and a rate are printed: from the pace of the lines, from what is written, from the numbers."""

import re

from gyrodrift.columns.names import SeenColumn
from gyrodrift.columns.spec import CLOCK_US
from gyrodrift.link.text.behaviour import step_of
from gyrodrift.link.text.fields import is_whole

COUNTS_PER_DPS = 131
"""Of an MPU-6050 at ±250 deg/s, the most common of all (register map RM-MPU-6000A, 4.19)."""

SENSITIVITY = f"{COUNTS_PER_DPS} are 1 deg/s of an MPU-6050 at ±250 deg/s, put in those of your sensor"

UNIT_FACTOR = 6.0
"""How far a clock may be from the pace at which its lines come; its units are a factor of a thousand apart."""

MICROSECONDS_FROM = 400.0
"""Without a pace, a step of this and more is in µs (2.5 kHz), and a smaller one in ms (2.5 Hz)."""


def clock_unit(column: SeenColumn, lines_per_s: float | None) -> tuple[str, str]:
    """A key of CLOCK_US, and what speaks for it."""
    step = step_of(column.numbers) if len(column.numbers) > 1 else 0.0
    plain = re.sub(r"[^a-z]", "", column.label.lower())
    if lines_per_s and step > 0.0:
        offsets = {unit: step * scale * 1e-6 * lines_per_s for unit, scale in CLOCK_US.items()}
        unit = next((unit for unit, off in offsets.items() if 1.0 / UNIT_FACTOR < off < UNIT_FACTOR), "")
        if unit:
            return unit, f"grows by {step:g} with each line, and {lines_per_s:.3g} lines a second come"
    named = (
        ("t_ms", ("ms", "millis")),
        ("t_us", ("us", "micros")),
        ("t_ns", ("ns", "nanos")),
        ("t_s", ("sec", "seconds", "ts")),
    )
    for unit, endings in named:
        if plain.endswith(endings) and plain != "ts":
            return unit, f"is labelled {column.label}"
    if not all(map(is_whole, column.texts)) and step < 2.0:
        return "t_s", f"grows by {step:g} with each line"
    return ("t_us" if step >= MICROSECONDS_FROM else "t_ms"), f"grows by {step:g} with each line"


def rate_unit(column: SeenColumn, text: str) -> tuple[str, str]:
    """What `rate` says of its unit, and why."""
    label = column.label.lower()
    if milli := re.search(r"mdps|mrad/s|mrads", label) or re.search(r"\bmdps|\bmrad/s", text):
        return (":mdps", ", in mdps as it says") if milli[0] == "mdps" else (":mrads", ", in mrad/s as it says")
    if re.search(r"rad(ian)?s?\b|rads\b|rad/s", label) or (re.search(r"rad(ian)?s?/s|rad/sec", text)):
        return ":rads", ", in rad/s as it says"
    if re.search(r"dps|deg/s|°/s|deg/sec|degrees/s", f"{label} {text}"):
        return "", ", in deg/s as it says"
    distinct = len(set(column.texts))
    if all(map(is_whole, column.texts)) and distinct > 3 and max(map(abs, column.numbers)) > 3.0:
        return (
            f":lsb/{COUNTS_PER_DPS}",
            f", in whole numbers, so in counts; {SENSITIVITY}",
        )
    return "", ""
