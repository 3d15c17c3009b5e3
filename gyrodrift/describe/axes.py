"""Three axes of a session as values."""

from dataclasses import dataclass

import numpy as np

from gyrodrift.session.session import Session


@dataclass(frozen=True, slots=True)
class SessionAxes:
    """Rates and accelerations of three axes.

    rates_dps
        Least and largest finite rate by axis, deg/s.
    accel_norm_mps2
        Median length of the accelerations, m/s²; None without an accelerometer.
    without_accel
        Number of samples without acceleration.
    """

    rates_dps: dict[str, tuple[float, float]]
    accel_norm_mps2: float | None
    without_accel: int


def axes_of(session: Session) -> SessionAxes | None:
    """Axes of a session; None for a device with one axis."""
    if session.gyro_dps is None:
        return None
    rates_dps = {}
    for name, column in zip("xyz", session.gyro_dps.T, strict=True):
        finite = column[np.isfinite(column)]
        rates_dps[name] = (float(finite.min(initial=0.0)), float(finite.max(initial=0.0)))
    if session.accel_mps2 is None:
        return SessionAxes(rates_dps, None, len(session.rate_dps))
    lengths = np.linalg.norm(session.accel_mps2, axis=1)
    is_known = np.isfinite(lengths)
    length_mps2 = float(np.median(lengths[is_known])) if is_known.any() else None
    return SessionAxes(rates_dps, length_mps2, int(np.count_nonzero(~is_known)))
