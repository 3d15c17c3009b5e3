"""Restlevel, by its own source, compiled."""

from gyrodrift.arrays import Floats
from gyrodrift.compare.methods.method import Params
from gyrodrift.compare.methods.plain import steps_s
from gyrodrift.evaluation.kernels.restlevel import walk
from gyrodrift.filters.restlevel.model import RestlevelParams


def run_restlevel(t_s: Floats, rate_dps: Floats, params: Params) -> Floats:
    """Yaw of the filter, deg, shape (n,)."""
    yaw_deg: Floats = walk(steps_s(t_s), rate_dps, RestlevelParams(**params))[0]
    return yaw_deg
