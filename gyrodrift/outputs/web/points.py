"""What the page draws: 30 points a second with the least and the greatest value in each, and an hour of them.

However fast the device is, a spike of one sample stays visible: points are merged by minimum and maximum.
"""

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from itertools import chain
from math import nan
from struct import Struct
from typing import NamedTuple

from gyrodrift.sample import Corrected

POINTS_HZ = 30.0
"""Points, and messages, a second."""

Value = Callable[[Corrected], float]

SPANS: dict[str, Value] = {
    "yaw_deg": lambda c: c.yaw_deg,
    "raw_yaw_deg": lambda c: c.raw_yaw_deg,
    "encoder_deg": lambda c: c.reference_deg,
    "error_deg": lambda c: c.yaw_deg - c.reference_deg,
    "rate_dps": lambda c: c.sample.rate_dps,
    "rest_probability": lambda c: c.rest_probability,
}
"""Drawn from the least to the greatest; `NAME_lo` and `NAME_hi` of a point."""

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
"""As of the last sample of a point."""

COLUMNS = ("t_s", *LASTS, *(f"{name}_lo" for name in SPANS), *(f"{name}_hi" for name in SPANS))
"""Of a point as it is sent; `t_s` is the Unix time at which its last sample arrived, s."""

LAYOUT = Struct(f"<d{len(COLUMNS) - 1}f")
"""The time, then everything else in single precision, little-endian."""


class Point(NamedTuple):
    """Some samples in a row.

    t_s
        When the last one arrived, Unix time, s.
    last, lo, hi
        Values by the order of LASTS and SPANS; NaN for what is not known.
    """

    t_s: float
    last: tuple[float, ...]
    lo: tuple[float, ...]
    hi: tuple[float, ...]

    def pack(self) -> bytes:
        """As it is sent."""
        return LAYOUT.pack(self.t_s, *self.last, *self.lo, *self.hi)


def point_of(samples: Sequence[Corrected]) -> Point:
    """All of them, at least one, in one point."""
    newest = samples[-1]
    columns = [[value for value in map(of, samples) if value == value] or [nan] for of in SPANS.values()]  # noqa: PLR0124 - not NaN
    return Point(
        newest.sample.t_host_s,
        tuple(of(newest) for of in LASTS.values()),
        tuple(map(min, columns)),
        tuple(map(max, columns)),
    )


def merged(points: Sequence[Point]) -> Point:
    """One point for several in a row."""
    columns_lo = zip(*(each.lo for each in points), strict=True)
    columns_hi = zip(*(each.hi for each in points), strict=True)
    return Point(
        points[-1].t_s,
        points[-1].last,
        tuple(min(_known(values)) for values in columns_lo),
        tuple(max(_known(values)) for values in columns_hi),
    )


def _known(values: Sequence[float]) -> Sequence[float]:
    return [value for value in values if value == value] or [nan]  # noqa: PLR0124 - not NaN


TIERS = ((0.0, 120.0), (1.0 / 3.0, 600.0), (2.0, 3600.0))
"""For how long a point of a tier stands, s (0 for points as they come), and how long the tier reaches back, s."""


class _Tier:
    """Points of one width, the newest of them, packed."""

    def __init__(self, width_s: float, kept_s: float) -> None:
        self.rows: deque[tuple[float, bytes]] = deque(maxlen=round(kept_s / (width_s or 1.0 / POINTS_HZ)))
        self._width_s = width_s
        self._open: list[Point] = []

    def add(self, point: Point) -> None:
        """Take a point; those of one stretch of time become one."""
        if self._open and not self._is_same_stretch(self._open[0].t_s, point.t_s):
            self._close()
        self._open.append(point)
        if not self._width_s:
            self._close()

    def _is_same_stretch(self, one_s: float, other_s: float) -> bool:
        return one_s // self._width_s == other_s // self._width_s

    def _close(self) -> None:
        whole = merged(self._open) if len(self._open) > 1 else self._open[0]
        self._open.clear()
        self.rows.append((whole.t_s, whole.pack()))


class PointHistory:
    """The last hour for a page that has just been opened: two minutes in full, the rest ever coarser; bounded."""

    def __init__(self) -> None:
        self._tiers = [_Tier(width_s, kept_s) for width_s, kept_s in TIERS]

    def add(self, point: Point) -> None:
        """Keep a point."""
        for tier in self._tiers:
            tier.add(point)

    def rows(self) -> list[bytes]:
        """From the oldest to the newest, packed; where tiers overlap, a coarser point goes before finer ones."""
        found: list[tuple[float, bytes]] = []
        for tier, finer in zip(self._tiers[::-1], [*self._tiers[-2::-1], None], strict=True):
            since_s = found[-1][0] if found else float("-inf")
            until_s = finer.rows[0][0] if finer is not None and finer.rows else float("inf")
            found += _up_to(((t_s, row) for t_s, row in tier.rows if t_s > since_s), until_s)
        return [row for _, row in found]


def _up_to(rows: Iterator[tuple[float, bytes]], until_s: float) -> Iterator[tuple[float, bytes]]:
    """Those before a time, and the one that reaches it."""
    for row in rows:
        yield row
        if row[0] >= until_s:
            return


def in_messages(rows: Sequence[bytes], most: int = 500) -> Iterator[bytes]:
    """Rows in messages of so many."""
    for at in range(0, len(rows), most):
        yield b"".join(chain(rows[at : at + most]))
