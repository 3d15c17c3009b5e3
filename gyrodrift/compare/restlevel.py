"""Restlevel, by its own source, compiled."""

from typing import Any

import numpy as np
from numba import njit

from gyrodrift.compare.method import Params
from gyrodrift.restlevel.records import RestlevelParams, RestlevelState
from gyrodrift.restlevel.step import coefficients, step
from gyrodrift.session.session import Floats
from gyrodrift.tune.compiled import array_of, compiled

_step = compiled(step)


def run_restlevel(t_s: Floats, rate_dps: Floats, params: Params) -> Floats:
    """Yaw of the filter, deg, shape (n,)."""
    yaw_deg: Floats = estimates(t_s, rate_dps, RestlevelParams(**params))[0]
    return yaw_deg


def estimates(t_s: Floats, rate_dps: Floats, params: RestlevelParams) -> Floats:
    """Yaw in deg, its standard deviation in deg and the bias in deg/s, shape (3, n)."""
    found = np.zeros((3, len(t_s)))
    _walk(array_of(coefficients(params)), array_of(RestlevelState()), t_s, rate_dps, found)
    return found


@njit(nogil=True)
def _walk(c: Any, s: Any, t_s: Floats, rate_dps: Floats, found: Floats) -> None:
    for n in range(len(t_s)):
        _step(c[0], s[0], t_s[n], rate_dps[n])
        found[0, n] = s[0].yaw_deg
        found[1, n] = s[0].yaw_sigma_deg
        found[2, n] = s[0].bias_dps
