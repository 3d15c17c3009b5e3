"""The compiled walk against `filter.step`: the same bits, whatever the parameters and the samples."""

from dataclasses import astuple
from math import inf, isfinite, isnan, nan

import numpy as np
import pytest
from hdr_reference import CASES, as_printed
from hypothesis import given, settings
from hypothesis import strategies as st

from gyrodrift.evaluation.kernels import hdr as kernel
from gyrodrift.filters.hdr import ATTENUATOR_TABLE, HdrParams, HdrState, attenuated_step, coefficients, step
from gyrodrift.values.arrays import Floats

LOW = (0.0, 0.0, 1e-9, 0.0, 0.0)
HIGH = (10.0, 1000.0, 2000.0, 1000.0, 10.0)
"""Bounds of `HdrParams`; theta_w has none above 0."""

Walk = tuple[Floats, Floats, Floats]
"""dt_s, rate_dps and reference_deg of a session."""


@pytest.fixture(scope="module", autouse=True)
def _compiled() -> None:
    """Compile before the first test."""
    still = np.zeros(2), np.zeros(2), np.zeros(2)
    for candidates in (1, 2):
        kernel.sums(*still, np.ones((candidates, 5)))
    kernel.attenuated_step(1.0, 1.0, 1.0, 1.0)


def stepped(dt_s: Floats, rate_dps: Floats, params: Floats) -> list[float]:
    """Yaw by `filter.step` with exactly these steps of time."""
    c, state, path = coefficients(HdrParams(*params.tolist())), HdrState(), []
    for t_s, rate in zip(dt_s.tolist(), rate_dps.tolist(), strict=True):
        state.t_s = 0.0
        assert step(c, state, t_s, rate)
        path.append(state.yaw_deg)
    return path


def summed(path: list[float], reference_deg: Floats) -> tuple[float, float, float, int]:
    """Squares, absolutes, worst and count of one candidate, in the order of the samples."""
    squares = absolutes = worst = 0.0
    errors = [abs(yaw - r) for yaw, r in zip(path, reference_deg.tolist(), strict=True) if isfinite(r)]
    for error in errors:
        squares, absolutes, worst = squares + error * error, absolutes + error, max(worst, error)
    return (inf, inf, inf, len(errors)) if isnan(squares) else (squares, absolutes, worst, len(errors))


def assert_twins(walked: Walk, params: Floats) -> None:
    """Assert equal bits of yaw and sums."""
    dt_s, rate_dps, reference_deg = walked
    *result, count = kernel.sums(*walked, params)
    for k, candidate in enumerate(params):
        path = stepped(dt_s, rate_dps, candidate)
        np.testing.assert_array_equal(kernel.yaw(dt_s, rate_dps, candidate), path)
        assert (*(column[k] for column in result), count) == summed(path, reference_deg)


def candidates(dice: np.random.Generator, count: int) -> Floats:
    """Ordinary parameters, with zeros and bounds among them."""
    params = np.column_stack(
        [*(10.0 ** dice.uniform(low, high, count) for low, high in ((-6, 0), (-3, 1.5), (-1.5, 1.5)))]
        + [dice.uniform(0.0, 3.0, count) for _ in range(2)]
    )
    for bound in (np.array(LOW), np.array(HIGH)):
        params = np.where(dice.random(params.shape) < 0.06, bound, params)
    return params


def walk(dice: np.random.Generator, samples: int = 2500) -> Walk:
    """Noise, rests, turns, holes in time, exact zeros and samples without a reference."""
    dt_s = np.where(dice.random(samples) < 0.5, 0.01, dice.uniform(1e-4, 0.1, samples))
    dt_s[0], dt_s[dice.integers(1, samples, 5)] = 0.0, 20.0
    rate_dps = dice.normal(dice.normal(0.0, 0.2), 10.0 ** dice.uniform(-3.0, 0.5), samples)
    rate_dps[dice.random(samples) < 0.1] = 0.0
    rate_dps[300:600] = 90.0 * np.sin(np.arange(300) / 20.0)
    rate_dps[1200:2100] = dice.choice([0.0, 0.05, -0.3])
    reference_deg = dice.normal(0.0, 5.0, samples)
    reference_deg[dice.random(samples) < 0.3] = nan
    reference_deg[0] = 0.0
    return dt_s, rate_dps, reference_deg


@pytest.mark.parametrize("seed", range(12))
def test_any_candidate_on_any_session_gives_the_bits_of_the_filter(seed: int) -> None:
    dice = np.random.default_rng(seed)
    assert_twins(walk(dice), candidates(dice, 19))


values = st.one_of(st.floats(-3.0, 3.0), st.sampled_from([0.0, -0.0, 300.0, -300.0, 5e-324, 1e12, -1e12]))
steps_s = st.one_of(st.just(0.01), st.floats(1e-6, 100.0), st.sampled_from([1e-12, 1e-9, 1e12]))
references = st.one_of(values, st.just(nan))
vectors = st.tuples(*(st.one_of(st.floats(low, high), st.just(low)) for low, high in zip(LOW, HIGH, strict=True)))


@settings(deadline=None)
@given(
    st.lists(st.tuples(steps_s, values, st.one_of(values, st.just(nan))), max_size=60), st.lists(vectors, min_size=1)
)
def test_extremes_give_the_bits_of_the_filter(samples: list[tuple[float, float, float]], params: list[Floats]) -> None:
    """Steps and rates reach the limits of the filter, and no warning is given."""
    walked = np.array([(0.0, 0.25, 0.0), *samples]).T.copy()
    assert_twins((walked[0], walked[1], walked[2]), np.array(params))


