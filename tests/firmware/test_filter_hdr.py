"""HDR in C against HDR in Python, sample by sample."""

from itertools import pairwise
from math import inf, nan

import numpy as np
import pytest
from c_filter_support import CFilters
from hdr_reference import CASES
from hypothesis import given
from hypothesis import strategies as st
from recordings_support import Recordings, packed_names

from gyrodrift.filters.hdr import HdrParams, HdrState, coefficients, step
from gyrodrift.session.files import load_session
from gyrodrift.values.arrays import Floats

FLOAT_DEG_H = 0.01
"""Largest yaw difference of a float, deg for each hour begun."""

rates = st.one_of(st.floats(-2.0, 2.0), st.sampled_from([0.0, -0.0, nan, inf, -inf, 300.0, -300.0, 1e12, -1.1e12]))
steps_s = st.one_of(st.floats(1e-4, 0.1), st.sampled_from([0.01, 0.01, 0.01, 0.0, -0.05, 5.0, 1e-13, 1e15, nan, inf]))
settings = st.builds(
    HdrParams,
    i_c_dps=st.floats(0.0, 0.1),
    tau_s=st.floats(0.0, 5.0),
    theta_w_dps=st.floats(0.01, 10.0),
    c1=st.floats(0.0, 5.0),
    c2=st.floats(0.0, 10.0),
)


def in_python(t_s: Floats, rate_dps: Floats, params: HdrParams | None = None) -> tuple[Floats, Floats]:
    """Taken, and the outputs after each sample."""
    c, s = coefficients(params or HdrParams()), HdrState()
    taken, rows = [], []
    for t, rate in zip(t_s.tolist(), rate_dps.tolist(), strict=True):
        taken.append(step(c, s, t, rate))
        rows.append((s.yaw_deg, s.bias_dps, s.lpf_dps, s.omega_dps, s.omega_d_dps, s.samples, s.rejected))
    return np.array(taken), np.array(rows)


def values_of(params: HdrParams) -> list[float]:
    return [params.i_c_dps, params.tau_s, params.theta_w_dps, params.c1, params.c2]


@pytest.mark.parametrize("name", packed_names())
def test_recordings_give_the_same_bits_in_double(c_filters: CFilters, recordings: Recordings, name: str) -> None:
    session = load_session(recordings.path(name))
    taken, rows = in_python(session.t_device_s, session.rate_dps)
    output = c_filters.get("filter_hdr.c", "double").run(session.t_device_s, session.rate_dps)
    assert (output.taken == taken).all()
    assert np.array_equal(output.rows, rows)


@pytest.mark.parametrize("name", packed_names())
def test_recordings_give_the_same_yaw_in_float(c_filters: CFilters, recordings: Recordings, name: str) -> None:
    session = load_session(recordings.path(name))
    taken, rows = in_python(session.t_device_s, session.rate_dps)
    output = c_filters.get("filter_hdr.c", "float").run(session.t_device_s, session.rate_dps)
    hours = max(1.0, np.ptp(session.t_device_s) / 3600.0)
    assert (output.taken == taken).all()
    assert np.abs(output.rows[:, 0] - rows[:, 0]).max() < FLOAT_DEG_H * hours


@pytest.mark.parametrize("case", CASES)
def test_worked_cases_give_the_same_bits(c_filters: CFilters, case: str) -> None:
    """Gaps, steps of other lengths, turns, zeros and other parameters."""
    params, stream = CASES[case]
    t_s, rate_dps = np.array(stream).T
    output = c_filters.get("filter_hdr.c", "double").run(t_s, rate_dps, values_of(params))
    assert np.array_equal(output.rows, in_python(t_s, rate_dps, params)[1])


@given(params=settings, stream=st.lists(st.tuples(steps_s, rates), min_size=1, max_size=200))
def test_any_samples_give_the_same_bits(
    c_filters: CFilters, params: HdrParams, stream: list[tuple[float, float]]
) -> None:
    """Damaged times and rates included, with what is refused."""
    steps, rate_dps = np.array(stream).T
    t_s = np.where(np.isfinite(steps), np.cumsum(np.nan_to_num(steps, posinf=0.0)), steps)
    taken, rows = in_python(t_s, rate_dps, params)
    output = c_filters.get("filter_hdr.c", "double").run(t_s, rate_dps, values_of(params))
    assert output.is_valid
    assert (output.taken == taken).all()
    assert np.array_equal(output.rows, rows)
    single = c_filters.get("filter_hdr.c", "float").run(t_s, rate_dps, values_of(params))
    assert np.isfinite(single.rows).all()


