"""A filter walked through whole sessions for many candidates: its compiled kernel, or plain stepping."""

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from typing import Any

from gyrodrift.arrays import Floats
from gyrodrift.evaluation.kernels.stepped import stepped_sigma, stepped_sums, stepped_yaw
from gyrodrift.evaluation.reference import Beside
from gyrodrift.filters.filter import Filter

GROUP = 8
"""Candidates that a kernel is given at a time: two vectors of AVX2, one of AVX-512, four of NEON."""


@dataclass(frozen=True, slots=True)
class Kernel:
    """The walk of a filter.

    prepare
        From a group of at most `GROUP` candidates, shape (c, parameters), to what they need on every session.
    sums
        From steps in s, rates in deg/s and reference in deg, shape (n,), candidates, what was prepared, and what is
        known beside the rate, to sums over the samples with a reference, shape (3, c): squared errors in deg²,
        absolute errors in deg, and the largest absolute error in deg; inf where yaw left the floats.
    yaw
        From steps, rates, one candidate, shape (parameters,), and what is known beside the rate, to yaw in deg,
        shape (n,).
    sigma
        From the same to the standard deviation of yaw in deg, shape (n,); None for a filter that does not state it.
    """

    prepare: Callable[[Floats], Any]
    sums: Callable[[Floats, Floats, Floats, Floats, Any, Beside], Floats]
    yaw: Callable[[Floats, Floats, Floats, Beside], Floats]
    sigma: Callable[[Floats, Floats, Floats, Beside], Floats] | None = None


def kernel_of(chosen: Filter) -> Kernel:
    """The kernel that the filter names, or one that steps it sample by sample, which is slow and right."""
    if chosen.kernel:
        module, _, name = chosen.kernel.partition(":")
        kernel: Kernel = getattr(import_module(module), name)
        return kernel
    return Kernel(
        lambda _group: None,
        lambda dt_s, rate_dps, reference_deg, group, _, beside: stepped_sums(
            chosen, dt_s, rate_dps, reference_deg, group, beside
        ),
        lambda dt_s, rate_dps, candidate, beside: stepped_yaw(chosen, dt_s, rate_dps, candidate, beside),
        lambda dt_s, rate_dps, candidate, beside: stepped_sigma(chosen, dt_s, rate_dps, candidate, beside),
    )


def groups(candidates: int) -> list[slice]:
    """How candidates are cut into groups for a kernel."""
    return [slice(first, min(first + GROUP, candidates)) for first in range(0, candidates, GROUP)]
