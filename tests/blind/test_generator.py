"""The physics of the generator: what is put in is found by plain estimators, and where nothing is, nothing is."""

from collections.abc import Callable
from dataclasses import dataclass

import generator_support as further
import numpy as np
import pytest
from generator_support import COUNT_DPS, plain_batch
from gyrogap import estimators as by
from gyrogap.catalogue import EFFECTS, JUDGED
from gyrogap.physics.bench import Columns
from gyrogap.physics.kinds import KINDS, InjectedEffect
from gyrogap.physics.scene import scene_of
from gyrogap.physics.sizes import SIZES, STRENGTHS


def columns(*effects: InjectedEffect) -> Columns:
    """The heated session of a device with these effects."""
    batch = plain_batch(*effects)
    return batch.columns(next(number for number, plan in enumerate(batch.plans) if plan.heated_c))


@dataclass(frozen=True, slots=True)
class Check:
    """An effect, its estimator, what that gives without it, and how far both may be off."""

    effect: str
    parameters: dict[str, float]
    estimate: Callable[[Columns], float]
    without: float
    off_without: float
    off_with: float

    @property
    def fault(self) -> InjectedEffect:
        return InjectedEffect(self.effect, self.parameters)

    @property
    def strength(self) -> float:
        return next(iter(self.parameters.values()))


TONE = {"amplitude_dps": 0.2, "frequency_hz": 143.0}
TURN = {"amplitude_dps": 0.03, "phase_deg": 40.0}
DISC = {"amplitude_deg": 0.3, "phase_deg": 70.0}

CHECKS = [
    Check("scale_factor", {"error_percent": -1.0}, further.of_fit("scale", 100.0), 0.0, 0.02, 0.02),
    Check("scale_asymmetry", {"error_percent": 0.3}, further.of_fit("asymmetry", 100.0), 0.0, 0.02, 0.02),
    Check("vibration_rectification", {"bias_dps_at_100_dps": 0.05}, further.of_fit("square"), 0.0, 0.005, 0.005),
    Check("latency", {"delay_ms": 8.0}, further.of_fit("lead_s", -1000.0), 0.0, 0.3, 0.3),
    Check("temp_bias", {"slope_dps_per_c": 0.02, "curve_dps_per_c2": 0.0}, further.of_fit("temp"), 0.0, 0.0015, 0.0015),
    Check("temp_scale", {"slope_percent_per_c": 0.05}, further.of_fit("temp_scale", 100.0), 0.0, 0.003, 0.003),
    Check("g_sensitivity", TURN, further.amplitude("sine", "cosine"), 0.0, 0.003, 0.003),
    Check("encoder_eccentricity", DISC, further.amplitude("sine_rate", "cosine_rate"), 0.0, 0.01, 0.02),
    Check("clock_drift", {"ppm": -600.0}, by.clock_ppm, 0.0, 10.0, 10.0),
    Check("timestamp_jitter", {"sigma_ms": 0.5}, by.stamp_sigma_ms, 0.002, 0.001, 0.02),
    Check("usb_batching", {"interval_ms": 16.0}, further.arrival_spread_ms, 0.0, 1.6, 1.6),
    Check("sample_drop", {"share_percent": 1.0}, by.dropped_percent, 0.0, 0.0, 0.15),
    Check("stale_hold", {"share_percent": 4.0}, by.moving_equal_percent, 0.0, 0.4, 1.0),
    Check("quantization", {"step_dps": 0.25}, by.least_step_dps, COUNT_DPS, 1e-6, 0.006),
    Check("deadband", {"width_dps": 0.2}, further.zero_width_dps, COUNT_DPS, 1e-6, 0.006),
    Check("saturation", {"limit_dps": 125.0}, by.largest_dps, 195.0, 8.0, 0.004),
    Check("encoder_quantization", {"cpr": 720.0}, by.counts_per_turn, 36000.0, 10.0, 5.0),
    Check("vibration", TONE, further.tone_dps(143.0), 0.0, 0.004, 0.01),
    Check("backlash", {"play_deg": 0.4}, by.play_deg, 0.0, 0.02, 0.03),
]


@pytest.fixture(scope="module")
def nothing() -> Columns:
    return columns()


@pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.effect)
def test_what_is_put_in_is_found(check: Check) -> None:
    """A textbook's estimator gives the parameter that the label will state."""
    assert check.estimate(columns(check.fault)) == pytest.approx(check.strength, abs=check.off_with)


@pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.effect)
def test_without_it_nothing_is_found(check: Check, nothing: Columns) -> None:
    assert check.estimate(nothing) == pytest.approx(check.without, abs=check.off_without)


def test_noise_is_the_angle_random_walk_that_is_stated(nothing: Columns) -> None:
    """A sample scatters by noise · √rate, and neighbours know nothing of each other."""
    rate_dps = by.at_rest(nothing)
    assert np.std(rate_dps) == pytest.approx(0.0035 * np.sqrt(99.7), rel=0.05)
    assert abs(np.corrcoef(rate_dps[1:], rate_dps[:-1])[0, 1]) < 0.05


def test_slips_come_as_often_as_they_should() -> None:
    result = further.slips_deg(columns(InjectedEffect("encoder_slip", {"step_deg": 2.0, "per_hour": 120.0})))
    assert 4 <= len(result) <= 24
    assert np.abs(result) == pytest.approx(2.0, abs=0.15)


def test_flicker_has_the_floor_of_its_name() -> None:
    """The Allan deviation of 1/f noise lies at 0.664 B whatever the averaging time."""
    batch = plain_batch()
    scene = scene_of(batch.plans[0], batch.device.sample_hz, batch.path)
    result = []
    for seed in range(12):
        noise = KINDS["bias_instability"][1](
            np.zeros(len(scene.t_s)), scene, np.random.default_rng(seed), floor_dph=36.0
        )
        result.append([by.allan_dps(noise, points) ** 2 for points in (100, 400, 1600)])
    assert np.sqrt(np.mean(result, axis=0)) == pytest.approx(0.664 * 0.01, rel=0.15)


def test_a_low_pass_takes_noise_and_delays_motion() -> None:
    """A second-order filter of 5 Hz leaves a fraction of the noise, and lags by √2/(2π f)."""
    result = columns(InjectedEffect("bandwidth", {"cutoff_hz": 5.0}))
    assert np.std(by.at_rest(result)) < 0.5 * 0.0035 * np.sqrt(99.7)
    rate_dps, encoder_dps, _ = by.smooth_rates(result)
    shifts = np.arange(30)
    slow = slice(60 * 100, -100)
    errors = [np.sum(np.square(rate_dps[slow] - np.roll(encoder_dps, shift)[slow])) for shift in shifts]
    assert shifts[np.argmin(errors)] / 99.7 == pytest.approx(np.sqrt(2.0) / (2.0 * np.pi * 5.0), abs=0.015)


def test_sessions_differ_in_start_and_heat() -> None:
    for seed in range(20):
        batch = plain_batch(seed=seed)
        warm = [plan.powered_s >= 900.0 for plan in batch.plans]
        heated = [plan.heated_c >= 8.0 for plan in batch.plans]
        assert (sum(warm), sum(heated)) == (1, 1)
        assert warm.index(True) != heated.index(True)
    first = batch.columns(warm.index(True))
    assert 900.0 <= first.t_device_s[0] <= 2001.0
    assert np.ptp(batch.columns(heated.index(True)).temp_c) > 6.0


def test_motion_is_rich() -> None:
    batch = plain_batch()
    for number, plan in enumerate(batch.plans):
        scene = scene_of(plan, 100.0, (*batch.path, number))
        assert scene.rate_dps.min() < -185.0
        assert scene.rate_dps.max() > 185.0
        assert np.mean(scene.rate_dps == 0.0) > 0.15
        assert np.ptp(scene.angle_deg) > 720.0
        assert np.abs(scene.acceleration_dpss).max() > 1000.0
        assert not scene.rate_dps[:3000].any()
        assert scene.fine_hz >= 800.0


def test_angle_is_the_integral_of_rate() -> None:
    scene = scene_of(plain_batch().plans[0], 100.0, ("integral",))
    for start in range(0, len(scene.t_s) - 1000, 1000):
        part = slice(start * scene.fine, (start + 1000) * scene.fine + 1)
        turned_deg = np.trapezoid(scene.fine_dps[part], dx=1.0 / scene.fine_hz)
        assert scene.angle_deg[start + 1000] - scene.angle_deg[start] == pytest.approx(turned_deg, abs=2e-3)


def test_every_effect_has_three_sizes_and_a_parameter() -> None:
    assert set(STRENGTHS) == set(EFFECTS) <= set(KINDS)
    assert all(len(sized.sizes) == len(SIZES) for sized in STRENGTHS.values())
    assert all(STRENGTHS[effect].parameter == parameter for effect, parameter in JUDGED.items())
