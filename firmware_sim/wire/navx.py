"""The yaw messages of a navX: `!y`, four angles without separators, a sum; it has no clock, and no encoder."""

from collections.abc import Iterable, Iterator
from math import isfinite

from firmware_sim.measure import Block
from firmware_sim.rig import Base
from firmware_sim.wire.encoder import Frame, Measurement, WireEncoder

LINE_END = b"\r\n"
MOST_DPS = 1e6
"""Largest rate that is played, far beyond the range of a gyro, so that no sum is infinite."""

Rated = tuple[float, float]
"""Arrival, s, and rate, deg/s."""


def yaw_message(yaw_deg: float) -> bytes:
    """Message with clockwise yaw in hundredths of a degree; other angles are 0."""
    clockwise = (-round(yaw_deg * 100.0) + 18_000) % 36_000 - 18_000
    content = b"!y%b+000.00+000.00+000.00" % f"{clockwise / 100.0:+07.2f}".encode("ascii")
    return content + b"%02X" % (sum(content) & 0xFF) + LINE_END


def _spoken(rated: Iterable[Rated]) -> Iterator[Frame]:
    """Yaw after every measurement."""
    yaw_deg, before_s = 0.0, None
    for t_s, rate_dps in rated:
        step_s = 0.0 if before_s is None else t_s - before_s
        yaw_deg += max(-MOST_DPS, min(MOST_DPS, rate_dps)) * step_s
        before_s = t_s
        yield Frame(t_s, yaw_message(yaw_deg), 1, LINE_END)


def frames(blocks: Iterable[Block], base: Base) -> Iterator[Frame]:
    """A message per measurement."""
    rows = (row for block in blocks for row in block.rows())
    return _spoken((t_host_s, rate_raw * base.dps_per_lsb) for _, _, t_host_s, rate_raw, *_ in rows)


def recorded(measurements: Iterable[Measurement], _base: Base) -> Iterator[Frame]:
    """Frames of recorded samples; rates that are not finite are skipped."""
    return _spoken((m.due_s, m.rate_dps) for m in measurements if isfinite(m.rate_dps))


ENCODER = WireEncoder("navx", frames, recorded)
