"""Unwrapped angles of a session."""

import numpy as np

from gyrodrift.values.arrays import Floats
from gyrodrift.values.constants import FULL_TURN_DEG


def unwrapped(angle_deg: Floats) -> Floats:
    """Unwrap an angle in deg that was recorded from 0 to 360 or from −180 to 180; other angles stay."""
    is_finite = np.isfinite(angle_deg)
    angles = angle_deg[is_finite]
    if not len(angles) or np.ptp(angles) > FULL_TURN_DEG or not np.any(np.abs(np.diff(angles)) > FULL_TURN_DEG / 2.0):
        return angle_deg
    result = angle_deg.copy()
    result[is_finite] = np.unwrap(angles, period=FULL_TURN_DEG)
    return result
