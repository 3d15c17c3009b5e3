"""Reference of a session: accepted samples, steps and reference angle."""

from math import inf, nan

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gyrodrift.evaluation.kernels.hdr import yaw
from gyrodrift.evaluation.reference import accepted, reference_of
from gyrodrift.filters.hdr import HdrParams, HdrState, coefficients, step
from gyrodrift.session.session import Session, unwrapped
from gyrodrift.values.arrays import Floats
from gyrodrift.values.errors import DataError

times = st.one_of(st.floats(-1e6, 1e6), st.sampled_from([0.0, -0.0, 1.0, 1.0, 2.0, 3.0, nan, inf, -inf, 5e-324]))
rates = st.one_of(st.floats(-300.0, 300.0), st.sampled_from([nan, inf, -inf]))


def session(t_s: list[float], encoder_deg: list[float] | None, rate_dps: list[float] | None = None) -> Session:
    encoder = None if encoder_deg is None else np.array(encoder_deg)
    return Session("walk", np.array(t_s), np.array(rate_dps or [1.0] * len(t_s)), encoder_deg=encoder)


def taken(t_s: Floats, rate_dps: Floats) -> list[bool]:
    """Whether `filter.step` accepts a sample, for every sample."""
    c, state = coefficients(HdrParams()), HdrState()
    return [step(c, state, t, rate) for t, rate in zip(t_s.tolist(), rate_dps.tolist(), strict=True)]


@given(st.lists(st.tuples(times, rates), max_size=50))
def test_a_sample_is_accepted_if_the_filter_accepts_it(stream: list[tuple[float, float]]) -> None:
    """The stream has times that repeat, go back or are NaN, and rates that are NaN, also at the start."""
    t_s, rate_dps = np.array(stream, dtype=np.float64).reshape(-1, 2).T
    assert accepted(t_s, rate_dps).tolist() == taken(t_s, rate_dps)


@settings(deadline=None)  # the compiler has its turn in the first example
@given(st.lists(st.tuples(times, rates), max_size=50))
def test_steps_of_time_have_the_bits_of_the_filter(stream: list[tuple[float, float]]) -> None:
    """The kernel on the reference ends at the yaw of the filter on the session."""
    good = [(0.125, 1.0), (0.25, 1.0), *stream]
    t_s, rate_dps = (np.array(column) for column in zip(*good, strict=True))
    reference = reference_of(Session("walk", t_s, rate_dps), is_still=True)
    p = HdrParams()
    c, state = coefficients(p), HdrState()
    for t, rate in good:
        step(c, state, t, rate)
    params = np.array([p.i_c_dps, p.tau_s, p.theta_w_dps, p.c1, p.c2])
    assert yaw(reference.dt_s, reference.rate_dps, params)[-1] == state.yaw_deg
    assert len(reference.dt_s) == state.samples


def test_a_reference_begins_at_the_first_sample_with_an_angle() -> None:
    reference = reference_of(session([0.0, 1.0, 2.0, 4.0, 5.0], [nan, 10.0, 11.0, nan, 13.5]))
    assert reference.dt_s.tolist() == [0.0, 1.0, 2.0, 1.0]
    np.testing.assert_array_equal(reference.reference_deg, [0.0, 1.0, nan, 3.5])
    assert (reference.name, reference.minutes, reference.sample_rate_hz) == ("walk", 4.0 / 60.0, 1.0)


def test_a_rejected_sample_loses_its_reference_too() -> None:
    reference = reference_of(session([0.0, 1.0, 0.5, 2.0, 3.0], [0.0, 1.0, 9.0, 9.0, 3.0], [1.0, 1.0, 1.0, nan, 1.0]))
    assert reference.dt_s.tolist() == [0.0, 1.0, 2.0]
    assert reference.reference_deg.tolist() == [0.0, 1.0, 3.0]


def test_the_reference_of_a_still_is_zero() -> None:
    assert reference_of(session([0.0, 1.0, 2.0], None), is_still=True).reference_deg.tolist() == [0.0] * 3
    assert reference_of(session([0.0, 1.0], [5.0, 8.0]), is_still=True).reference_deg.tolist() == [0.0] * 2


def test_a_session_without_an_encoder_is_refused_by_name() -> None:
    """The message names the option for a device that did not move."""
    with pytest.raises(DataError, match=r"walk: has no encoder.*--still"):
        reference_of(session([0.0, 1.0], None))


@pytest.mark.parametrize("encoder_deg", [[nan, nan], [nan, 3.0], [5.0, nan]])
def test_fewer_than_two_references_are_refused(encoder_deg: list[float]) -> None:
    """A single angle has no error."""
    with pytest.raises(DataError, match="at least 2 are needed"):
        reference_of(session([0.0, 1.0], encoder_deg))


@given(st.lists(st.floats(-170.0, 170.0), min_size=1, max_size=60), st.sampled_from([0.0, -180.0]), st.booleans())
def test_a_wrapped_angle_is_unwrapped(turns_deg: list[float], low_deg: float, has_gap: bool) -> None:  # noqa: FBT001 - drawn by hypothesis
    """The range is 0 to 360 or −180 to 180, with a missing value inside."""
    true_deg = np.cumsum([low_deg + 180.0, *turns_deg])
    wrapped = low_deg + np.mod(true_deg - low_deg, 360.0)
    if has_gap:
        true_deg, wrapped = np.insert(true_deg, 1, nan), np.insert(wrapped, 1, nan)
    np.testing.assert_allclose(unwrapped(wrapped), true_deg, atol=1e-6)


def test_an_unwrapped_angle_is_unchanged() -> None:
    angle_deg = np.array([0.0, 200.0, 500.0, 300.0, nan, -100.0])
    assert unwrapped(angle_deg) is angle_deg
