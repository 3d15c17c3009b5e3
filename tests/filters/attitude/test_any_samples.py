"""The attitude filter on any samples and at any setting: finite numbers, probabilities, no warning of numpy."""

from dataclasses import fields
from math import inf, isfinite, nan
from typing import Any, get_type_hints

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gyrodrift.filters.attitude.model import AttitudeState, coefficients
from gyrodrift.filters.attitude.step import step
from gyrodrift.filters.restlevel.model import RestlevelParams

BOUNDS: dict[str, tuple[float, ...]] = {
    "window_s": (1e-9, 0.05, 0.3, 60.0),
    "quiet": (1e-9, 5.0, 100.0),
    "turn_on_dps": (0.0, 1e-9, 0.5, 1000.0),
    "walk_dps_rts": (0.0, 0.0005, 10.0),
    "drift_dps_s": (0.0, 0.004, 10.0),
    "still_start": (0.0, 0.99, 0.9999999999),
    "rest_share": (0.0, 0.2, 0.9999999999),
    "scale_percent": (0.0, 1.0, 100.0),
}
settings = st.builds(RestlevelParams, **{name: st.sampled_from(values) for name, values in BOUNDS.items()})
steps_s = st.one_of(st.just(0.01), st.floats(1e-6, 10.0), st.sampled_from([1e-300, 1e5, 1e9, 1e300, 0.0, -1.0]))
rate = st.one_of(st.floats(-300.0, 300.0), st.sampled_from([0.0, 2000.0, -9999.0, 1e300, inf, nan]))
force = st.one_of(st.floats(-20.0, 20.0), st.sampled_from([0.0, 9.81, 19.6, -157.0, 3900.0, 1e300, inf, nan]))
stills = st.sampled_from([nan, 0.0, 1.0])
vectors = st.tuples(rate, rate, rate)
forces = st.one_of(st.just((0.0, 0.0, 9.81)), st.tuples(force, force, force))
moves = st.lists(st.tuples(steps_s, vectors, forces, stills, st.integers(1, 150)), min_size=1, max_size=10)


def assert_in_bounds(s: AttitudeState) -> None:
    numbers = (*s.q, s.yaw_deg, s.yaw_sigma_deg, s.tilt_deg, s.tilt_sigma_deg, s.bias_dps, s.bias_sigma_dps)
    assert all(map(isfinite, (*numbers, *s.bias_xyz_dps, s.heading_rate_dps)))
    assert sum(part * part for part in s.q) == pytest.approx(1.0, abs=1e-3)
    assert min(s.yaw_sigma_deg, s.tilt_sigma_deg, s.bias_sigma_dps) >= 0.0
    assert -1e-9 <= s.rest_probability <= 1.0 + 1e-9
    assert 0.0 <= s.confidence <= 1.0 + 1e-9
    assert s.hypotheses.weight.sum() == pytest.approx(1.0, abs=1e-6)


@given(params=settings, moves=moves)
def test_what_the_filter_says_stays_in_bounds(params: RestlevelParams, moves: list[Any]) -> None:
    c, s, t_s = coefficients(params), AttitudeState(), 0.0
    for step_s, gyro, accel, still, count in moves:
        for _ in range(count):
            t_s += step_s
            step(c, s, t_s, gyro[0], gyro[1], gyro[2], accel[0], accel[1], accel[2], still)
            assert_in_bounds(s)


def test_all_settings_are_tried() -> None:
    assert set(BOUNDS) == {field.name for field in fields(RestlevelParams)} == set(get_type_hints(RestlevelParams))
