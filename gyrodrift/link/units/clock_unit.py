"""A device clock in another unit than it is taken for: found from the pace at which its samples arrive."""

import shlex

from gyrodrift.link.heard import Heard, quoted
from gyrodrift.link.protocols import text

SLOWEST_PACE = 100.0
"""Host seconds for one second of a device clock; no clock is so slow, and a replay only makes it faster."""

NEVER_PACE = 1e7
NAMED_WITHIN = 3.0
UNITS = {1e3: "milliseconds", 1e6: "seconds"}
CSV_COLUMNS = ("t_us", "rate", "encoder", "temp")
SHORT = {"milliseconds": "t_ms", "seconds": "t_s"}


def why_wrong(pace: float, protocol: str, heard: Heard) -> str | None:
    """What to tell a person whose device clock is none; None where it may be one.

    `pace` is host seconds for one second of the device clock, infinite where it does not run at all.
    """
    if pace < SLOWEST_PACE:
        return None
    unit = next((unit for per, unit in UNITS.items() if per / NAMED_WITHIN < pace < per * NAMED_WITHIN), None)
    took = f"1 s of it takes {pace:.3g} s" if pace < NEVER_PACE else "its steps are none of a clock"
    says = f"counts {unit}, not microseconds" if unit else f"is no clock in microseconds: {took}"
    if protocol == "csv":
        return f"the first column {says}; {_columns(heard)}"
    if protocol == text.NAME:
        named = f": write {SHORT[unit]} for t_us" if unit else ""
        return f"the clock of --columns {says}{named}; the lines are like {quoted((heard.lines() or [''])[-1])}"
    return f"the clock t_us of its samples {says}; the device has to send microseconds"


def _columns(heard: Heard) -> str:
    from gyrodrift.link.text.guess import guess  # noqa: PLC0415 - only a stream that is refused needs it

    lines = heard.lines()
    guessed = guess(lines, heard.lines_per_s)
    if guessed is None or guessed.spec is None:
        return f"{quoted((lines or [''])[-1])} is to be read with --columns, such as --columns 't_ms, rate'"
    said, spec = [column.said for column in guessed.columns], guessed.spec
    entries = spec.split(", ")
    if len(said) <= len(CSV_COLUMNS) and entries[1:2] and entries[1].startswith("rate"):  # csv but for its clock
        said[2:] = CSV_COLUMNS[2 : len(said)]
        spec = ", ".join((*entries[:2], *said[2:]))
    return f"{quoted(guessed.example)} looks like {', '.join(said)}; read it with --columns {shlex.quote(spec)}"
