"""Any filter for many candidates by its own `step`, a sample at a time: for filters without a compiled kernel."""

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.filters.filter import Filter


def stepped_yaw(chosen: Filter, dt_s: Floats, rate_dps: Floats, candidate: Floats) -> Floats:
    """Yaw of one candidate, deg, shape (n,).

    A step takes times, not their differences: they are added up from 0, which may round the last digit of a step.
    """
    state, coefficients = chosen.state(), chosen.coefficients(chosen.params(*candidate.tolist()))
    yaw_deg = np.empty(len(dt_s))
    for n, (t_s, dps) in enumerate(zip(np.cumsum(dt_s).tolist(), rate_dps.tolist(), strict=True)):
        chosen.step(coefficients, state, t_s, dps)
        yaw_deg[n] = state.yaw_deg
    return yaw_deg


def stepped_sums(chosen: Filter, dt_s: Floats, rate_dps: Floats, reference_deg: Floats, params: Floats) -> Floats:
    """The sums of `gyrodrift.evaluation.kernels.kernel.Kernel` for candidates, shape (c, parameters)."""
    known = np.isfinite(reference_deg)
    found = np.empty((3, len(params)))
    with np.errstate(over="ignore", invalid="ignore"):
        for at, candidate in enumerate(params):
            error_deg = np.abs(stepped_yaw(chosen, dt_s, rate_dps, candidate)[known] - reference_deg[known])
            found[:, at] = np.sum(error_deg * error_deg), np.sum(error_deg), np.max(error_deg)
    return np.where(np.isfinite(found), found, np.inf)
