"""What filters are evaluated on: the samples of a session that they accept, and the angle these should give."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gyrodrift.arrays import Floats
from gyrodrift.errors import DataError
from gyrodrift.filters.limits import LEAST_STEP_S, MOST_DPS, MOST_S
from gyrodrift.session.angles import unwrapped
from gyrodrift.session.session import Session


class Beside(NamedTuple):
    """What is known beside the rate, sample by sample, shape (n,); NaN where nobody says, shape (0,) where never.

    still
        1 where something else says that the device stands still, 0 where it moves.
    temp_c
        Temperature of the sensor, °C.
    """

    still: Floats
    temp_c: Floats

    def filled(self, count: int) -> "Beside":
        """With a value for each of so many samples."""
        return Beside(*(each if len(each) else np.full(count, np.nan) for each in self))


NOTHING_BESIDE = Beside(np.empty(0), np.empty(0))


@dataclass(frozen=True, slots=True)
class Reference:
    """Accepted samples from the first one with a reference on, shape (n,), n ≥ 2.

    dt_s
        Step of device time before each sample, s, with the bits that `filter.step` sees; 0 before the first.
    rate_dps
        Measured rate, deg/s.
    reference_deg
        Angle that yaw should have, unwrapped, 0 at the first sample; NaN where there is none.
    minutes
        True duration by device time.
    beside
        What is known beside the rate.
    """

    name: str
    dt_s: Floats
    rate_dps: Floats
    reference_deg: Floats
    minutes: float
    beside: Beside = NOTHING_BESIDE

    def thinned(self, points: int) -> NDArray[np.int64]:
        """Indices of at most so many of the samples that have a reference, evenly spread, for a figure."""
        known = np.flatnonzero(np.isfinite(self.reference_deg))
        chosen: NDArray[np.int64] = known[np.unique(np.linspace(0, len(known) - 1, points).astype(np.int64))]
        return chosen

    @property
    def sample_rate_hz(self) -> float:
        """By the median step."""
        return 1.0 / float(np.median(self.dt_s[1:]))


def reference_of(session: Session, *, is_still: bool = False) -> Reference:
    """The reference of a session; see `timed_reference_of`."""
    return timed_reference_of(session, is_still=is_still)[1]


def timed_reference_of(session: Session, *, is_still: bool = False) -> tuple[Floats, Reference]:
    """Device times in s, shape (n,), and the reference at them.

    The times are no part of the reference: a tuning holds all its sessions, and needs nothing but the steps.

    Parameters
    ----------
    session
        With an encoder, or still.
    is_still
        The device did not move: the reference is zero, whatever else was recorded.

    Raises
    ------
    DataError
        Where there is no reference, or fewer than two samples that the filter takes.
    """
    kept = accepted(session.t_device_s, session.rate_dps)
    reference_deg = _reference_deg(session, kept, is_still=is_still)
    known = np.flatnonzero(np.isfinite(reference_deg))
    if len(known) < 2:
        raise DataError(f"{session.name}: has {len(known)} samples with a rate and a reference; two are the least")
    first = known[0]
    t_s, rate_dps = session.t_device_s[kept][first:], session.rate_dps[kept][first:]
    reference_deg = reference_deg[first:] - reference_deg[first]
    dt_s = np.diff(t_s, prepend=t_s[0])
    return t_s, Reference(
        session.name, dt_s, rate_dps, reference_deg, float(t_s[-1] - t_s[0]) / 60.0, _beside(session, kept, first)
    )


def beside_of(session: Session) -> Beside:
    """What a session says beside its rate."""
    nothing = NOTHING_BESIDE.still
    return Beside(*(nothing if each is None else each for each in (session.still, session.temp_c)))


def _beside(session: Session, kept: NDArray[np.bool_], first: int) -> Beside:
    return Beside(*(each[kept][first:] if len(each) else each for each in beside_of(session)))


def _reference_deg(session: Session, kept: NDArray[np.bool_], *, is_still: bool) -> Floats:
    """Angle of the kept samples, deg, where it begins."""
    if is_still:
        return np.zeros(np.count_nonzero(kept))
    if session.encoder_deg is None:
        raise DataError(
            f"{session.name}: has no encoder, so nothing says what yaw should be; a still goes with --still"
        )
    return unwrapped(session.encoder_deg[kept])


def accepted(t_s: Floats, rate_dps: Floats) -> NDArray[np.bool_]:
    """Which samples `filter.step` takes: within its limits, and later than all taken before; booleans of shape (n,)."""
    is_within = (np.abs(t_s) <= MOST_S) & (np.abs(rate_dps) <= MOST_DPS)
    latest_s = np.maximum.accumulate(np.where(is_within, t_s, -np.inf))
    before_s = np.concatenate([[-np.inf], latest_s[:-1]])
    kept: NDArray[np.bool_] = is_within & (t_s > before_s)
    if np.diff(t_s[kept]).min(initial=1.0) < LEAST_STEP_S:  # each that is passed by moves what the next is held against
        before = -np.inf
        for at in np.flatnonzero(kept).tolist():
            kept[at] = t_s[at] - before >= LEAST_STEP_S
            before = t_s[at] if kept[at] else before
    return kept
