"""Gravity in a recording of three axes: its size, its direction and its noise."""

from dataclasses import dataclass

import numpy as np

from gyrodrift.session.checks.axes import windows
from gyrodrift.session.session import Session

QUIET_SHARE = 0.2
"""Share of the windows, those with the least scatter, that count as quiet: chosen."""


@dataclass(frozen=True, slots=True)
class GravitySummary:
    """Gravity as the accelerometer measures it.

    size_mps2
        Median size in the quiet windows, m/s².
    up
        Axis of the sensor that points up most, such as `+z`, and by how many degrees it is off.
    off_deg
        Angle between this axis and gravity, deg.
    noise_mps2
        Median scatter of single samples in the quiet windows, m/s².
    largest_mps2, at_largest
        Largest absolute value, m/s², and the number of samples at it.
    missing
        Share of the samples without an acceleration.
    """

    size_mps2: float
    up: str
    off_deg: float
    noise_mps2: float
    largest_mps2: float
    at_largest: int
    missing: float


def gravity_summary(session: Session) -> GravitySummary | None:
    """Size, direction and noise of gravity; None for a session without accelerations."""
    accel = session.accel_mps2
    if accel is None or not np.isfinite(accel).all(axis=1).any():
        return None
    is_finite = np.isfinite(accel).all(axis=1)
    means, scatters = windows(session.t_device_s[is_finite], accel[is_finite])
    quiet = scatters <= np.quantile(scatters, QUIET_SHARE)
    mean = np.median(means[quiet], axis=0)
    size = float(np.median(np.linalg.norm(means[quiet], axis=1)))
    index = int(np.abs(mean).argmax())
    absolute = np.abs(accel[is_finite])
    largest = float(absolute.max())
    return GravitySummary(
        size_mps2=size,
        up=f"{'+' if mean[index] > 0 else '-'}{'xyz'[index]}",
        off_deg=float(np.rad2deg(np.arccos(min(1.0, abs(mean[index]) / max(float(np.linalg.norm(mean)), 1e-12))))),
        noise_mps2=float(np.median(scatters[quiet])),
        largest_mps2=largest,
        at_largest=int((absolute >= largest).any(axis=1).sum()),
        missing=1.0 - float(is_finite.mean()),
    )
