"""Heuristic drift reduction, by the compiled recursion that has the bits of `gyrodrift.filters.hdr`."""

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.compare.methods.method import Params
from gyrodrift.compare.methods.plain import steps_s
from gyrodrift.evaluation.kernels.hdr import yaw
from gyrodrift.evaluation.tunables import HDR_TUNABLE


def run_hdr(t_s: Floats, rate_dps: Floats, params: Params) -> Floats:
    """Yaw of equations 1 to 8 of the README, deg, shape (n,)."""
    return yaw(steps_s(t_s), rate_dps, np.array([params[name] for name in HDR_TUNABLE.names]))
