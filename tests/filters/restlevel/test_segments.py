"""Stationary blocks and constant-rate segments of restlevel, on blocks made by hand."""

import pytest

from gyrodrift.filters.restlevel.model import RestlevelParams, RestlevelState
from gyrodrift.filters.restlevel.noise import is_stationary, learn_at_rest, sensor_odds
from gyrodrift.filters.restlevel.rate_state import BlockStats, NoiseModel
from gyrodrift.filters.restlevel.segments import (
    continues,
    goes_on_gradually,
    is_from_start,
    track_segment,
    update_mean,
)
from gyrodrift.filters.restlevel.step import coefficients

C = coefficients(RestlevelParams())


def block(variance: float, seconds: float = 0.3) -> BlockStats:
    """Ten samples of one variance."""
    return BlockStats(seconds=seconds, samples=10, sum_squares=10.0 * variance)


def track(s: RestlevelState, *means_dps: float, variance: float = 0.01, seconds: float = 0.3) -> None:
    """Blocks with these means, one after the other."""
    s.block = block(variance, seconds)
    for mean_dps in means_dps:
        track_segment(C, s, mean_dps, mean_dps - s.segment.last_mean_dps, seconds)
        if s.segment.blocks > 1:
            update_mean(s.segment, mean_dps)


def test_the_first_block_is_the_noise() -> None:
    noise = NoiseModel()
    assert is_stationary(C, block(0.01), noise)
    assert noise.sample_var == pytest.approx(0.01)
    assert noise.angle_walk_var == pytest.approx(0.0006)
    assert noise.stationary_blocks == 1


def test_a_noisy_block_is_not_stationary_and_raises_the_noise_slowly() -> None:
    noise = NoiseModel()
    is_stationary(C, block(0.01), noise)
    assert not is_stationary(C, block(0.1), noise)
    assert noise.sample_var == pytest.approx(0.01 * 1.0003)


def test_two_blocks_far_below_the_noise_are_the_noise() -> None:
    """The larger of the two: 4.5 sigmas below are a factor of exp(−2.01)."""
    noise = NoiseModel()
    is_stationary(C, block(1.0), noise)
    is_stationary(C, block(0.01), noise)
    assert noise.sample_var > 0.1
    is_stationary(C, block(0.008), noise)
    assert noise.sample_var == pytest.approx(0.01)


def test_a_sensor_that_repeats_itself_has_the_noise_of_its_resolution() -> None:
    noise = NoiseModel(resolution_dps=0.2)
    is_stationary(C, block(0.0), noise)
    assert noise.sample_var == pytest.approx(0.01)


def test_a_sensor_that_said_one_thing_so_far_has_its_noise_to_come() -> None:
    noise = NoiseModel()
    for _ in range(30):
        assert is_stationary(C, block(0.0), noise)
    noise.resolution_dps = 0.01
    is_stationary(C, block(0.25), noise)
    assert noise.sample_var == pytest.approx(0.25)
    assert is_stationary(C, block(0.25), noise)


def test_a_sensor_of_coarse_steps_that_sets_out_is_not_taken_for_noise() -> None:
    noise = NoiseModel()
    for _ in range(30):
        assert is_stationary(C, block(0.0), noise)
    noise.resolution_dps = 0.1
    assert not is_stationary(C, block(400.0), noise)
    assert is_stationary(C, block(0.0), noise)


def test_means_of_coarse_steps_are_no_better_known_than_steps_allow() -> None:
    noise, full = NoiseModel(angle_walk_var=0.01, resolution_dps=0.2, has_steps=True), block(0.0)
    for _ in range(1000):
        learn_at_rest(noise, 1.0, 0.0, 0.0, full, 0.3)
    assert noise.angle_walk_var == pytest.approx(0.25 * 0.2**2 / full.samples * 0.3)


@pytest.mark.parametrize(("sigma_dps", "odds"), [(0.01, 1.0), (0.06, 1.0), (0.3, 1.0), (1.4, 0.025), (20.0, 1.7e-7)])
def test_what_is_louder_than_sensors_are_is_a_motion(sigma_dps: float, odds: float) -> None:
    """Hovering, or a ride: no part has a noise of a degree a second."""
    assert sensor_odds(sigma_dps**2) == pytest.approx(odds, rel=0.1)


def test_a_rest_is_from_the_start_where_nothing_has_moved_before() -> None:
    for means, expected in (([1.0] * 5, True), ([9.0, *[1.0] * 5], True), ([1.0, 9.0, *[1.0] * 5], False)):
        s = RestlevelState()
        track(s, *means)
        assert is_from_start(s, 0.3) is expected
    track(s := RestlevelState(), *[1.0] * 15)
    assert not is_from_start(s, 0.3)


