"""NMEA 0183: the rate of turn of a heading sensor, `$HEROT`, in deg/min; it has no clock, and no encoder."""

from collections.abc import Iterable, Iterator
from functools import reduce
from math import isfinite
from operator import xor

from firmware_sim.measure import Block
from firmware_sim.rig import Base
from firmware_sim.wire.encoder import Frame, Measurement, WireEncoder

LINE_END = b"\r\n"


def sentence(body: str) -> bytes:
    """`$`, the body, and the exclusive or of its characters as two hexadecimal digits."""
    content = body.encode("ascii")
    return b"$%b*%02X" % (content, reduce(xor, content, 0)) + LINE_END


def rate_of_turn(rate_dps: float, status: str = "A") -> bytes:
    """Rate of turn in hundredths of a deg/min, negative to port (counter-clockwise)."""
    return sentence(f"HEROT,{round(-60.0 * rate_dps, 2) + 0.0:.2f},{status}")


def frames(blocks: Iterable[Block], base: Base) -> Iterator[Frame]:
    """A sentence per measurement."""
    for block in blocks:
        for _, _, t_host_s, rate_raw, *_ in block.rows():
            yield Frame(t_host_s, rate_of_turn(rate_raw * base.dps_per_lsb), 1, LINE_END)


def recorded(measurements: Iterable[Measurement], _base: Base) -> Iterator[Frame]:
    """Frames of recorded samples; rates that are not finite are skipped."""
    for m in measurements:
        if isfinite(m.rate_dps):
            yield Frame(m.due_s, rate_of_turn(m.rate_dps), 1, LINE_END)


ENCODER = WireEncoder("nmea", frames, recorded)