@pytest.mark.parametrize("real", ["float", "double"])
def test_a_copy_of_the_state_saves_the_filter(c_filters: CFilters, real: str) -> None:
    rng = np.random.default_rng(1)
    t_s, rate_dps = np.arange(2000) * 0.01, rng.normal(0.1, 0.2, 2000)
    library = c_filters.get("filter_hdr.c", real)
    assert np.array_equal(library.run(t_s, rate_dps).rows, library.run(t_s, rate_dps, saved_after=777).rows)


@pytest.mark.parametrize(("rate_dps", "level_dps"), [(0.1, 0.05), (40.0, 3.0), (-300.0, 100.0)])
def test_an_hour_at_200_hz_in_float_keeps_yaw(c_filters: CFilters, rate_dps: float, level_dps: float) -> None:
    """Slow and fast turns, up to a million degrees: 0.01 degrees, or what a float of that size resolves."""
    rng = np.random.default_rng(2)
    t_s = np.arange(720_000) * 0.005
    swing = rate_dps + level_dps * np.sin(t_s / 7.0) + rng.normal(0.0, 0.1, len(t_s))
    counts = np.rint(swing * 65.5) / 65.5
    single = c_filters.get("filter_hdr.c", "float").run(t_s, counts).rows[:, 0]
    whole = c_filters.get("filter_hdr.c", "double").run(t_s, counts.astype(np.float32)).rows[:, 0]
    resolution_deg = np.spacing(np.float32(np.abs(whole).max()))
    print(f"{rate_dps} deg/s: {np.abs(single - whole).max():.5f} deg at {np.abs(whole).max():.0f} deg")
    assert np.abs(single - whole).max() < FLOAT_DEG_H + resolution_deg


@pytest.mark.parametrize("real", ["float", "double"])
def test_the_clock_of_microseconds_wraps(c_filters: CFilters, real: str) -> None:
    rng = np.random.default_rng(3)
    t_us = 2**32 - 5_000_000 + np.cumsum(rng.integers(4000, 6000, 3000)).astype(float)
    t_us[1000], t_us[2000] = t_us[999], t_us[1998]
    rate_dps = rng.normal(0.1, 0.2, len(t_us))
    library = c_filters.get("filter_hdr.c", real)
    by_clock, by_seconds = library.run(t_us % 2**32, rate_dps, is_us=True), library.run(t_us * 1e-6, rate_dps)
    assert (by_clock.taken == by_seconds.taken).all()
    assert by_clock.taken.sum() == len(t_us) - 2
    assert np.allclose(by_clock.rows[:, 0], by_seconds.rows[:, 0], atol=1e-5)


def test_the_bounds_of_the_clock_are_half_its_range(c_filters: CFilters) -> None:
    """A step of half an hour is a gap; one beyond it counts as back."""
    library = c_filters.get("filter_hdr.c", "float")
    steps = [2**31 - 1, 2**31]
    taken = [library.run([5.0, 5.0 + step_us], [0.0, 0.0], is_us=True).taken.tolist() for step_us in steps]
    assert taken == [[True, True], [True, False]]
    assert [later - earlier for earlier, later in pairwise(steps)] == [1]


def test_a_slow_turn_keeps_its_digits_in_float_after_many_turns(c_filters: CFilters) -> None:
    """1000 s at 7.2 deg/s, then 200 s at 0.02 deg/s, at 200 Hz: a plain sum of floats loses a degree of the slow part.

    Above 4096 deg a float has steps of 0.0005 deg, and a sample of the slow turn has 0.0001 deg.
    """
    t_s = np.arange(240_000) / 200.0
    rate_dps = np.where(t_s < 1000.0, 7.2, 0.02)
    params = [0.0, 0.0, 1.0, 0.0, 1.0]
    yaw_deg = c_filters.get("filter_hdr.c", "float").run(t_s, rate_dps, params).rows[:, 0]
    assert yaw_deg[199_999] == pytest.approx(7200.0, abs=0.05)
    assert yaw_deg[-1] - yaw_deg[199_999] == pytest.approx(4.0, abs=0.01)
