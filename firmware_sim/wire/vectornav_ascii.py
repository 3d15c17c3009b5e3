"""VectorNav ASCII output: `$VNIMU`, whose rates are in rad/s; it has no clock, and no encoder."""

from collections.abc import Iterable, Iterator
from math import isfinite, isnan, radians

from firmware_sim.measure import Block
from firmware_sim.rig import Base
from firmware_sim.wire.encoder import Axes, Frame, Measurement, Vector, WireEncoder, axes_of, level
from firmware_sim.wire.nmea import LINE_END, sentence

FIELD = "+00.2400,+00.0100,+00.4500"


def vnimu(rate_dps: float, temp_c: float, axes: Axes | None = None) -> bytes:
    """Magnetic field, acceleration, rates, temperature and pressure; its z axis points down.

    Without axes, and with a missing acceleration, the device is level.
    """
    rates_dps, forces_mps2 = axes or level(rate_dps)
    if not all(map(isfinite, forces_mps2)):
        forces_mps2 = level(rate_dps).accel_mps2
    forces = ",".join(f"{round(force, 3) + 0.0:+07.3f}" for force in _z_down(forces_mps2))
    rates = ",".join(f"{round(radians(dps), 6) + 0.0:+010.6f}" for dps in _z_down(rates_dps))
    return sentence(f"VNIMU,{FIELD},{forces},{rates},{temp_c:+05.1f},+101.325")


def _z_down(vector: Vector) -> Vector:
    x, y, z = vector
    return x, -y, -z


def frames(blocks: Iterable[Block], base: Base) -> Iterator[Frame]:
    """A message per measurement."""
    for block in blocks:
        for row, axes in zip(block.rows(), axes_of(block, base), strict=True):
            _, _, t_host_s, rate_raw, _, temp_centi_c, *_ = row
            yield Frame(t_host_s, vnimu(rate_raw * base.dps_per_lsb, temp_centi_c / 100.0, axes), 1, LINE_END)


def recorded(measurements: Iterable[Measurement], _base: Base) -> Iterator[Frame]:
    """Frames of recorded samples; rates that are not finite are skipped."""
    for m in measurements:
        if m.is_finite:
            temp_c = m.temp_c if m.temp_c is not None and not isnan(m.temp_c) else 0.0
            yield Frame(m.due_s, vnimu(m.rate_dps, temp_c, m.axes), 1, LINE_END)


ENCODER = WireEncoder("vectornav-ascii", frames, recorded)
