"""The csv protocol: text lines `t_us,rate_dps[,encoder_deg[,temp_c[,still]]]`, as a hobby sketch prints them.

With three axes: `t_us,gx,gy,gz,ax,ay,az[,encoder_deg[,temp_c[,still]]]`, in deg/s and m/s². The number of columns tells
them apart.
"""

import re
from collections.abc import Sequence
from math import isfinite, nan

from gyrodrift.columns.shape import has_csv_shape
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
    is_plausible=has_csv_shape,
)
