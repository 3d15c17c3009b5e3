"""Yaw of a session: integrated raw rate, filtered yaw, and the angle of the encoder."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from gyrodrift.evaluation.integration import trapezium
from gyrodrift.evaluation.reference import accepted, auxiliary_of
from gyrodrift.filters.run import FilterRun
from gyrodrift.session.aids import aids_by_row
from gyrodrift.session.session import Session, unwrapped
from gyrodrift.values.aid import Aid
from gyrodrift.values.arrays import Floats, Mask


@dataclass(frozen=True, slots=True, eq=False)
class YawHistory:
    """Yaw at the k ≥ 2 samples that the filter accepts, each array of shape (k,).

    filter_name
        Name of the filter that corrects.
    t_s
        Device time after the first of all samples, s.
    raw_deg, corrected_deg
        Yaw of plain integration and of the filter, deg, 0 at the first sample.
    sigma_deg
        Standard deviation that the filter states for its yaw, deg; NaN if it states none.
    bias_dps
        Bias that the filter estimates, deg/s.
    reference_deg
        Angle of the encoder, unwrapped, 0 at its first value, deg; NaN where it is missing.
    """

    filter_name: str
    t_s: Floats
    raw_deg: Floats
    corrected_deg: Floats
    sigma_deg: Floats
    bias_dps: Floats
    reference_deg: Floats

    @property
    def has_reference(self) -> bool:
        """Whether an encoder measured the angle."""
        return bool(np.isfinite(self.reference_deg).sum() > 1)

    @property
    def raw_error_deg(self) -> Floats:
        """Plain integration minus the encoder, deg; 0 at the first value of the encoder."""
        return self._error_deg(self.raw_deg)

    @property
    def corrected_error_deg(self) -> Floats:
        """Corrected yaw minus the encoder, deg; 0 at the first value of the encoder."""
        return self._error_deg(self.corrected_deg)

    def _error_deg(self, yaw_deg: Floats) -> Floats:
        first = int(np.isfinite(self.reference_deg).argmax())
        error_deg: Floats = yaw_deg - yaw_deg[first] - self.reference_deg
        return error_deg


def mean_absolute(error_deg: Floats) -> float:
    """Mean absolute error over the finite values, deg."""
    return float(np.nanmean(np.abs(error_deg)))


def last_error(error_deg: Floats) -> float:
    """The last finite error, deg."""
    return float(error_deg[np.isfinite(error_deg)][-1])


def yaw_history_of(session: Session, run: FilterRun) -> YawHistory | None:
    """Run a new filter over a session; None if it accepts fewer than two samples."""
    is_accepted = accepted(session.t_device_s, session.rate_dps)
    t_s, rate_dps = session.t_device_s[is_accepted], session.rate_dps[is_accepted]
    if len(t_s) < 2:
        return None
    stated = auxiliary_of(session).filled(len(is_accepted))
    columns = (t_s, rate_dps, stated.still[is_accepted], stated.temp_c[is_accepted])
    t, rate, still, temp_c = (column.tolist() for column in columns)
    samples = zip(t, rate, session.rows(np.flatnonzero(is_accepted)).inertials(), still, temp_c, strict=True)
    aids = aids_by_row(session.rows(np.flatnonzero(is_accepted)).aids or ())
    corrected_deg, sigma_deg, bias_dps = _filtered(samples, run, len(t), aids)
    return YawHistory(
        filter_name=run.filter.name,
        t_s=t_s - session.t_device_s[np.isfinite(session.t_device_s)][0],
        raw_deg=trapezium(np.diff(t_s, prepend=t_s[0]), rate_dps),
        corrected_deg=corrected_deg,
        sigma_deg=sigma_deg,
        bias_dps=bias_dps,
        reference_deg=_reference_deg(session, is_accepted),
    )


def _filtered(
    samples: Iterable[tuple[Any, ...]], run: FilterRun, count: int, aids: Mapping[int, tuple[Aid, ...]]
) -> Floats:
    """Yaw, its standard deviation and the bias, shape (3, count), by the same steps as in `serve`.

    Samples are the arguments of `FilterRun.step`; second sources stand by the index of their sample.
    """
    filtered = np.empty((3, count))
    for index, sample in enumerate(samples):
        run.step(*sample)
        for aid in aids.get(index, ()):
            run.aid(aid)
        state = run.state
        filtered[:, index] = state.yaw_deg, state.yaw_sigma_deg, state.bias_dps
    return filtered


def _reference_deg(session: Session, is_accepted: Mask) -> Floats:
    if session.encoder_deg is None:
        return np.full(int(is_accepted.sum()), np.nan)
    angle_deg = unwrapped(session.encoder_deg[is_accepted])
    finite = np.flatnonzero(np.isfinite(angle_deg))
    return angle_deg - (angle_deg[finite[0]] if len(finite) else 0.0)
