"""Restlevel, by its own source, compiled."""

from gyrodrift.compare.method import Params
from gyrodrift.compare.plain import steps_s
from gyrodrift.restlevel.records import RestlevelParams
from gyrodrift.session.session import Floats
from gyrodrift.tune.kernel_restlevel import walk


def run_restlevel(t_s: Floats, rate_dps: Floats, params: Params) -> Floats:
    """Yaw of the filter, deg, shape (n,)."""
    yaw_deg: Floats = walk(steps_s(t_s), rate_dps, RestlevelParams(**params))[0]
    return yaw_deg