def test_angle_random_walk_is_measured_at_rests() -> None:
    noise = NoiseModel(angle_walk_var=0.01)
    learn_at_rest(noise, 0.4, 0.0, 0.2, block(0.0), 1.0)
    assert noise.angle_walk_var == pytest.approx(0.01 + 0.02 * (0.02 - 0.01))
    assert not noise.is_walk_measured
    noise.angle_walk_var = 0.01
    learn_at_rest(noise, 1.0, 0.5, 10.0, block(0.0), 1.0)
    assert noise.angle_walk_var == pytest.approx(0.01 + 0.05 * (0.09 - 0.01))
    assert noise.is_walk_measured
    assert noise.flicker_var == pytest.approx(0.001)


def test_five_blocks_of_one_mean_are_a_segment_that_ends_with_another_mean() -> None:
    s = RestlevelState()
    track(s, *[1.0] * 5)
    assert (s.segment.blocks, s.segment.mean_dps) == (5, 1.0)
    track(s, 2.0)
    assert (s.segment.blocks, s.segment.mean_dps) == (1, 2.0)
    assert (s.ended.mean_dps, s.ended.blocks_ago) == (1.0, 1)
    assert not s.ended.ended_gradually


def test_a_slope_is_no_segment() -> None:
    s = RestlevelState()
    track(s, 0.0, 0.05, 0.1, 0.15)
    assert s.segment.blocks == 4
    track(s, 0.2)
    assert s.segment.blocks == 0


@pytest.mark.parametrize(("seconds", "rests"), [(0.3, 0), (1.2, 3)])
def test_a_slow_sensor_that_sets_out_had_a_rest_from_the_start(seconds: float, rests: int) -> None:
    """Three blocks of a slow one last 3.6 s, those of a fast one less than a second."""
    s = RestlevelState()
    track(s, 0.5, 0.5, 0.5, seconds=seconds)
    track(s, 8.0, variance=4.0, seconds=seconds)
    assert s.ended.short_start_blocks == rests
    track(s, 8.0, variance=4.0, seconds=seconds)
    assert s.ended.short_start_blocks == 0


@pytest.mark.parametrize(
    ("next_dps", "variance", "expected"), [(0.65, 1e-4, False), (3.0, 1e-4, True), (0.65, 4.0, True)]
)
def test_an_exit_that_falls_on_the_end_of_a_block_is_abrupt(
    next_dps: float, variance: float, *, expected: bool
) -> None:
    """A tenth of a deg/s in the first block of it says little; the next one tells a curve from a start."""
    s = RestlevelState()
    track(s, *[0.5] * 9, 0.6, variance=1e-4)
    assert s.ended.ended_gradually
    step_dps = next_dps - s.segment.last_mean_dps
    track(s, next_dps, variance=variance)
    assert goes_on_gradually(s, step_dps, 0.3) != expected


def test_a_vibration_averages_out_within_blocks_and_a_motion_does_not() -> None:
    """Samples that scatter by 2 deg/s: their block means agree to 0.01 deg/s with a motor, and to 0.5 in a motion."""
    for step_dps, is_like_a_sensor in ((0.01, True), (0.5, False)):
        s = RestlevelState()
        track(s, *[0.5 + step_dps * (number % 2) for number in range(10)], variance=4.0)
        assert s.segment.blocks == 10
        assert (s.segment.sensor_odds > 0.5) is is_like_a_sensor


def test_a_segment_ends_gradually_where_the_rate_slides_away() -> None:
    s = RestlevelState()
    track(s, *[1.0] * 5, 1.1, variance=1e-4)
    assert s.segment.blocks == 1
    assert s.ended.ended_gradually


@pytest.mark.parametrize(
    ("gap", "mean_dps", "expected"), [(1, 1.0, True), (10, 1.0, True), (11, 1.0, False), (1, 1.2, False)]
)
def test_a_segment_continues_one_of_its_mean_within_ten_blocks(gap: int, mean_dps: float, *, expected: bool) -> None:
    """Noisy blocks lie between the two."""
    s = RestlevelState()
    track(s, *[1.0] * 5)
    for block in range(gap):
        track(s, 1.0, variance=100.0**block)
    assert s.segment.blocks == 0
    track(s, *[mean_dps] * 5)
    assert s.segment.blocks == 5
    assert continues(C, s, 0.3) is expected
