"""The csv protocol: text lines `t_us,rate_dps[,encoder_deg[,temp_c[,still]]]`, as a hobby sketch prints them."""

import re
from math import isfinite, nan

from gyrodrift.link.protocols.lines import MAX_RATE_DPS, LineDecoder
from gyrodrift.link.protocols.protocol import WireProtocol
from gyrodrift.sample import Reading

NUMBER = rb"\s*+[-+]?+(?:\d++(?:\.\d*+)?+(?:[eE][-+]?+\d++)?+|\.\d++(?:[eE][-+]?+\d++)?+|nan|NaN|NAN|inf|INF)\s*+"
"""Nothing is tried twice: a line of digits alone takes no longer than any other."""

WORD = rb"\s*+(?:[01](?:\.0)?+|nan|NaN|NAN)\s*+"
"""What may stand in the last column: 1 stands still, 0 moves, nan is not said."""

LINE = re.compile(rb"\s*+(\d{1,20}+)\s*+,(%b)(?:,(%b))?+(?:,(%b)(?:,(%b))?+)?+" % (NUMBER, NUMBER, NUMBER, WORD))


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
    "csv", "lines t_us,rate_dps[,encoder_deg[,temp_c[,still]]]", CsvDecoder, has_clock=True, rank=10
)
