"""Accepted samples of a session with their reference angle."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gyrodrift.evaluation.attitude import attitude_history
from gyrodrift.evaluation.auxiliary import NO_AUXILIARY, Auxiliary, DeviceColumns, InertialColumns, hold_last
from gyrodrift.filters.limits import LEAST_STEP_S, MOST_DPS, MOST_S
from gyrodrift.session.aids import RowAids
from gyrodrift.session.session import Session, aids_of_rows, unwrapped
from gyrodrift.values.arrays import Floats
from gyrodrift.values.errors import DataError


@dataclass(frozen=True, slots=True)
class Reference:
    """Accepted samples, beginning with the first that has a reference, shape (n,), n ≥ 2.

    dt_s
        Step of device time before each sample, s, bit for bit as in `filter.step`; 0 before the first.
    rate_dps
        Measured rate, deg/s; of a session with three axes the rate of the heading, with the bias still in it.
    reference_deg
        Reference angle, unwrapped, 0 at the first sample; NaN for a sample without it.
    minutes
        Duration by device time.
    auxiliary
        Auxiliary data.
    axes
        Three axes; None for a session of one axis.
    device_yaw
        Yaw of the device's own filter; None for a device without one.
    aids
        Measurements of second sources; None without any.
    """

    name: str
    dt_s: Floats
    rate_dps: Floats
    reference_deg: Floats
    minutes: float
    auxiliary: Auxiliary = NO_AUXILIARY
    axes: InertialColumns | None = None
    device_yaw: DeviceColumns | None = None
    aids: RowAids | None = None

    def thinned(self, max_samples: int) -> NDArray[np.int64]:
        """Indices of at most `max_samples` samples with a reference, evenly spread, for a figure."""
        known_rows = np.flatnonzero(np.isfinite(self.reference_deg))
        chosen: NDArray[np.int64] = known_rows[
            np.unique(np.linspace(0, len(known_rows) - 1, max_samples).astype(np.int64))
        ]
        return chosen

    @property
    def sample_rate_hz(self) -> float:
        """Sample rate from the median step, Hz."""
        return 1.0 / float(np.median(self.dt_s[1:]))


def reference_of(session: Session, *, is_still: bool = False) -> Reference:
    """The reference of a session; see `timed_reference_of`."""
    return timed_reference_of(session, is_still=is_still)[1]


def timed_reference_of(session: Session, *, is_still: bool = False) -> tuple[Floats, Reference]:
    """Device times in s, shape (n,), and the reference at them.

    The times are not part of the reference: a tuning keeps all its sessions in memory and needs only the steps.

    Parameters
    ----------
    session
        A session with an encoder, or a still.
    is_still
        The device did not move: the reference is 0, with or without an encoder.

    Raises
    ------
    DataError
        If there is no reference, or fewer than two accepted samples with a reference.
    """
    kept = accepted(session.t_device_s, session.rate_dps)
    reference_deg = _reference_deg(session, kept, is_still=is_still)
    known_rows = np.flatnonzero(np.isfinite(reference_deg))
    if len(known_rows) < 2:
        raise DataError(
            f"{session.name}: has {len(known_rows)} samples with a rate and a reference; at least 2 are needed"
        )
    first = known_rows[0]
    t_s, axes, auxiliary = (
        session.t_device_s[kept][first:],
        _axes(session, kept, first),
        _auxiliary(session, kept, first),
    )
    rate_dps = (
        session.rate_dps[kept][first:] if axes is None else attitude_history(t_s, axes, auxiliary).heading_rate_dps
    )
    reference_deg = reference_deg[first:] - reference_deg[first]
    dt_s = np.diff(t_s, prepend=t_s[0])
    minutes = float(t_s[-1] - t_s[0]) / 60.0
    device_yaw = _device_yaw(session, kept, first)
    aids = aids_of_rows(session.aids, np.flatnonzero(kept)[first:], len(kept)) if session.aids else None
    columns = (dt_s, rate_dps, reference_deg, minutes, auxiliary, axes, device_yaw, aids)
    return t_s, Reference(session.name, *columns)


def auxiliary_of(session: Session) -> Auxiliary:
    """Auxiliary data of a session."""
    nothing = NO_AUXILIARY.still
    return Auxiliary(*(nothing if column is None else column for column in (session.still, session.temp_c)))


def _auxiliary(session: Session, kept: NDArray[np.bool_], first: int) -> Auxiliary:
    return Auxiliary(*(column[kept][first:] if len(column) else column for column in auxiliary_of(session)))


def _axes(session: Session, kept: NDArray[np.bool_], first: int) -> InertialColumns | None:
    if session.gyro_dps is None or session.accel_mps2 is None:
        return None
    return InertialColumns(session.gyro_dps[kept][first:], session.accel_mps2[kept][first:])


def _device_yaw(session: Session, kept: NDArray[np.bool_], first: int) -> DeviceColumns | None:
    if session.device_yaw_deg is None:
        return None
    columns = (session.device_yaw_deg, session.filled("device_yaw_sigma_deg"))
    return DeviceColumns(*(hold_last(column)[kept][first:] for column in columns))


def _reference_deg(session: Session, kept: NDArray[np.bool_], *, is_still: bool) -> Floats:
    """Unwrapped angle of the accepted samples, deg."""
    if is_still:
        return np.zeros(np.count_nonzero(kept))
    if session.encoder_deg is None:
        raise DataError(
            f"{session.name}: has no encoder angle to compare yaw with; give --still if the device did not move"
        )
    return unwrapped(session.encoder_deg[kept])


def accepted(t_s: Floats, rate_dps: Floats) -> NDArray[np.bool_]:
    """Mask of the samples that `filter.step` accepts, shape (n,): within its limits, and later than all before."""
    is_within = (np.abs(t_s) <= MOST_S) & (np.abs(rate_dps) <= MOST_DPS)
    latest_s = np.maximum.accumulate(np.where(is_within, t_s, -np.inf))
    before_s = np.concatenate([[-np.inf], latest_s[:-1]])
    kept: NDArray[np.bool_] = is_within & (t_s > before_s)
    if np.diff(t_s[kept]).min(initial=1.0) < LEAST_STEP_S:  # a rejected sample changes the step of the next
        before = -np.inf
        for row in np.flatnonzero(kept).tolist():
            kept[row] = t_s[row] - before >= LEAST_STEP_S
            before = t_s[row] if kept[row] else before
    return kept
