"""The csv protocol: text lines `t_us,rate_dps[,encoder_deg[,temp_c[,still]]]`, as a hobby sketch prints them."""

import re
from collections.abc import Sequence
from itertools import pairwise
from math import isfinite, isnan, nan

from gyrodrift.columns.ranges import TEMPERATURES_C
from gyrodrift.link.protocols.lines import MAX_RATE_DPS, LineDecoder
from gyrodrift.link.protocols.protocol import WireProtocol
from gyrodrift.sample import Reading

NUMBER = rb"\s*+[-+]?+(?:\d++(?:\.\d*+)?+(?:[eE][-+]?+\d++)?+|\.\d++(?:[eE][-+]?+\d++)?+|nan|NaN|NAN|inf|INF)\s*+"
"""Nothing is tried twice: a line of digits alone takes no longer than any other."""

CLOCK_MASK = 0xFFFFFFFF
WORD = rb"\s*+(?:[01](?:\.0)?+|nan|NaN|NAN)\s*+"
"""What may stand in the last column: 1 stands still, 0 moves, nan is not said."""

LINE = re.compile(rb"\s*+(\d{1,20}+)\s*+,(%b)(?:,(%b))?+(?:,(%b)(?:,(%b))?+)?+" % (NUMBER, NUMBER, NUMBER, WORD))


JUDGED_LINES, JUDGED_S = 10, 1.0
"""So many lines are judged, or those of so long a time where they come slowly."""

ODD_SHARE = 0.1
"""Of its steps in which a clock stands still or goes back: a device may repeat a line or begin anew. Of other numbers
it is half, or nearly all."""

ENCODER_STEPS = 3.0
"""Rounding moves an angle by less than two of its steps beside its rate; beyond this it is no angle of that rate."""

ENCODER_SHARE = 0.5
"""Of its own usual motion: what a rate at the best scale leaves of another quantity is nearly all of it."""


def is_plausible(readings: Sequence[Reading]) -> bool:
    """Whether the columns can be what csv says: a clock that grows, a temperature, an angle that the rate adds up to.

    Two to five numbers with commas between them may be anything: raw counts, three axes, an angle.
    """
    times_us = [reading.t_us or 0 for reading in readings]
    steps_us = [(after - before) & CLOCK_MASK for before, after in pairwise(times_us)]
    is_enough = len(readings) >= JUDGED_LINES or sum(steps_us) >= JUDGED_S * 1e6
    odd = sum(not 0 < step_us < CLOCK_MASK // 2 for step_us in steps_us)
    is_warm = all(TEMPERATURES_C[0] <= r.temp_c <= TEMPERATURES_C[1] for r in readings if not isnan(r.temp_c))
    return is_enough and odd <= max(1.0, ODD_SHARE * len(steps_us)) and is_warm and _is_turned_by(readings)


def _is_turned_by(readings: Sequence[Reading]) -> bool:
    """Whether the encoder goes where the rate does, at any scale, to its own steps; true without one."""
    known = [reading for reading in readings if not isnan(reading.encoder_deg) and isfinite(reading.rate_dps)]
    moved = [after.encoder_deg - before.encoder_deg for before, after in pairwise(known)]
    turned = [
        0.5e-6 * (after.rate_dps + before.rate_dps) * (((after.t_us or 0) - (before.t_us or 0)) & CLOCK_MASK)
        for before, after in pairwise(known)
    ]
    step_deg = min((abs(step) for step in moved if step), default=0.0)
    if not step_deg:
        return True
    squares = sum(angle * angle for angle in turned)
    scale = sum(a * b for a, b in zip(moved, turned, strict=True)) / squares if squares else 0.0
    apart = sorted(abs(a - scale * b) for a, b in zip(moved, turned, strict=True))
    usual = sorted(map(abs, moved))[len(moved) // 2]
    return apart[len(apart) // 2] <= max(ENCODER_STEPS * step_deg, ENCODER_SHARE * usual)


class CsvDecoder(LineDecoder):
    """Lines of two to five columns."""

    name = "csv"

    def parse(self, text: bytes) -> tuple[int, Reading] | None:
        """One line."""
        match = LINE.fullmatch(text)
        if match is None:
            return None
        t_us, *values = (group for group in match.groups() if group is not None)
        rate_dps, *others = (float(value) for value in values)
        if isfinite(rate_dps) and abs(rate_dps) > MAX_RATE_DPS:
            return None
        known = (value if isfinite(value) else nan for value in others)  # an angle or temperature without end is none
        return 2 + len(others), Reading(int(t_us) & 0xFFFFFFFF, None, rate_dps, *known)


PROTOCOL = WireProtocol(
    "csv",
    "lines t_us,rate_dps[,encoder_deg[,temp_c[,still]]]",
    CsvDecoder,
    has_clock=True,
    rank=10,
    is_plausible=is_plausible,
)
