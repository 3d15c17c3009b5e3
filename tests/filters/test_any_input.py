"""Every filter, whatever it is fed and however it is set: through what all filters share, and nothing else."""

from collections.abc import Iterable
from math import inf, isfinite, isnan, nextafter, sin
from random import Random
from typing import Any, get_type_hints

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from gyrodrift.filters.filter import Filter, FilterState
from gyrodrift.filters.registry import FILTERS

SMALLEST = 5e-324
any_filter = pytest.mark.parametrize("expected", FILTERS.values(), ids=list(FILTERS))


def bounds_of(annotation: Any) -> tuple[float, float]:
    """The least and the largest value that a parameter may have."""
    low, high = -inf, inf
    for bound in annotation.__metadata__:
        values = {name: float(getattr(bound, name)) for name in ("ge", "gt", "le", "lt") if hasattr(bound, name)}
        low = max(low, values.get("ge", low), nextafter(values.get("gt", -inf), inf))
        high = min(high, values.get("le", high), nextafter(values.get("lt", inf), -inf))
    return low, high


def spread(low: float, high: float) -> st.SearchStrategy[float]:
    """Values of any size between two bounds."""
    return st.floats(0.0, 308.0).map(lambda power: min(high, max(low, high * 10.0**-power)))


def settings_of(expected: Filter) -> st.SearchStrategy[Any]:
    """Any that a config may hold: at the bounds, next to them, and of any size between."""
    hints = get_type_hints(expected.params, include_extras=True)
    values = {}
    for name in expected.names:
        bounds = bounds_of(hints[name])
        values[name] = st.one_of(st.just(getattr(expected.params(), name)), st.sampled_from(bounds), spread(*bounds))
    return st.builds(expected.params, **values)


finite = st.floats(allow_nan=False, allow_infinity=False)
steps_s = st.one_of(st.just(0.01), st.floats(1e-6, 10.0), st.sampled_from([1e-300, 1e5, 1e9, 1e15, 1e300, 0.0, -1.0]))
rates_dps = st.one_of(st.floats(-300.0, 300.0), st.sampled_from([0.0, 0.061, 1e6, -1e9]), finite)
runs = st.lists(st.tuples(steps_s, rates_dps, st.integers(1, 120)), min_size=1, max_size=12)


def assert_in_bounds(expected: Filter, state: FilterState) -> None:
    assert isfinite(state.yaw_deg)
    assert isfinite(state.bias_dps)
    if isnan(expected.state().yaw_sigma_deg):
        return
    assert 0.0 <= state.yaw_sigma_deg < inf
    assert 0.0 <= state.bias_sigma_dps < inf
    assert -1e-9 <= state.rest_probability <= 1.0 + 1e-9
    assert -1e-9 <= state.confidence <= 1.0 + 1e-9
    weights = [item.weight for item in getattr(state, "hypotheses", ()) if item.weight > 0.0]
    assert not weights or sum(weights) == pytest.approx(1.0, abs=1e-6)


@any_filter
@given(data=st.data(), moves=runs, start_s=st.one_of(st.just(0.0), finite))
def test_what_a_filter_says_stays_in_bounds(
    expected: Filter, data: st.DataObject, moves: list[tuple[float, float, int]], start_s: float
) -> None:
    params = data.draw(settings_of(expected))
    c, s, t_s = expected.coefficients(params), expected.state(), start_s
    for step_s, rate_dps, count in moves:
        for _ in range(count):
            t_s += step_s
            expected.step(c, s, t_s, rate_dps)
            assert_in_bounds(expected, s)


@any_filter
@given(data=st.data())
@example(data=None)
def test_the_smallest_settings_are_settings(expected: Filter, data: st.DataObject | None) -> None:
    """A rest, a turn and a rest, at values next to nothing."""
    hints = get_type_hints(expected.params, include_extras=True)
    low = {name: max(SMALLEST, bounds_of(hints[name])[0]) for name in expected.names}
    if data is not None:
        low |= {name: getattr(expected.params(), name) for name in data.draw(st.sets(st.sampled_from(expected.names)))}
    c, s, random = expected.coefficients(expected.params(**low)), expected.state(), Random(1)
    for i in range(600):
        expected.step(c, s, i * 0.01, random.gauss(0.3, 0.05) + (50.0 if 200 < i < 300 else 0.0))
        assert_in_bounds(expected, s)


def yaw_after(expected: Filter, rates: Iterable[float]) -> float:
    """At 100 Hz and defaults, deg."""
    c, s = expected.coefficients(expected.params()), expected.state()
    for i, rate_dps in enumerate(rates):
        expected.step(c, s, i * 0.01, rate_dps)
        assert_in_bounds(expected, s)
    return float(s.yaw_deg)


@any_filter
def test_steps_next_to_nothing_are_none(expected: Filter) -> None:
    c, s = expected.coefficients(expected.params()), expected.state()
    for i, rate_dps in enumerate((1e9, -1e9, 1e9, -1e9)):
        expected.step(c, s, i * 1e-300, rate_dps)
        assert_in_bounds(expected, s)
    assert (s.samples, s.rejected) == (1, 3)


STILL = 6000
"""A minute at rest."""


def test_a_constant_stream_does_not_turn() -> None:
    """A device that stands still from the beginning and whose noise is below its resolution."""
    for bias_dps in (0.0, 0.061, 0.35, -0.35):
        assert abs(yaw_after(FILTERS["restlevel"], [bias_dps] * STILL)) < 0.5


def test_a_coarse_stream_does_not_turn() -> None:
    """Steps of 0.061 deg/s and noise far below one: now and then another count, or none at all."""
    random, lsb_dps = Random(2), 0.061
    for bias_dps in (0.30, 0.33):
        rates = [lsb_dps * round(random.gauss(bias_dps, 0.009) / lsb_dps) for _ in range(STILL)]
        assert abs(yaw_after(FILTERS["restlevel"], rates)) < 1.0


def test_a_stream_that_freezes_at_rest_goes_on_resting() -> None:
    """A sensor that repeats its last value, which was that of a rest."""
    random = Random(3)
    rates = [random.gauss(0.35, 0.05) for _ in range(STILL)]
    assert abs(yaw_after(FILTERS["restlevel"], [*rates, *[0.35] * STILL])) < 1.0


def test_a_turn_between_rests_is_kept() -> None:
    """Ninety degrees, as a person would expect after all of that."""
    random = Random(4)
    turn = [30.0 * sin(i * 0.01) ** 2 for i in range(600)]
    rates = [random.gauss(0.35, 0.05) + true for true in [*[0.0] * 3000, *turn, *[0.0] * 3000]]
    assert yaw_after(FILTERS["restlevel"], rates) == pytest.approx(0.01 * sum(turn), abs=1.0)
