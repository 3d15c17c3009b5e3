"""Any filter for many candidates by its own `step`, a sample at a time: for filters without a compiled kernel."""

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.evaluation.reference import NOTHING_BESIDE, Beside
from gyrodrift.filters.filter import Filter


def stepped_yaw(
    chosen: Filter, dt_s: Floats, rate_dps: Floats, candidate: Floats, beside: Beside = NOTHING_BESIDE
) -> Floats:
    """Yaw of one candidate, deg, shape (n,)."""
    yaw_deg: Floats = _stepped(chosen, dt_s, rate_dps, candidate, beside)[0]
    return yaw_deg


def stepped_sigma(
    chosen: Filter, dt_s: Floats, rate_dps: Floats, candidate: Floats, beside: Beside = NOTHING_BESIDE
) -> Floats:
    """Standard deviation of the yaw of one candidate, deg, shape (n,); NaN of a filter that does not state it."""
    sigma_deg: Floats = _stepped(chosen, dt_s, rate_dps, candidate, beside)[1]
    return sigma_deg


def _stepped(chosen: Filter, dt_s: Floats, rate_dps: Floats, candidate: Floats, beside: Beside) -> Floats:
    """Yaw and its standard deviation, deg, shape (2, n).

    A step takes times, not their differences: they are added up from 0, which may round the last digit of a step.
    """
    state, coefficients = chosen.state(), chosen.coefficients(chosen.params(*candidate.tolist()))
    found = np.empty((2, len(dt_s)))
    step, said = chosen.step_beside, beside.filled(len(dt_s))
    columns = (np.cumsum(dt_s).tolist(), rate_dps.tolist(), said.still.tolist(), said.temp_c.tolist())
    for n, (t_s, dps, still, temp_c) in enumerate(zip(*columns, strict=True)):
        step(coefficients, state, t_s, dps, still, temp_c)
        found[:, n] = state.yaw_deg, state.yaw_sigma_deg
    return found


def stepped_sums(
    chosen: Filter,
    dt_s: Floats,
    rate_dps: Floats,
    reference_deg: Floats,
    params: Floats,
    beside: Beside = NOTHING_BESIDE,
) -> Floats:
    """The sums of `gyrodrift.evaluation.kernels.kernel.Kernel` for candidates, shape (c, parameters)."""
    known = np.isfinite(reference_deg)
    found = np.empty((3, len(params)))
    with np.errstate(over="ignore", invalid="ignore"):
        for at, candidate in enumerate(params):
            error_deg = np.abs(stepped_yaw(chosen, dt_s, rate_dps, candidate, beside)[known] - reference_deg[known])
            found[:, at] = np.sum(error_deg * error_deg), np.sum(error_deg), np.max(error_deg)
    return np.where(np.isfinite(found), found, np.inf)
