"""Heuristic drift reduction, by the compiled recursion that has the bits of `gyrodrift.filter`."""

from dataclasses import fields

import numpy as np

from gyrodrift.compare.method import Params
from gyrodrift.compare.plain import steps_s
from gyrodrift.filter import HdrParams
from gyrodrift.session.session import Floats
from gyrodrift.tune.kernel import yaw

NAMES = tuple(field.name for field in fields(HdrParams))


def run_hdr(t_s: Floats, rate_dps: Floats, params: Params) -> Floats:
    """Yaw of equations 1 to 8 of the README, deg, shape (n,)."""
    return yaw(steps_s(t_s), rate_dps, np.array([params[name] for name in NAMES]))
