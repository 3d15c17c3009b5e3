"""Points of the page: 30 a second with minimum and maximum, for one hour.

Points are merged by minimum and maximum, so a spike of one sample stays visible at any sample rate. Points of a device
with three axes, or with its own yaw, have further values.
"""

from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import chain
from math import nan
from struct import Struct
from typing import NamedTuple

from gyrodrift.values.sample import Corrected

POINTS_HZ = 30.0
"""Points, and messages, per second."""

Value = Callable[[Corrected], float]

SPANS: dict[str, Value] = {
    "yaw_deg": lambda c: c.yaw_deg,
    "raw_yaw_deg": lambda c: c.raw_yaw_deg,
    "encoder_deg": lambda c: c.reference_deg,
    "error_deg": lambda c: c.yaw_deg - c.reference_deg,
    "rate_dps": lambda c: c.sample.rate_dps,
    "rest_probability": lambda c: c.rest_probability,
}
"""Values with minimum and maximum, `NAME_lo` and `NAME_hi` of a point."""

LASTS: dict[str, Value] = {
    "yaw_deg": lambda c: c.yaw_deg,
    "raw_yaw_deg": lambda c: c.raw_yaw_deg,
    "encoder_deg": lambda c: c.reference_deg,
    "rate_dps": lambda c: c.sample.rate_dps,
    "corrected_dps": lambda c: c.corrected_dps,
    "yaw_sigma_deg": lambda c: c.yaw_sigma_deg,
    "bias_dps": lambda c: c.bias_dps,
    "bias_sigma_dps": lambda c: c.bias_sigma_dps,
    "rest_probability": lambda c: c.rest_probability,
    "heading_deg": lambda c: c.heading_deg,
    "temp_c": lambda c: c.sample.temp_c,
}
"""Values of the last sample of a point."""

TILT_SPANS: dict[str, Value] = {
    "roll_deg": lambda c: nan if c.attitude is None else c.attitude.roll_deg,
    "pitch_deg": lambda c: nan if c.attitude is None else c.attitude.pitch_deg,
}
"""Further values of a device with three axes, with minimum and maximum."""

TILT_LASTS: dict[str, Value] = {
    **TILT_SPANS,
    "tilt_deg": lambda c: nan if c.attitude is None else c.attitude.tilt_deg,
    "tilt_sigma_deg": lambda c: nan if c.attitude is None else c.attitude.tilt_sigma_deg,
}
"""Further values of the last sample."""


DEVICE_SPANS: dict[str, Value] = {"device_difference_deg": lambda c: c.device_difference_deg}
"""Further values of a device that runs a filter itself, with minimum and maximum."""

DEVICE_LASTS: dict[str, Value] = {
    **DEVICE_SPANS,
    "device_yaw_deg": lambda c: nan if c.sample.device_yaw is None else c.sample.device_yaw.yaw_deg,
    "device_yaw_sigma_deg": lambda c: nan if c.sample.device_yaw is None else c.sample.device_yaw.yaw_sigma_deg,
}
"""Further values of the last sample; NaN if that one has no result of the device."""


class Point(NamedTuple):
    """Consecutive samples.

    t_s
        Unix time of arrival of the last sample, s.
    last, lo, hi
        Values in the order of the layout; NaN if unknown.
    """

    t_s: float
    last: tuple[float, ...]
    lo: tuple[float, ...]
    hi: tuple[float, ...]


class PointLayout:
    """Values of the points of a stream.

    columns
        Columns of a sent point; `t_s` is the Unix time of arrival of its last sample, s.
    record
        Time in double, other columns in single precision, little-endian.
    """

    def __init__(self, spans: Mapping[str, Value], lasts: Mapping[str, Value]) -> None:
        self._spans, self._lasts = tuple(spans.values()), tuple(lasts.values())
        self.columns = ("t_s", *lasts, *(f"{name}_lo" for name in spans), *(f"{name}_hi" for name in spans))
        self.record = Struct(f"<d{len(self.columns) - 1}f")

    def point_of(self, samples: Sequence[Corrected]) -> Point:
        """Point of one or more samples."""
        newest = samples[-1]
        columns = [_finite([of(sample) for sample in samples]) for of in self._spans]
        return Point(
            newest.sample.t_host_s,
            tuple(of(newest) for of in self._lasts),
            tuple(map(min, columns)),
            tuple(map(max, columns)),
        )

    def pack(self, point: Point) -> bytes:
        """Encode a point."""
        return self.record.pack(point.t_s, *point.last, *point.lo, *point.hi)


