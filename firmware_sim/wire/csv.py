"""The csv protocol: text lines of a hobby sketch."""

from collections.abc import Iterable, Iterator, Sequence
from math import floor, log10, nan

from firmware_sim.measure import Block
from firmware_sim.rig import Base
from firmware_sim.wire.encoder import Frame, Measurement, WireEncoder

LINE_END = b"\r\n"
BANNER = b"# t_us,rate_dps,encoder_deg,temp_c" + LINE_END


def csv_line(
    t_us: int, rate_dps: float, encoder_deg: float | None, temp_c: float | None, still: float | None = None
) -> bytes:
    """Line with the fewest digits that keep every number; a missing value before another one is nan."""
    values = [rate_dps, encoder_deg, temp_c, still]
    while values[-1] is None:
        values.pop()
    texts = ("nan" if value is None else repr(value) for value in values)
    return f"{t_us & 0xFFFFFFFF},{','.join(texts)}".encode() + LINE_END


def axes_csv_line(
    t_us: int,
    gyro_dps: Sequence[float],
    accel_mps2: Sequence[float] | None,
    encoder_deg: float | None = None,
    temp_c: float | None = None,
    still: float | None = None,
) -> bytes:
    """Line of three axes, rates before accelerations; a missing value is nan, and left out at the end."""
    values = [*gyro_dps, *(accel_mps2 or (nan, nan, nan)), encoder_deg, temp_c, still]
    while values[-1] is None:
        values.pop()
    texts = ("nan" if value is None else repr(value) for value in values)
    return f"{t_us & 0xFFFFFFFF},{','.join(texts)}".encode() + LINE_END


def frames(blocks: Iterable[Block], base: Base) -> Iterator[Frame]:
    """Banner, then a line per measurement."""
    yield Frame(0.0, BANNER, 0, LINE_END)
    deg_per_count = 360.0 / base.encoder_cpr if base.encoder_cpr else 0.0
    rate_digits, angle_digits = _digits(base.dps_per_lsb), _digits(deg_per_count or 1.0)
    for block in blocks:
        for _, t_us, t_host_s, rate_raw, _, temp_centi_c, counts, still in block.rows():
            angle_deg = round(counts * deg_per_count, angle_digits) if deg_per_count else None
            still_value = None if still < 0 else float(still)
            line = csv_line(
                t_us, round(rate_raw * base.dps_per_lsb, rate_digits), angle_deg, temp_centi_c / 100.0, still_value
            )
            yield Frame(t_host_s, line, 1, LINE_END)


def _digits(step: float) -> int:
    """Decimals that separate multiples of a step, plus one."""
    return max(4, 2 - floor(log10(step)))


def recorded(measurements: Iterable[Measurement], _base: Base) -> Iterator[Frame]:
    """A line per sample, with every digit."""
    for m in measurements:
        yield Frame(m.due_s, _recorded_line(m), 1, LINE_END)


def _recorded_line(m: Measurement) -> bytes:
    if m.gyro_dps is None:
        return csv_line(m.t_us, m.rate_dps, m.encoder_deg, m.temp_c, m.still)
    return axes_csv_line(m.t_us, m.gyro_dps, m.accel_mps2, m.encoder_deg, m.temp_c, m.still)


ENCODER = WireEncoder("csv", frames, recorded)
