"""Rates from an angle: how far it turned since the sample before, for devices that write nothing else."""

import numpy as np

from gyrodrift.arrays import Floats

TURN_DEG, MOST_DEG = 360.0, 1e9
"""Of an angle that is counted on over many turns; what is larger is no angle, and is passed over."""


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