ONE_AXIS = PointLayout(SPANS, LASTS)
THREE_AXES = PointLayout(SPANS | TILT_SPANS, LASTS | TILT_LASTS)
LAYOUTS = {
    (False, False): ONE_AXIS,
    (True, False): THREE_AXES,
    (False, True): PointLayout(SPANS | DEVICE_SPANS, LASTS | DEVICE_LASTS),
    (True, True): PointLayout(SPANS | TILT_SPANS | DEVICE_SPANS, LASTS | TILT_LASTS | DEVICE_LASTS),
}
"""Layout by whether samples have an attitude, and whether they have the device's own yaw."""


def merged(points: Sequence[Point]) -> Point:
    """Merge consecutive points."""
    columns_lo = zip(*(point.lo for point in points), strict=True)
    columns_hi = zip(*(point.hi for point in points), strict=True)
    return Point(
        points[-1].t_s,
        points[-1].last,
        tuple(min(_finite(values)) for values in columns_lo),
        tuple(max(_finite(values)) for values in columns_hi),
    )


def _finite(values: Sequence[float]) -> Sequence[float]:
    return [value for value in values if value == value] or [nan]  # noqa: PLR0124 - not NaN


TIERS = ((0.0, 120.0), (1.0 / 3.0, 600.0), (2.0, 3600.0))
"""Width of a point in each tier, s (0 for points as they come), and length of the tier, s."""


class _Tier:
    """Newest points of one width, encoded."""

    def __init__(self, layout: PointLayout, width_s: float, kept_s: float) -> None:
        self._layout = layout
        self.rows: deque[tuple[float, bytes]] = deque(maxlen=round(kept_s / (width_s or 1.0 / POINTS_HZ)))
        self._width_s = width_s
        self._open: list[Point] = []

    def add(self, point: Point) -> None:
        """Add a point; points of one interval are merged."""
        if self._open and not self._is_same_interval(self._open[0].t_s, point.t_s):
            self._close()
        self._open.append(point)
        if not self._width_s:
            self._close()

    def _is_same_interval(self, first_s: float, second_s: float) -> bool:
        return first_s // self._width_s == second_s // self._width_s

    def _close(self) -> None:
        whole = merged(self._open) if len(self._open) > 1 else self._open[0]
        self._open.clear()
        self.rows.append((whole.t_s, self._layout.pack(whole)))


class PointHistory:
    """Bounded history of one hour for new pages: two minutes in full, older points coarser."""

    def __init__(self, layout: PointLayout = ONE_AXIS) -> None:
        self._tiers = [_Tier(layout, width_s, kept_s) for width_s, kept_s in TIERS]

    def add(self, point: Point) -> None:
        """Keep a point."""
        for tier in self._tiers:
            tier.add(point)

    def rows(self) -> list[bytes]:
        """Encoded points from oldest to newest; overlapping tiers begin with the coarser points."""
        rows: list[tuple[float, bytes]] = []
        for tier, finer in zip(self._tiers[::-1], [*self._tiers[-2::-1], None], strict=True):
            since_s = rows[-1][0] if rows else float("-inf")
            until_s = finer.rows[0][0] if finer is not None and finer.rows else float("inf")
            rows += _up_to(((t_s, row) for t_s, row in tier.rows if t_s > since_s), until_s)
        return [row for _, row in rows]


def _up_to(rows: Iterator[tuple[float, bytes]], until_s: float) -> Iterator[tuple[float, bytes]]:
    """Rows before a time, and the row that reaches it."""
    for row in rows:
        yield row
        if row[0] >= until_s:
            return


def in_messages(rows: Sequence[bytes], most: int = 500) -> Iterator[bytes]:
    """Rows in messages of at most `most` rows."""
    for start in range(0, len(rows), most):
        yield b"".join(chain(rows[start : start + most]))
