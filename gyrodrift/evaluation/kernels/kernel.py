"""Kernels run a filter over whole sessions for many candidates, compiled or by plain stepping."""

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np

from gyrodrift.evaluation.auxiliary import NO_AUXILIARY, Auxiliary
from gyrodrift.evaluation.score import normal_crps
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
    result = np.empty((SUMS, len(params)))
    with np.errstate(over="ignore", invalid="ignore"):
        for row, candidate in enumerate(params):
            yaw_deg, sigma_deg = _stepped(chosen, dt_s, rate_dps, candidate, auxiliary)[:, has_reference]
            error_deg = np.abs(yaw_deg - reference_deg[has_reference])
            crps_deg = normal_crps(error_deg, sigma_deg)
            result[:, row] = np.sum(error_deg * error_deg), np.sum(error_deg), np.max(error_deg), np.sum(crps_deg)
    return infinite_where_yaw_overflows(result)


def infinite_where_yaw_overflows(sums: Floats) -> Floats:
    """Sums with inf in place of errors that are not finite, and of their CRPS; NaN stays for a filter without sigma."""
    errors = np.where(np.isfinite(sums[:3]), sums[:3], np.inf)
    has_overflown = np.isinf(errors).any(axis=0)
    return np.vstack([errors, np.where(has_overflown, np.inf, sums[3])])


SUMS = 4
"""Sums of a candidate over a session."""

GROUP = 8
"""Candidates in a group: two vectors of AVX2, one of AVX-512, four of NEON."""


@dataclass(frozen=True, slots=True)
class Kernel:
    """Functions that run a filter over a session. Arrays over samples have the shape (n,).

    prepare
        From a group of at most `GROUP` candidates, shape (c, parameters), to data that all sessions share.
    sums
        From steps in s, rates in deg/s, reference in deg, candidates, prepared data and auxiliary data to sums, shape
        (SUMS, c): squared errors in deg², absolute errors in deg, largest absolute error in deg, CRPS in deg. Samples
        without a reference are ignored. A sum is inf if yaw overflows; CRPS is NaN for a filter without a yaw sigma.
    yaw
        From steps, rates, one candidate, shape (parameters,), and auxiliary data to yaw in deg.
    sigma
        From the arguments of `yaw` to the standard deviation of yaw in deg; None for a filter without it.
    """

    prepare: Callable[[Floats], Any]
    sums: Callable[[Floats, Floats, Floats, Floats, Any, Auxiliary], Floats]
    yaw: Callable[[Floats, Floats, Floats, Auxiliary], Floats]
    sigma: Callable[[Floats, Floats, Floats, Auxiliary], Floats] | None = None


def kernel_of(chosen: Filter) -> Kernel:
    """Kernel of the filter; without one, a slow kernel that calls `step` for every sample."""
    if chosen.kernel:
        module, _, name = chosen.kernel.partition(":")
        kernel: Kernel = getattr(import_module(module), name)
        return kernel
    return Kernel(
        lambda _group: None,
        lambda dt_s, rate_dps, reference_deg, group, _, auxiliary: stepped_sums(
            chosen, dt_s, rate_dps, reference_deg, group, auxiliary
        ),
        lambda dt_s, rate_dps, candidate, auxiliary: stepped_yaw(chosen, dt_s, rate_dps, candidate, auxiliary),
        lambda dt_s, rate_dps, candidate, auxiliary: stepped_sigma(chosen, dt_s, rate_dps, candidate, auxiliary),
    )


def groups(candidates: int) -> list[slice]:
    """Slices of the candidates for a kernel."""
    return [slice(first, min(first + GROUP, candidates)) for first in range(0, candidates, GROUP)]
