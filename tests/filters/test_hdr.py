"""The recursion: worked cases, an independent reading of its equations, and the same bits however it is run."""

from dataclasses import asdict, replace
from math import inf, isnan, nan

import pytest
from hdr_reference import CASES, COLUMNS, as_printed
from hypothesis import given
from hypothesis import strategies as st

from gyrodrift.filters.hdr import ATTENUATOR_TABLE, HdrParams, HdrState, attenuated_step, coefficients, step

params = st.builds(
    HdrParams,
    i_c_dps=st.floats(0.0, 0.1),
    tau_s=st.floats(0.0, 5.0),
    theta_w_dps=st.floats(0.01, 10.0),
    c1=st.floats(0.0, 5.0),
    c2=st.floats(0.0, 3.0),
)
rates = st.one_of(st.floats(-2.0, 2.0), st.sampled_from([0.0, -0.0, nan, inf, 300.0, -300.0]))
steps_s = st.one_of(st.floats(1e-4, 0.1), st.sampled_from([0.01, 0.01, 0.01, 0.0, -0.05, 5.0, nan]))
streams = st.lists(st.tuples(steps_s, rates), max_size=200)


def run(p: HdrParams, stream: list[tuple[float, float]], state: HdrState | None = None) -> HdrState:
    state = state or HdrState()
    c = coefficients(p)
    for t_s, rate_dps in stream:
        step(c, state, t_s, rate_dps)
    return state


def timed(stream: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Steps of time as times; what a step that is no number leads to is no time."""
    t_s, out = 0.0, []
    for step_s, rate_dps in stream:
        out.append((t_s + step_s, rate_dps))
        t_s = t_s if isnan(step_s) else t_s + step_s
    return out


@pytest.mark.parametrize("case", CASES)
def test_every_column_of_a_worked_case_is_met_to_a_billionth(case: str) -> None:
    p, stream = CASES[case]
    c, state = coefficients(p), HdrState()
    for (t_s, rate_dps), row in zip(stream, as_printed(p, stream), strict=True):
        assert step(c, state, t_s, rate_dps)
        assert tuple(getattr(state, column) for column in COLUMNS) == pytest.approx(row, rel=0.0, abs=1e-9)
    assert state.samples == len(stream) == 3000


@given(params, st.lists(st.tuples(st.floats(1e-3, 0.1), st.floats(-2.0, 2.0)), min_size=1, max_size=300))
def test_the_recursion_says_what_the_equations_say(p: HdrParams, stream: list[tuple[float, float]]) -> None:
    """Stepwise and as printed over lists, from the same formulas written twice."""
    samples = timed(stream)
    c, state = coefficients(p), HdrState()
    for (t_s, rate_dps), row in zip(samples, as_printed(p, samples), strict=True):
        step(c, state, t_s, rate_dps)
        assert tuple(getattr(state, column) for column in COLUMNS) == pytest.approx(row, rel=1e-9, abs=1e-9)


@given(params, streams, st.integers(0, 200))
def test_saving_and_restoring_half_way_gives_the_same_bits(
    p: HdrParams, stream: list[tuple[float, float]], cut: int
) -> None:
    """The state is all there is."""
    samples = timed(stream)
    half_way = run(p, samples[:cut])
    restored = HdrState(**asdict(half_way))
    assert run(p, samples[cut:], restored) == run(p, samples)


@given(params, streams)
def test_a_bad_sample_is_counted_and_leaves_no_other_trace(p: HdrParams, stream: list[tuple[float, float]]) -> None:
    samples = timed(stream)
    c, state, good = coefficients(p), HdrState(), []
    for t_s, rate_dps in samples:
        if step(c, state, t_s, rate_dps):
            good.append((t_s, rate_dps))
    assert state.rejected == len(samples) - len(good)
    assert replace(state, rejected=0) == run(p, good)


@pytest.mark.parametrize(
    ("t_s", "rate_dps"), [(0.0, 1.0), (-1.0, 1.0), (0.01, nan), (0.01, inf), (nan, 1.0), (inf, 1.0)]
)
def test_these_samples_are_passed_by(t_s: float, rate_dps: float) -> None:
    c, state = coefficients(HdrParams()), HdrState()
    assert step(c, state, 0.0, 0.5)
    before = replace(state, rejected=1)
    assert not step(c, state, t_s, rate_dps)
    assert state == before


def test_a_bad_first_sample_does_not_start_the_filter() -> None:
    """Yaw starts at 0 with the first good one."""
    c, state = coefficients(HdrParams()), HdrState()
    assert not step(c, state, 0.0, nan)
    assert step(c, state, 1.0, 0.25)
    assert (state.samples, state.rejected, state.lpf_dps, state.yaw_deg) == (1, 1, 0.25, 0.0)


def test_a_hole_is_integrated_with_its_true_length() -> None:
    state = run(HdrParams(), [(0.0, 90.0), (0.01, 90.0), (2.01, 90.0), (2.02, 90.0)])
    assert state.yaw_deg == pytest.approx(90.0 * 2.02)


@given(params, st.integers(1, 10**12))
def test_the_table_and_the_formula_are_one(p: HdrParams, run_length: int) -> None:
    """Short runs come from the table, long ones from the formula, and neither ever fails."""
    value = attenuated_step(p, run_length)
    assert 0.0 <= value <= p.i_c_dps * (1.0 + p.c1)
    if run_length < ATTENUATOR_TABLE:
        assert coefficients(p).steps_dps[run_length] == value


def test_the_steepest_attenuator_ends_at_zero_instead_of_overflowing() -> None:
    """A run of 10^40 samples will not come, but must not stop a service."""
    assert attenuated_step(HdrParams(c2=10.0), 10**40) == 0.0
