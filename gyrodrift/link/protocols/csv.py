"""The csv protocol: text lines `t_us,rate_dps[,encoder_deg[,temp_c[,still]]]`, as a hobby sketch prints them.

With three axes: `t_us,gx,gy,gz,ax,ay,az[,encoder_deg[,temp_c[,still]]]`, in deg/s and m/s². The number of columns tells
them apart.
"""

import re
from collections.abc import Sequence
from itertools import pairwise
from math import hypot, isfinite, isnan, nan

from gyrodrift.columns.sizes import MEDIAN_ACCEL_MPS2, TEMPERATURES_C
from gyrodrift.link.protocols.lines import LineDecoder
from gyrodrift.link.protocols.plausible import MAX_RATE_DPS
from gyrodrift.link.protocols.protocol import WireProtocol
from gyrodrift.values.constants import CLOCK_MASK
from gyrodrift.values.sample import Inertial, Reading

NUMBER = rb"\s*+[-+]?+(?:\d++(?:\.\d*+)?+(?:[eE][-+]?+\d++)?+|\.\d++(?:[eE][-+]?+\d++)?+|nan|NaN|NAN|inf|INF)\s*+"
"""Possessive quantifiers: no backtracking, so a line of digits takes no longer than others."""

WORD = rb"\s*+(?:[01](?:\.0)?+|nan|NaN|NAN)\s*+"
"""Values of the last column: 1 at rest, 0 in motion, nan unknown."""

CLOCK = rb"\s*+(-?+\d{1,20}+)\s*+"
"""A clock with a sign is negative in the upper half of its 32 bits."""

OPTIONAL = rb"(?:,(%b))?+(?:,(%b)(?:,(%b))?+)?+" % (NUMBER, NUMBER, WORD)
LINE = re.compile(rb"%b,(%b)%b" % (CLOCK, NUMBER, OPTIONAL))
AXES_LINE = re.compile(CLOCK + rb",(%b)" % NUMBER * 6 + OPTIONAL)

JUDGED_LINES, JUDGED_S = 10, 1.0
"""Number of lines for a judgment, or their time for slow devices, s."""

ODD_SHARE = 0.1
"""Largest share of steps in which a clock stands still or goes back; other numbers have at least half.

A device may repeat a line or restart.
"""

ENCODER_STEPS = 3.0
"""Largest difference of an angle and its integrated rate, in steps; rounding causes less than two."""

ENCODER_SHARE = 0.5
"""Largest part of the angle that the rate does not explain; for another quantity it is nearly all."""


def is_plausible(readings: Sequence[Reading]) -> bool:
    """Whether the columns can be those of csv: a growing clock, a temperature, an angle that follows the rate.

    Two to five numbers with commas may also be raw counts, three axes, or an angle.
    """
    times_us = [reading.t_us or 0 for reading in readings]
    steps_us = [(after - before) & CLOCK_MASK for before, after in pairwise(times_us)]
    forward_us = [step_us for step_us in steps_us if 0 < step_us < CLOCK_MASK // 2]
    is_enough = len(readings) >= JUDGED_LINES or sum(forward_us) >= JUDGED_S * 1e6
    odd = len(steps_us) - len(forward_us)
    is_warm = all(TEMPERATURES_C[0] <= r.temp_c <= TEMPERATURES_C[1] for r in readings if not isnan(r.temp_c))
    is_clock = odd <= max(1.0, ODD_SHARE * len(steps_us))
    return is_enough and is_clock and is_warm and _follows_rate(readings) and _feels_gravity(readings)


def _feels_gravity(readings: Sequence[Reading]) -> bool:
    """Whether accelerations have the length of gravity; True without any, or while all are NaN."""
    sizes = [hypot(*reading.inertial[3:]) for reading in readings if reading.inertial]
    lengths = sorted(size for size in sizes if not isnan(size))
    return not lengths or MEDIAN_ACCEL_MPS2[0] < lengths[len(lengths) // 2] < MEDIAN_ACCEL_MPS2[1]


def _follows_rate(readings: Sequence[Reading]) -> bool:
    """Whether the encoder follows the integrated rate, at any scale; True without an encoder."""
    valid = [reading for reading in readings if not isnan(reading.encoder_deg) and isfinite(reading.rate_dps)]
    moved = [after.encoder_deg - before.encoder_deg for before, after in pairwise(valid)]
    turns = [
        0.5e-6 * (after.rate_dps + before.rate_dps) * (((after.t_us or 0) - (before.t_us or 0)) & CLOCK_MASK)
        for before, after in pairwise(valid)
    ]
    step_deg = min((abs(step) for step in moved if step), default=0.0)
    if not step_deg:
        return True
    squares = sum(angle * angle for angle in turns)
    scale = sum(a * b for a, b in zip(moved, turns, strict=True)) / squares if squares else 0.0
    apart = sorted(abs(a - scale * b) for a, b in zip(moved, turns, strict=True))
    usual = sorted(map(abs, moved))[len(moved) // 2]
    return apart[len(apart) // 2] <= max(ENCODER_STEPS * step_deg, ENCODER_SHARE * usual)


class CsvDecoder(LineDecoder):
    """Decoder of lines with two to five columns, or seven to ten with three axes."""

    name = "csv"

    def parse(self, text: bytes) -> tuple[int, Reading] | None:
        """Number of columns and reading of a line."""
        match = LINE.fullmatch(text)
        if match is None:
            return _with_axes(text)
        t_us, *values = (group for group in match.groups() if group is not None)
        rate_dps, *optional = (float(value) for value in values)
        if isfinite(rate_dps) and abs(rate_dps) > MAX_RATE_DPS:
            return None
        return 2 + len(optional), _reading(t_us, rate_dps, optional)


def _with_axes(text: bytes) -> tuple[int, Reading] | None:
    """Number of columns and reading of a line with three axes; None without three finite rates."""
    match = AXES_LINE.fullmatch(text)
    if match is None:
        return None
    t_us, *values = (group for group in match.groups() if group is not None)
    x_dps, y_dps, z_dps, *numbers = map(float, values)
    if not all(abs(rate_dps) <= MAX_RATE_DPS for rate_dps in (x_dps, y_dps, z_dps)):
        return None
    inertial = Inertial(x_dps, y_dps, z_dps, *(value if isfinite(value) else nan for value in numbers[:3]))
    return 1 + len(values), _reading(t_us, z_dps, numbers[3:], inertial)


def _reading(t_us: bytes, rate_dps: float, optional: Sequence[float], inertial: Inertial | None = None) -> Reading:
    """Reading with the optional columns; an infinite angle or temperature is missing."""
    valid = [value if isfinite(value) else nan for value in optional]
    encoder_deg, temp_c, still, *_ = [*valid, nan, nan, nan]
    return Reading(int(t_us) & CLOCK_MASK, None, rate_dps, encoder_deg, temp_c, still, nan, inertial)


PROTOCOL = WireProtocol(
    "csv",
    "lines t_us,rate_dps[,encoder_deg[,temp_c[,still]]], or t_us,gx,gy,gz,ax,ay,az[,...]",
    CsvDecoder,
    has_clock=True,
    rank=10,
    is_plausible=is_plausible,
)
