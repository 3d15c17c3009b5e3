"""Plain stepping beside the compiled kernels: the same yaw and the same sums."""

from dataclasses import astuple, replace
from math import inf

import numpy as np
import pytest

from gyrodrift.arrays import Floats

pytest.importorskip("numba", reason="kernels need the workstation extra")
from gyrodrift.evaluation.kernels.kernel import groups, kernel_of
from gyrodrift.evaluation.reference import NO_AUXILIARY
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
def test_stepping_is_what_the_kernel_does(chosen: Filter) -> None:
    """Times that add up without rounding leave nothing to differ in yaw, and summing only its last digits."""
    dt_s, rate_dps, reference_deg = session()
    compiled, stepped = kernel_of(chosen), kernel_of(replace(chosen, kernel=""))
    both = candidates(chosen)
    for candidate in both:
        assert (
            stepped.yaw(dt_s, rate_dps, candidate, NO_AUXILIARY).tolist()
            == compiled.yaw(dt_s, rate_dps, candidate, NO_AUXILIARY).tolist()
        )
    ours = stepped.sums(dt_s, rate_dps, reference_deg, both, stepped.prepare(both), NO_AUXILIARY)
    theirs = compiled.sums(dt_s, rate_dps, reference_deg, both, compiled.prepare(both), NO_AUXILIARY)
    np.testing.assert_allclose(ours, theirs, rtol=1e-12)


def test_a_yaw_that_leaves_the_floats_costs_the_infinite() -> None:
    """Without a warning."""

    def endless(_c: HdrCoefficients, state: HdrState, _t_s: float, _rate_dps: float) -> bool:
        state.yaw_deg = inf
        return True

    stepped = kernel_of(replace(FILTERS["hdr"], kernel="", step=endless))
    dt_s, rate_dps = np.array([0.0, 0.01, 0.01]), np.zeros(3)
    both = candidates(FILTERS["hdr"])
    assert np.isinf(stepped.sums(dt_s, rate_dps, np.zeros(3), both, None, NO_AUXILIARY)).all()


def test_candidates_are_cut_into_groups_of_eight() -> None:
    """The last one holds what is left."""
    assert groups(19) == [slice(0, 8), slice(8, 16), slice(16, 19)]
    assert groups(0) == []
