"""Heuristic drift reduction, by the compiled recursion that has the bits of `gyrodrift.filter`."""

import numpy as np

from gyrodrift.compare.method import Params
from gyrodrift.compare.plain import steps_s
from gyrodrift.session.session import Floats
from gyrodrift.tune.kernel import yaw
from gyrodrift.tune.tunables import HDR_TUNABLE


def run_hdr(t_s: Floats, rate_dps: Floats, params: Params) -> Floats:
    """Yaw of equations 1 to 8 of the README, deg, shape (n,)."""
    return yaw(steps_s(t_s), rate_dps, np.array([params[name] for name in HDR_TUNABLE.names]))
