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

from gyrodrift.outputs.fields import OF_EVERY_DEVICE, OF_OWN_FILTER, OF_THREE_AXES, Field, Use, fields_of
from gyrodrift.values.sample import Corrected

POINTS_HZ = 30.0
"""Points, and messages, per second."""

Value = Callable[[Corrected], float]

ENCODER: dict[str, Value] = {"encoder_deg": lambda c: c.reference_deg}
ERROR: dict[str, Value] = {"error_deg": lambda c: c.yaw_deg - c.reference_deg}
"""Values that only the page has: the encoder unwrapped from the zero of yaw, and the minimum and maximum of yaw minus
that angle."""


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


def _layout(*tables: tuple[Field, ...]) -> PointLayout:
    """Layout of the fields of some tables."""
    spans, lasts = ({field.name: field.number for field in fields_of(use, *tables)} for use in (Use.SPAN, Use.POINT))
    return PointLayout(spans | ENCODER | ERROR, lasts | ENCODER)


LAYOUTS = {
    (False, False): _layout(OF_EVERY_DEVICE),
    (True, False): _layout(OF_EVERY_DEVICE, OF_THREE_AXES),
    (False, True): _layout(OF_EVERY_DEVICE, OF_OWN_FILTER),
    (True, True): _layout(OF_EVERY_DEVICE, OF_THREE_AXES, OF_OWN_FILTER),
}
"""Layout by whether samples have an attitude, and whether they have the device's own yaw."""

ONE_AXIS, THREE_AXES = LAYOUTS[False, False], LAYOUTS[True, False]


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
