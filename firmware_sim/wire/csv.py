"""The csv protocol: text lines of a hobby sketch."""

from collections.abc import Iterable, Iterator, Sequence
from math import floor, log10, nan

from firmware_sim.measure import Block, Row, TriaxialBlock
from firmware_sim.rig import Base
from firmware_sim.wire.encoder import Frame, Measurement, WireEncoder, axes_of, level

LINE_END = b"\r\n"
BANNER = b"# t_us,rate_dps,encoder_deg,temp_c" + LINE_END
AXES_BANNER = b"# t_us,gx,gy,gz,ax,ay,az,encoder_deg,temp_c" + LINE_END


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
    yield Frame(0.0, BANNER if base.three_axes is None else AXES_BANNER, 0, LINE_END)
    for block in blocks:
        lines = _axes_lines(block, base) if isinstance(block, TriaxialBlock) else _lines(block, base)
        for t_host_s, line in zip(block.t_host_s.tolist(), lines, strict=True):
            yield Frame(t_host_s, line, 1, LINE_END)


def _lines(block: Block, base: Base) -> Iterator[bytes]:
    rate_digits = _digits(base.dps_per_lsb)
    for row in block.rows():
        _, t_us, _, rate_raw, *_ = row
        yield csv_line(t_us, round(rate_raw * base.dps_per_lsb, rate_digits), *_optional(row, base))


def _axes_lines(block: Block, base: Base) -> Iterator[bytes]:
    """Lines of three axes; an acceleration that is missing is nan."""
    rate_digits = _digits(base.dps_per_lsb)
    force_digits = _digits(base.three_axes.mps2_per_lsb if base.three_axes and base.three_axes.mps2_per_lsb else 1.0)
    for row, axes in zip(block.rows(), axes_of(block, base), strict=True):
        gyro_dps, accel_mps2 = axes or level(0.0)
        rates = [round(rate_dps, rate_digits) for rate_dps in gyro_dps]
        yield axes_csv_line(row[1], rates, [round(a, force_digits) for a in accel_mps2], *_optional(row, base))


def _optional(row: Row, base: Base) -> tuple[float | None, float, float | None]:
    """Angle, temperature and rest of a measurement; None for a missing column."""
    _, _, _, _, _, temp_centi_c, counts, still = row
    deg_per_count = 360.0 / base.encoder_cpr if base.encoder_cpr else 0.0
    angle_deg = round(counts * deg_per_count, _digits(deg_per_count)) if deg_per_count else None
    return angle_deg, temp_centi_c / 100.0, None if still < 0 else float(still)


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
