"""Angles of a session as they went on."""

import numpy as np

from gyrodrift.arrays import Floats

FULL_TURN_DEG = 360.0


def unwrapped(angle_deg: Floats) -> Floats:
    """The angle as it went on, where it was recorded from 0 to 360 or from −180 to 180."""
    known = np.isfinite(angle_deg)
    angles = angle_deg[known]
    if not len(angles) or np.ptp(angles) > FULL_TURN_DEG or not np.any(np.abs(np.diff(angles)) > FULL_TURN_DEG / 2.0):
        return angle_deg
    result = angle_deg.copy()
    result[known] = np.unwrap(angles, period=FULL_TURN_DEG)
    return result
