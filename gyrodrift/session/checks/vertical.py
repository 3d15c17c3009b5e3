"""Rate about the vertical of a session with three axes, good to some percent: enough for a unit, a sign and an axis."""

import numpy as np

from gyrodrift.session.session import Session
from gyrodrift.values.arrays import Floats

AVERAGE_S = 1.0
"""Time over which accelerations are averaged: steps and vibration cancel, and a tilt by hand takes longer."""


def vertical_rates_dps(session: Session) -> Floats:
    """Rates about the vertical by the averaged direction of the accelerations, deg/s, shape (n,).

    For a device with one axis, and where the direction is unknown, the rate about z.
    """
    if session.gyro_dps is None or session.accel_mps2 is None:
        return session.rate_dps
    is_known = np.isfinite(session.accel_mps2).all(axis=1) & np.isfinite(session.t_device_s)
    if np.count_nonzero(is_known) < 2:
        return session.rate_dps
    steps_s = np.diff(session.t_device_s[is_known])
    period_s = float(np.median(steps_s[steps_s > 0.0])) if (steps_s > 0.0).any() else AVERAGE_S
    means = _averaged(np.where(is_known[:, None], session.accel_mps2, 0.0), is_known, round(AVERAGE_S / period_s))
    lengths = np.linalg.norm(means, axis=1)
    rates: Floats = (session.gyro_dps * means).sum(axis=1) / np.where(lengths > 0.0, lengths, 1.0)
    return np.where((lengths > 0.0) & np.isfinite(rates), rates, session.rate_dps)


def _averaged(forces: Floats, is_known: np.ndarray, size: int) -> Floats:
    """Moving average over `size` samples around each sample; zeros where none of them is known."""
    half = max(1, size // 2)
    sums = np.concatenate([np.zeros((1, 3)), np.cumsum(forces, axis=0)])
    counts = np.concatenate([[0], np.cumsum(is_known)])
    index = np.arange(len(forces))
    start, end = np.maximum(index - half, 0), np.minimum(index + half + 1, len(forces))
    means: Floats = (sums[end] - sums[start]) / np.maximum(counts[end] - counts[start], 1)[:, None]
    return means
