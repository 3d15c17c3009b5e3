"""Values that no sensor can measure: they are reported, and left out because charts would show nothing else."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from gyrodrift.session.session import Session
from gyrodrift.values.arrays import Floats

MOST_DPS = 100_000.0
"""The fastest gyro on sale, the ADXRS649, measures up to 20,000 deg/s, extended 50,000 (its data sheet, rev. B)."""

LEAST_C, MOST_C = -273.15, 1000.0
"""Absolute zero, and far above what silicon survives (175 °C)."""

MOST_DEG = 1e9
"""Angle of an encoder: 2.8 million turns, two months at 33 turns a minute."""


MOST_S = 1e11
"""A time, also one since 1970: 3000 years."""


@dataclass(frozen=True, slots=True)
class Impossible:
    """Values of a column that no sensor can measure: how many, and the possible range."""

    column: str
    count: int
    possible: str

    def __str__(self) -> str:
        return f"{self.count} values outside of {self.possible}, which no sensor can measure"


def impossible_values(session: Session) -> list[Impossible]:
    """Impossible values by column; only columns that have any."""
    return [
        Impossible(name, int(np.count_nonzero(is_wrong)), possible)
        for name, _, is_wrong, possible in _columns(session)
        if is_wrong.any()
    ]


def possible_part(session: Session) -> Session:
    """The session with NaN for impossible values."""
    changed = {
        name: np.where(is_wrong, np.nan, values) for name, values, is_wrong, _ in _columns(session) if is_wrong.any()
    }
    return replace(session, **changed) if changed else session  # type: ignore[arg-type]  # all of them are columns


def _columns(session: Session) -> Iterator[tuple[str, Floats, np.ndarray, str]]:
    """Name, values, mask of the impossible ones, and the possible range in words."""
    yield "rate_dps", session.rate_dps, _is_beyond(session.rate_dps, -MOST_DPS, MOST_DPS), f"±{MOST_DPS:,.0f} deg/s"
    for name in ("t_device_s", "t_host_s"):
        times_s = getattr(session, name)
        if times_s is not None:
            yield name, times_s, _is_beyond(times_s, -MOST_S, MOST_S), f"±{MOST_S:.0e} s"
    if session.temp_c is not None:
        yield "temp_c", session.temp_c, _is_beyond(session.temp_c, LEAST_C, MOST_C), f"{LEAST_C} to {MOST_C:.0f} °C"
    if session.encoder_deg is not None:
        is_wrong = _is_beyond(session.encoder_deg, -MOST_DEG, MOST_DEG)
        yield "encoder_deg", session.encoder_deg, is_wrong, f"±{MOST_DEG:.0e} deg"


def _is_beyond(values: Floats, least: float, most: float) -> np.ndarray:
    """NaN is a missing value and is not beyond."""
    with np.errstate(invalid="ignore"):
        is_beyond: np.ndarray = (values < least) | (values > most)
    return is_beyond
