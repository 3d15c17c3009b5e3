"""Yaw of a session: the plain integral of its rate, what a filter makes of it, and the angle that the encoder saw."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.evaluation.integration import euler
from gyrodrift.evaluation.reference import accepted, beside_of
from gyrodrift.filters.filter import Filter
from gyrodrift.session.angles import unwrapped
from gyrodrift.session.session import Session


@dataclass(frozen=True, slots=True, eq=False)
class YawHistory:
    """Yaw over the samples that the filter takes, every array of the shape (k,), k ≥ 2.

    filter_name
        That corrected.
    t_s
        Device time after the first of all samples, s.
    raw_deg, corrected_deg
        Yaw of the plain integral and of the filter, 0 at the first sample, deg.
    sigma_deg
        Standard deviation that the filter states for its yaw, deg; NaN where it states none.
    bias_dps
        Its estimate of the bias, deg/s.
    reference_deg
        Angle of the encoder from where it is known first, unwrapped, deg; NaN where there is none.
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
        """Whether an encoder says what yaw should be."""
        return bool(np.isfinite(self.reference_deg).sum() > 1)

    @property
    def raw_error_deg(self) -> Floats:
        """The plain integral less the encoder, deg; both from where the encoder begins."""
        return self._error_deg(self.raw_deg)

    @property
    def corrected_error_deg(self) -> Floats:
        """Corrected yaw less the encoder, deg."""
        return self._error_deg(self.corrected_deg)

    def _error_deg(self, yaw_deg: Floats) -> Floats:
        first = int(np.isfinite(self.reference_deg).argmax())
        error_deg: Floats = yaw_deg - yaw_deg[first] - self.reference_deg
        return error_deg


def mean_absolute(error_deg: Floats) -> float:
    """Mean absolute error over the samples that have one, deg."""
    return float(np.nanmean(np.abs(error_deg)))


def yaw_history_of(session: Session, chosen: Filter, params: Any) -> YawHistory | None:
    """Run a filter over a session; None where it takes fewer than two samples."""
    kept = accepted(session.t_device_s, session.rate_dps)
    t_s, rate_dps = session.t_device_s[kept], session.rate_dps[kept]
    if len(t_s) < 2:
        return None
    said = beside_of(session).filled(len(kept))
    beside = (said.still[kept], said.temp_c[kept])
    corrected_deg, sigma_deg, bias_dps = _filtered((t_s, rate_dps, *beside), chosen, params)
    return YawHistory(
        filter_name=chosen.name,
        t_s=t_s - session.t_device_s[np.isfinite(session.t_device_s)][0],
        raw_deg=euler(np.diff(t_s, prepend=t_s[0]), rate_dps),
        corrected_deg=corrected_deg,
        sigma_deg=sigma_deg,
        bias_dps=bias_dps,
        reference_deg=_reference_deg(session, kept),
    )


def _filtered(samples: tuple[Floats, ...], chosen: Filter, params: Any) -> Floats:
    """Yaw, its standard deviation and the bias, shape (3, k): the very steps that `serve` takes.

    Samples are times in s, rates in deg/s, and what is known beside them.
    """
    state, coefficients, step = chosen.state(), chosen.coefficients(params), chosen.step_beside
    found = np.empty((3, len(samples[0])))
    for at, sample in enumerate(zip(*(each.tolist() for each in samples), strict=True)):
        step(coefficients, state, *sample)
        found[:, at] = state.yaw_deg, state.yaw_sigma_deg, state.bias_dps
    return found


def _reference_deg(session: Session, kept: Any) -> Floats:
    if session.encoder_deg is None:
        return np.full(int(kept.sum()), np.nan)
    angle_deg = unwrapped(session.encoder_deg[kept])
    known = np.flatnonzero(np.isfinite(angle_deg))
    return angle_deg - (angle_deg[known[0]] if len(known) else 0.0)