def test_runs_longer_than_the_tables_have_exact_steps() -> None:
    """A slow turn below the turn threshold is longer than both tables."""
    samples = kernel.TABLE_SIZE + 300
    assert samples > ATTENUATOR_TABLE
    dt_s = np.full(samples, 0.01)
    dt_s[0] = 0.0
    params = np.array([[1e-6, 0.5, 5.0, 0.8, 1.2], [1e-6, 0.0, 5.0, 0.0, 0.0], [1e-7, 3.0, 2000.0, 3.0, 0.4]])
    assert_twins((dt_s, np.full(samples, 1.5), np.zeros(samples)), params)


@given(vectors, st.integers(1, 10**12))
def test_a_step_equals_the_step_of_the_filter(params: tuple[float, ...], run: int) -> None:
    p = HdrParams(*params)
    assert kernel.attenuated_step(p.i_c_dps, p.c1, p.c2, float(run)) == attenuated_step(p, run)


def test_a_step_is_0_if_the_power_overflows() -> None:
    assert (
        kernel.attenuated_step(1.0, 0.0, 10.0, 1e40) == attenuated_step(HdrParams(1.0, c1=0.0, c2=10.0), 10**40) == 0.0
    )


def test_grouping_and_a_used_table_change_no_bit() -> None:
    """Candidates run alone, in another order, and with the table of an earlier session."""
    dice = np.random.default_rng(5)
    first, second, params = walk(dice), walk(dice), candidates(dice, 8)
    together = np.array(kernel.sums(*second, params)[:3])
    alone = np.column_stack([np.array(kernel.sums(*second, row[np.newaxis])[:3])[:, 0] for row in params])
    backwards = np.array(kernel.sums(*second, params[::-1])[:3])[:, ::-1]
    table = kernel.new_step_table(len(params))
    kernel.group_sums(*first, params, table)
    for result in (alone, backwards, kernel.group_sums(*second, params, table)):
        np.testing.assert_array_equal(result, together)


def test_a_candidate_that_overflows_costs_inf() -> None:
    dt_s, rate_dps, reference_deg = np.array([0.0, 0.01, 1e10, 0.01]), np.array([0.0, 0.1, 1e300, 0.1]), np.zeros(4)
    overflowing = kernel.sums(dt_s, rate_dps, reference_deg, np.array([[0.0006, 0.9, 0.5, 0.8, 1.2]] * 2))
    assert [list(column) for column in overflowing[:3]] == [[inf, inf]] * 3
    assert overflowing[3] == 4


def test_a_squared_error_that_overflows_is_inf() -> None:
    dt_s, rate_dps = np.array([0.0, 1.0]), np.array([0.0, 1e200])
    squares, absolutes, worst, _ = kernel.sums(dt_s, rate_dps, np.zeros(2), np.array([[0.0, 0.0, 1.0, 0.0, 0.0]]))
    assert (squares[0], absolutes[0], worst[0]) == (inf, 1e200, 1e200)


@pytest.mark.parametrize("samples", [1, 2])
def test_the_shortest_sessions_have_a_yaw(samples: int) -> None:
    """Yaw is 0 at the first sample."""
    dt_s, rate_dps = np.array([0.0, 0.5])[:samples], np.array([3.0, 3.0])[:samples]
    *_, worst, count = kernel.sums(dt_s, rate_dps, np.zeros(samples), np.array([[0.0, 0.0, 1.0, 0.0, 0.0]] * 2))
    assert (worst.tolist(), count) == ([1.5 * (samples - 1)] * 2, samples)


@pytest.mark.parametrize("lengths", [(3, 2, 3, 5), (3, 3, 2, 5), (0, 0, 0, 5), (3, 3, 3, 4)])
def test_arrays_of_different_lengths_are_refused(lengths: tuple[int, int, int, int]) -> None:
    """The compiled loop does not check bounds."""
    dt_s, rate_dps, reference_deg = (np.zeros(length) for length in lengths[:3])
    with pytest.raises(ValueError, match="one length"):
        kernel.sums(dt_s, rate_dps, reference_deg, np.ones((2, lengths[3])))


def test_no_candidates_have_no_sums() -> None:
    """A search may have no candidates."""
    squares, *_, count = kernel.sums(np.zeros(3), np.zeros(3), np.zeros(3), np.empty((0, 5)))
    assert (len(squares), count) == (0, 3)


def test_arguments_are_not_changed() -> None:
    """Candidates, also as a view of a larger array, and sessions keep their values."""
    dice = np.random.default_rng(1)
    walked, params = walk(dice, 2200), candidates(dice, 24)[::2]
    params[0, 0] = 0.0
    before = [array.copy() for array in (*walked, params)]
    kernel.sums(*walked, params)
    for now, then in zip((*walked, params), before, strict=True):
        np.testing.assert_array_equal(now, then)


@pytest.mark.parametrize("case", CASES)
def test_yaw_equals_an_independent_program_to_a_billionth(case: str) -> None:
    """The other program was written from the equations alone."""
    p, stream = CASES[case]
    t_s, rate_dps = np.array(stream).T
    yaw_deg = [row[-1] for row in as_printed(p, stream)]
    result = kernel.yaw(np.diff(t_s, prepend=t_s[0]), np.ascontiguousarray(rate_dps), np.array(astuple(p)))
    np.testing.assert_allclose(result, yaw_deg, rtol=0.0, atol=1e-9)
