"""Run a filter without a compiled kernel by its `step`, sample by sample."""

import numpy as np

from gyrodrift.evaluation.auxiliary import NO_AUXILIARY, Auxiliary
from gyrodrift.filters.filter import Filter
from gyrodrift.values.arrays import Floats


def stepped_yaw(
    chosen: Filter, dt_s: Floats, rate_dps: Floats, candidate: Floats, auxiliary: Auxiliary = NO_AUXILIARY
) -> Floats:
    """Yaw of one candidate, deg, shape (n,)."""
    yaw_deg: Floats = _stepped(chosen, dt_s, rate_dps, candidate, auxiliary)[0]
    return yaw_deg


def stepped_sigma(
    chosen: Filter, dt_s: Floats, rate_dps: Floats, candidate: Floats, auxiliary: Auxiliary = NO_AUXILIARY
) -> Floats:
    """Standard deviation of the yaw of one candidate, deg, shape (n,); NaN for a filter without it."""
    sigma_deg: Floats = _stepped(chosen, dt_s, rate_dps, candidate, auxiliary)[1]
    return sigma_deg


def _stepped(chosen: Filter, dt_s: Floats, rate_dps: Floats, candidate: Floats, auxiliary: Auxiliary) -> Floats:
    """Yaw and its standard deviation, deg, shape (2, n).

    A step takes times, not differences. Summing the differences from 0 may round the last digit of a step.
    """
    state, coefficients = chosen.state(), chosen.coefficients(chosen.params(*candidate.tolist()))
    result = np.empty((2, len(dt_s)))
    step, values = chosen.step_auxiliary, auxiliary.filled(len(dt_s))
    columns = (np.cumsum(dt_s).tolist(), rate_dps.tolist(), values.still.tolist(), values.temp_c.tolist())
    for n, (t_s, dps, still, temp_c) in enumerate(zip(*columns, strict=True)):
        step(coefficients, state, t_s, dps, still, temp_c)
        result[:, n] = state.yaw_deg, state.yaw_sigma_deg
    return result


def stepped_sums(
    chosen: Filter,
    dt_s: Floats,
    rate_dps: Floats,
    reference_deg: Floats,
    params: Floats,
    auxiliary: Auxiliary = NO_AUXILIARY,
) -> Floats:
    """Sums as in `Kernel.sums` for candidates, shape (c, parameters)."""
    has_reference = np.isfinite(reference_deg)
    result = np.empty((3, len(params)))
    with np.errstate(over="ignore", invalid="ignore"):
        for row, candidate in enumerate(params):
            error_deg = np.abs(
                stepped_yaw(chosen, dt_s, rate_dps, candidate, auxiliary)[has_reference] - reference_deg[has_reference]
            )
            result[:, row] = np.sum(error_deg * error_deg), np.sum(error_deg), np.max(error_deg)
    return np.where(np.isfinite(result), result, np.inf)
