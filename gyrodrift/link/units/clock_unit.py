"""A device clock in another unit than it is taken for: found from the pace at which its samples arrive."""

import shlex

from gyrodrift.link.heard import Heard, quoted
from gyrodrift.link.protocols import text

SLOWEST_PACE = 100.0
"""Host seconds for one second of a device clock; no clock is so slow, and a replay only makes it faster."""

NEVER_PACE = 1e7
NAMED_WITHIN = 3.0
UNITS = {1e3: "milliseconds", 1e6: "seconds"}
CSV_COLUMNS = ("t_us", "rate:dps", "encoder", "temp", "still")
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
        return f"the first column {says}; {_columns(heard, unit)}"
    if protocol == text.NAME:
        named = f": write {SHORT[unit]} for t_us" if unit else ""
        return f"the clock of --columns {says}{named}; the lines are like {quoted((heard.lines() or [''])[-1])}"
    return f"the clock t_us of its samples {says}; the device has to send microseconds"


def _columns(heard: Heard, unit: str | None) -> str:
    """How lines of csv are read whose clock counts something else."""
    last = (heard.lines() or [""])[-1]
    if unit is None:
        return f"{quoted(last)} is to be read with --columns, which say what stands where"
    columns = (SHORT[unit], *CSV_COLUMNS[1:])[: last.count(",") + 1]
    return f"read {quoted(last)} with --columns {shlex.quote(', '.join(columns))}"
