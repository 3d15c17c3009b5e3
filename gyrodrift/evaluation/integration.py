"""Plain integration, which every filter is held against."""

import numpy as np

from gyrodrift.arrays import Floats


def euler(dt_s: Floats, rate_dps: Floats) -> Floats:
    """Yaw of the plain sum of rate times step, deg, shape (n,)."""
    with np.errstate(over="ignore", invalid="ignore"):
        turned_deg = rate_dps * dt_s
        turned_deg[0] = 0.0
        return np.cumsum(turned_deg)
