"""Plain stepping beside the compiled kernels: the same yaw and the same sums."""

from dataclasses import astuple, replace
from math import inf

import numpy as np
import pytest

from gyrodrift.values.arrays import Floats

pytest.importorskip("numba", reason="kernels need the workstation extra")
from gyrodrift.evaluation.auxiliary import NO_AUXILIARY
from gyrodrift.evaluation.kernels.kernel import groups, kernel_of
from gyrodrift.filters.filter import Filter
from gyrodrift.filters.hdr import HdrCoefficients, HdrState
from gyrodrift.filters.registry import FILTERS


def session() -> tuple[Floats, Floats, Floats]:
    """Rests and turns with noise; samples in exact eighths of a second, some without a reference."""
    rng = np.random.default_rng(5)
    dt_s = np.full(900, 0.125)
    dt_s[0] = 0.0
    rate_dps = 0.3 + rng.normal(0.0, 0.05, 900)
    rate_dps[300:500] += 20.0
    reference_deg = np.concatenate([np.zeros(300), np.arange(200) * 2.5, np.full(400, 500.0)])
    reference_deg[::7] = np.nan
    return dt_s, rate_dps, reference_deg


def candidates(chosen: Filter) -> Floats:
    return np.array([astuple(chosen.params()), astuple(chosen.baseline)])


@pytest.mark.parametrize("chosen", FILTERS.values(), ids=FILTERS)
def test_stepping_gives_the_results_of_the_kernel(chosen: Filter) -> None:
    """Times that sum without rounding give the same yaw, and sums that differ in the last digits only."""
    dt_s, rate_dps, reference_deg = session()
    compiled, stepped = kernel_of(chosen), kernel_of(replace(chosen, kernel=""))
    results = candidates(chosen)
    for candidate in results:
        assert (
            stepped.yaw(dt_s, rate_dps, candidate, NO_AUXILIARY).tolist()
            == compiled.yaw(dt_s, rate_dps, candidate, NO_AUXILIARY).tolist()
        )
    ours = stepped.sums(dt_s, rate_dps, reference_deg, results, stepped.prepare(results), NO_AUXILIARY)
    theirs = compiled.sums(dt_s, rate_dps, reference_deg, results, compiled.prepare(results), NO_AUXILIARY)
    np.testing.assert_allclose(ours, theirs, rtol=1e-12)


def test_a_yaw_that_overflows_costs_inf() -> None:
    def endless(_c: HdrCoefficients, state: HdrState, _t_s: float, _rate_dps: float) -> bool:
        state.yaw_deg = inf
        return True

    stepped = kernel_of(replace(FILTERS["hdr"], kernel="", step=endless))
    dt_s, rate_dps = np.array([0.0, 0.01, 0.01]), np.zeros(3)
    results = candidates(FILTERS["hdr"])
    assert np.isinf(stepped.sums(dt_s, rate_dps, np.zeros(3), results, None, NO_AUXILIARY)).all()


def test_candidates_are_cut_into_groups_of_eight() -> None:
    assert groups(19) == [slice(0, 8), slice(8, 16), slice(16, 19)]
    assert groups(0) == []
