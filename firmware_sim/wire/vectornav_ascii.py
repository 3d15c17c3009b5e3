"""VectorNav ASCII output: `$VNIMU`, whose rates are in rad/s; it has no clock, and no encoder."""

from collections.abc import Iterable, Iterator
from math import isfinite, isnan, radians

from firmware_sim.measure import Block
from firmware_sim.rig import Base
from firmware_sim.wire.encoder import Frame, Measurement, WireEncoder
from firmware_sim.wire.nmea import LINE_END, sentence

FIELD = "+00.2400,+00.0100,+00.4500"
LEVEL = "+00.000,+00.000,-09.807"


def vnimu(rate_dps: float, temp_c: float) -> bytes:
    """Magnetic field, acceleration, rates, temperature and pressure of a level device; its z axis points down."""
    rate_rads = round(-radians(rate_dps), 6) + 0.0
    return sentence(f"VNIMU,{FIELD},{LEVEL},+00.000000,+00.000000,{rate_rads:+010.6f},{temp_c:+05.1f},+101.325")


def frames(blocks: Iterable[Block], base: Base) -> Iterator[Frame]:
    """A message per measurement."""
    for block in blocks:
        for _, _, t_host_s, rate_raw, _, temp_centi_c, *_ in block.rows():
            yield Frame(t_host_s, vnimu(rate_raw * base.dps_per_lsb, temp_centi_c / 100.0), 1, LINE_END)


def recorded(measurements: Iterable[Measurement], _base: Base) -> Iterator[Frame]:
    """Frames of recorded samples; rates that are not finite are skipped."""
    for m in measurements:
        if isfinite(m.rate_dps):
            temp_c = m.temp_c if m.temp_c is not None and not isnan(m.temp_c) else 0.0
            yield Frame(m.due_s, vnimu(m.rate_dps, temp_c), 1, LINE_END)


ENCODER = WireEncoder("vectornav-ascii", frames, recorded)
