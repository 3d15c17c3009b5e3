"""Kernels run a filter over whole sessions for many candidates, compiled or by plain stepping."""

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from typing import Any

from gyrodrift.evaluation.auxiliary import Auxiliary
from gyrodrift.evaluation.kernels.stepped import stepped_sigma, stepped_sums, stepped_yaw
from gyrodrift.filters.filter import Filter
from gyrodrift.values.arrays import Floats

GROUP = 8
"""Candidates in a group: two vectors of AVX2, one of AVX-512, four of NEON."""


@dataclass(frozen=True, slots=True)
class Kernel:
    """Functions that run a filter over a session. Arrays over samples have the shape (n,).

    prepare
        From a group of at most `GROUP` candidates, shape (c, parameters), to data that all sessions share.
    sums
        From steps in s, rates in deg/s, reference in deg, candidates, prepared data and auxiliary data to sums, shape
        (3, c): squared errors in deg², absolute errors in deg, largest absolute error in deg. Samples without a
        reference are ignored. A sum is inf if yaw overflows.
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
