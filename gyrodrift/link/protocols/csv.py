"""The csv protocol: text lines `t_us,rate_dps[,encoder_deg[,temp_c[,still]]]`, as a hobby sketch prints them.

With three axes: `t_us,gx,gy,gz,ax,ay,az[,encoder_deg[,temp_c[,still]]]`, in deg/s and m/s². The number of columns tells
them apart.
"""

import re
from collections.abc import Sequence
from math import isfinite

from gyrodrift.columns.csv_line import LEAST_AXES, csv_reading
from gyrodrift.link.protocols.lines import LineDecoder
from gyrodrift.link.protocols.plausible import MAX_CSV_DPS
from gyrodrift.link.protocols.protocol import WireProtocol
from gyrodrift.values.sample import Reading

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
    """Decoder of lines with two to five columns, or seven to ten with three axes.

    heeds_header
        Whether lines below a header that names other columns are no csv; it does not count if the user asks for csv.
    """

    name = "csv"

    def __init__(self, *, heeds_header: bool = True) -> None:
        super().__init__()
        self._heeds_header = heeds_header
        self._other_columns = 0
        self._has_begun = False

    def parse(self, text: bytes) -> tuple[int, Reading] | None:
        """Number of columns and reading of a line; None if a header before the first line names something else.

        A later header, of a device that boots again, comes too late: the numbers are judged by their shape then.
        """
        if self._heeds_header and not self._has_begun and text[:1].isalpha():
            names = text.decode(errors="replace").split(",")
            if len(names) > 1 and ":" not in names[0]:
                self._other_columns = len(names) if _names_another(names) else 0
                return None
        parsed = None if text.count(b",") + 1 == self._other_columns else _parsed(text)
        self._has_begun = self._has_begun or parsed is not None
        return parsed


def _names_another(names: Sequence[str]) -> bool:
    """Whether a header names a clock, and other columns than those of csv; a message names no clock."""
    from gyrodrift.columns.names import kind_of  # noqa: PLC0415 - few streams have a header
    from gyrodrift.columns.units import unit_in, unit_of  # noqa: PLC0415 - as above

    rate, clock = names[3 if len(names) >= LEAST_AXES else 1], unit_in(names[0]) or unit_of(names[0])
    unit = unit_in(rate)
    is_rate = kind_of(rate) in {"rate", "rates"} and unit is not None and unit.option == "dps"
    return kind_of(names[0]) == "clock" and (not is_rate or (clock is not None and clock.option != "t_us"))


def _parsed(text: bytes) -> tuple[int, Reading] | None:
    """Number of columns and reading of a line; None without a rate, or without three finite ones."""
    match = LINE.fullmatch(text) or AXES_LINE.fullmatch(text)
    if match is None:
        return None
    t_us, *values = (group for group in match.groups() if group is not None)
    reading = csv_reading(int(t_us), [float(value) for value in values])
    if isfinite(reading.rate_dps) and abs(reading.rate_dps) > MAX_CSV_DPS:
        return None
    has_rates = reading.inertial is None or all(abs(rate_dps) <= MAX_CSV_DPS for rate_dps in reading.inertial[:3])
    return (1 + len(values), reading) if has_rates else None


def is_plausible(readings: Sequence[Reading]) -> bool:
    """Whether lines have the shape of csv; loaded on demand, because most devices use another protocol."""
    from gyrodrift.columns.shape import has_csv_shape  # noqa: PLC0415 - loaded on demand

    return has_csv_shape(readings)


PROTOCOL = WireProtocol(
    "csv",
    "lines t_us,rate_dps[,encoder_deg[,temp_c[,still]]], or t_us,gx,gy,gz,ax,ay,az[,...]",
    CsvDecoder,
    asked_decoder=lambda: CsvDecoder(heeds_header=False),
    has_clock=True,
    rank=10,
    is_plausible=is_plausible,
)
