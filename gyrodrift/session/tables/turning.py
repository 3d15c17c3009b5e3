"""Rates from an angle: how far it turned since the sample before, for devices that write nothing else."""

import numpy as np

from gyrodrift.arrays import Floats

NORMS = (0.9, 1.1)
"""Of a quaternion that is an orientation, after it was rounded."""

TURN_DEG, MOST_DEG = 360.0, 1e9
"""Of an angle that is counted on over many turns; what is larger is no angle, and is passed over."""


def yaw_of(w: Floats, x: Floats, y: Floats, z: Floats) -> Floats:
    """Yaw in degrees of unit quaternions (z-y-x Euler angles); NaN where one has another norm."""
    with np.errstate(all="ignore"):  # of what is no quaternion
        norm = np.sqrt(w * w + x * x + y * y + z * z)
        yaw_deg: Floats = np.degrees(np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)))
    return np.where((norm >= NORMS[0]) & (norm <= NORMS[1]), yaw_deg, np.nan)


def rates_of(t_s: Floats, angle_deg: Floats) -> tuple[Floats, Floats]:
    """Times and mean rates since the time before, deg/s, for angles that wrap; of equal times the last angle counts.

    Where the clock goes back the rate is not known (NaN).
    """
    is_angle = np.isfinite(t_s) & (np.abs(angle_deg) <= MOST_DEG)
    t_s, angle_deg = t_s[is_angle], angle_deg[is_angle]
    if not len(t_s):
        return t_s, angle_deg
    is_last = np.append(np.diff(t_s) != 0.0, [True])
    t_s, angle_deg = t_s[is_last], angle_deg[is_last]
    step_s = np.diff(t_s)
    turned_deg = (np.diff(angle_deg) + 0.5 * TURN_DEG) % TURN_DEG - 0.5 * TURN_DEG
    rate_dps = np.full(len(step_s), np.nan)
    np.divide(turned_deg, step_s, out=rate_dps, where=step_s > 0.0)
    return t_s[1:], rate_dps
