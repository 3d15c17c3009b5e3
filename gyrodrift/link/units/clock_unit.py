"""Unit of a device clock, from the arrival of its samples."""

import shlex

from gyrodrift.link.heard import Heard, quoted
from gyrodrift.link.protocols import text

SLOWEST_PACE = 100.0
"""Host seconds per second of a device clock: no real clock is that slow, and a replay is faster."""

NEVER_PACE = 1e7
NAMED_WITHIN = 3.0
UNITS = {1e3: "milliseconds", 1e6: "seconds"}
CSV_COLUMNS = ("t_us", "rate:dps", "encoder", "temp", "still")
SHORT = {"milliseconds": "t_ms", "seconds": "t_s"}


def why_wrong(pace: float, protocol: str, heard: Heard) -> str | None:
    """Message about a clock in another unit; None if it may be correct.

    `pace` is host seconds per second of the device clock, infinite if it does not run.
    """
    if pace < SLOWEST_PACE:
        return None
    unit = next((unit for per, unit in UNITS.items() if per / NAMED_WITHIN < pace < per * NAMED_WITHIN), None)
    took = f"1 s of it takes {pace:.3g} s" if pace < NEVER_PACE else "its steps are not those of a clock"
    says = f"counts {unit}, not microseconds" if unit else f"does not count microseconds: {took}"
    if protocol == "csv":
        return f"the first column {says}; {_columns(heard, unit)}"
    if protocol == text.NAME:
        named = f": write {SHORT[unit]} instead of t_us" if unit else ""
        return f"the clock of --columns {says}{named}; the lines are like {quoted((heard.lines() or [''])[-1])}"
    return f"the clock t_us of its samples {says}; the device must send microseconds"


def _columns(heard: Heard, unit: str | None) -> str:
    """Advice for csv lines with another clock."""
    last = (heard.lines() or [""])[-1]
    if unit is None:
        return f"name the columns of {quoted(last)} with --columns"
    columns = (SHORT[unit], *CSV_COLUMNS[1:])[: last.count(",") + 1]
    return f"read {quoted(last)} with --columns {shlex.quote(', '.join(columns))}"
