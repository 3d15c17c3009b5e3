"""Rates from an angle, for devices that record only the angle."""

import numpy as np

from gyrodrift.values.arrays import Floats

NORMS = (0.9, 1.1)
"""Norms of a unit quaternion after rounding."""

TURN_DEG, MOST_DEG = 360.0, 1e9
"""A turn, and the largest angle counted over many turns; larger values are skipped."""


def yaw_of(w: Floats, x: Floats, y: Floats, z: Floats) -> Floats:
    """Yaw of unit quaternions, deg (z-y-x Euler angles), shape (n,); NaN for other norms."""
    with np.errstate(all="ignore"):  # values may be no quaternion
        norm = np.sqrt(w * w + x * x + y * y + z * z)
        yaw_deg: Floats = np.degrees(np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)))
    return np.where((norm >= NORMS[0]) & (norm <= NORMS[1]), yaw_deg, np.nan)


def rates_of(t_s: Floats, angle_deg: Floats) -> tuple[Floats, Floats]:
    """Times in s and mean rates since the previous time in deg/s, for angles that wrap.

    Of equal times the last angle counts. A backward step of the clock gives NaN.
    """
    is_angle = np.isfinite(t_s) & (np.abs(angle_deg) <= MOST_DEG)
    t_s, angle_deg = t_s[is_angle], angle_deg[is_angle]
    if not len(t_s):
        return t_s, angle_deg
    is_last = np.append(np.diff(t_s) != 0.0, [True])
    t_s, angle_deg = t_s[is_last], angle_deg[is_last]
    step_s = np.diff(t_s)
    change_deg = (np.diff(angle_deg) + 0.5 * TURN_DEG) % TURN_DEG - 0.5 * TURN_DEG
    rate_dps = np.full(len(step_s), np.nan)
    np.divide(change_deg, step_s, out=rate_dps, where=step_s > 0.0)
    return t_s[1:], rate_dps
