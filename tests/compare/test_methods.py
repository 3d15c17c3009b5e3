"""Compared methods on rates with a known result."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

pytest.importorskip("numba", reason="comparing needs the workstation extra")
from gyrodrift.compare.methods.method import Method
from gyrodrift.compare.methods.registry import by_key, methods
from gyrodrift.filters.hdr import HdrParams, HdrState, coefficients, step

pytestmark = pytest.mark.xdist_group("restlevel_kernel")  # its compilation takes seconds

Floats = NDArray[np.float64]

RATE_HZ = 100.0
BIAS_DPS = 0.4
BY_KEY = {
    key: method
    for key, method in by_key().items()
    if not (method.needs_axes or method.needs_device_yaw or method.needs_aids)
}
STREAMS = [method.key for method in BY_KEY.values() if not method.is_offline]
LEARNERS = ["start", "sign", "kalman", "xio", "vqf", "vqf_offline"]


def method(key: str) -> Method:
    """Method with this key; skips the test if its package is not installed."""
    chosen = BY_KEY[key]
    if not chosen.is_installed:
        pytest.skip(f"{chosen.title} needs the package {chosen.package}")
    return chosen


def still(seconds: float, noise_dps: float = 0.05, bias_dps: float = BIAS_DPS) -> tuple[Floats, Floats]:
    count = round(seconds * RATE_HZ)
    return np.arange(count) / RATE_HZ, bias_dps + np.random.default_rng(3).normal(0.0, noise_dps, count)


def yaw(key: str, t_s: Floats, rate_dps: Floats, **changed: float) -> Floats:
    params: Mapping[str, Any] = {**method(key).defaults, **changed}
    return method(key).run(t_s, rate_dps, params)


@pytest.mark.parametrize("key", BY_KEY)
def test_yaw_has_a_value_for_every_sample_and_begins_at_zero(key: str) -> None:
    t_s, rate_dps = still(10.0)
    kept = np.random.default_rng(4).random(len(t_s)) > 0.1
    yaw_deg = yaw(key, t_s[kept] + 1234.5, rate_dps[kept])
    assert yaw_deg.shape == (np.count_nonzero(kept),)
    assert yaw_deg[0] == 0.0
    assert np.isfinite(yaw_deg).all()


@pytest.mark.promise("Analyses and reports")
@pytest.mark.parametrize("key", [key for key in BY_KEY if key != "hdr"])
def test_every_method_integrates_by_the_trapezoidal_rule(key: str) -> None:
    """`compare` integrates the rate by the same rule for all methods except HDR.

    HDR integrates as published: its equation 8 is rate times step.
    """
    t_s = np.arange(800) / RATE_HZ
    rate_dps = 100.0 * np.clip((t_s - 4.0) / 0.5, 0.0, 1.0)
    true_deg = np.concatenate([[0.0], np.cumsum(0.5 * (rate_dps[1:] + rate_dps[:-1]) / RATE_HZ)])
    yaw_deg = yaw(key, t_s, rate_dps)
    assert np.abs(yaw_deg - true_deg).max() < 0.05


def triangle() -> tuple[Floats, Floats, Floats]:
    """Times, rates and true angle: four seconds of rest, then a turn by 200 degrees in a second.

    It accelerates and brakes with 800 deg/s². Rates have no noise and no bias. They are whole numbers, which 32-bit
    packages keep, and the first is 8 deg/s, above the rest threshold of every method.
    """
    t_s = np.arange(800) / RATE_HZ
    turning_s = np.clip(t_s - 4.0, 0.0, 1.0)
    braking_s = 1.0 - turning_s
    rate_dps = np.round(800.0 * np.minimum(turning_s, braking_s))
    angle_deg = np.where(turning_s < 0.5, 400.0 * turning_s**2, 200.0 - 400.0 * braking_s**2)
    return t_s, rate_dps, angle_deg


@pytest.mark.promise("Analyses and reports")
@pytest.mark.parametrize("key", [key for key in BY_KEY if key != "hdr"])
def test_every_method_gives_the_exact_angle_of_a_turn_with_constant_acceleration(key: str) -> None:
    """A turn with constant acceleration has its exact angle with every method but HDR, up to rounding."""
    t_s, rate_dps, angle_deg = triangle()
    clip = {"biasClip": 0.0} if key.startswith("vqf") else {}
    assert yaw(key, t_s, rate_dps, **clip) == pytest.approx(angle_deg, abs=1e-9)


def test_vqf_is_within_a_twentieth_of_a_degree_of_that_angle_at_its_defaults() -> None:
    """The rest is its bias estimate, not its integration."""
    t_s, rate_dps, angle_deg = triangle()
    assert np.abs(yaw("vqf", t_s, rate_dps) - angle_deg).max() < 0.05


def test_hdr_leads_that_angle_by_half_a_step_of_the_rate() -> None:
    t_s, rate_dps, angle_deg = triangle()
    ahead_deg = yaw("hdr", t_s, rate_dps, i_c_dps=0.0) - angle_deg
    assert ahead_deg == pytest.approx(0.5 * rate_dps / RATE_HZ, abs=1e-9)


@pytest.mark.parametrize("key", LEARNERS)
def test_a_bias_at_rest_is_learned(key: str) -> None:
    """Plain integration drifts by 48 degrees in these two minutes."""
    t_s, rate_dps = still(120.0)
    assert yaw("euler", t_s, rate_dps)[-1] == pytest.approx(120.0 * BIAS_DPS, rel=0.02)
    yaw_deg = yaw(key, t_s, rate_dps)
    assert abs(yaw_deg[-1] - yaw_deg[len(yaw_deg) // 2]) < 1.5


@pytest.mark.parametrize("key", STREAMS)
def test_a_real_time_method_does_not_use_later_samples(key: str) -> None:
    """A session that ends early has the same yaw until its end."""
    t_s, rate_dps = still(40.0)
    rate_dps[2000:3000] += 30.0
    whole, part = yaw(key, t_s, rate_dps), yaw(key, t_s[:2500], rate_dps[:2500])
    assert np.allclose(part, whole[:2500], rtol=0.0, atol=1e-3)  # the mean step of a session moves by an ulp


def test_the_offline_method_uses_later_samples() -> None:
    t_s, rate_dps = still(40.0)
    assert method("vqf_offline").is_offline
    whole, part = yaw("vqf_offline", t_s, rate_dps), yaw("vqf_offline", t_s[:500], rate_dps[:500])
    assert abs(whole[400] - part[400]) > 1e-3


def test_the_start_calibration_subtracts_the_mean_of_the_first_seconds() -> None:
    t_s = np.arange(1000) / RATE_HZ
    rate_dps = np.where(t_s < 3.0, 0.5, 10.5)
    assert yaw("start", t_s, rate_dps)[-1] == pytest.approx(69.95)  # half a step of the rise
    assert yaw("start", t_s, rate_dps, calibration_s=1.0)[-1] == pytest.approx(69.95)


def test_the_sign_integrator_adds_a_step_per_sample_below_its_threshold() -> None:
    t_s = np.arange(101) / RATE_HZ
    yaw_deg = yaw("sign", t_s, np.ones(101), step_dps=0.001, theta_dps=2.0)
    assert yaw_deg[-1] == pytest.approx(sum(1.0 - 0.001 * (n - 0.5) for n in range(1, 101)) / RATE_HZ)
    assert yaw("sign", t_s, np.full(101, 3.0), step_dps=0.001, theta_dps=2.0)[-1] == pytest.approx(3.0)


def test_the_kalman_filter_updates_after_rest_s_and_below_the_largest_bias() -> None:
    t_s = np.arange(1001) / RATE_HZ
    yaw_deg = yaw("kalman", t_s, np.full(1001, 0.5), rest_s=2.0, noise_dps=1e-6)
    assert yaw_deg[-1] == pytest.approx(0.5 * 2.0, abs=0.01)
    assert yaw("kalman", t_s, np.full(1001, 4.0))[-1] == pytest.approx(40.0)


def test_hdr_is_the_filter_itself() -> None:
    """Bit for bit, with the given parameters."""
    t_s, rate_dps = still(20.0)
    params = HdrParams(i_c_dps=0.002, theta_w_dps=3.0)
    state, constants = HdrState(), coefficients(params)
    expected = []
    for at_s, at_dps in zip(t_s.tolist(), rate_dps.tolist(), strict=True):
        step(constants, state, at_s, at_dps)
        expected.append(state.yaw_deg)
    (hdr,) = (entry for entry in methods({"hdr": params}) if entry.key == "hdr")
    assert hdr.run(t_s, rate_dps, hdr.defaults).tolist() == expected


def test_vqf_turns_as_its_own_quaternion_does() -> None:
    """Equal within half a sample of the turn, since the package sums rate times step."""
    vqf = pytest.importorskip("vqf", reason="VQF is not installed")
    t_s, rate_dps = still(60.0)
    rate_dps[3000:4000] += 20.0
    gyroscope, accelerometer = np.zeros((2, len(t_s), 3))
    gyroscope[:, 2], accelerometer[:, 2] = np.deg2rad(rate_dps), 9.81
    quaternion = vqf.VQF(1.0 / RATE_HZ).updateBatch(gyroscope, accelerometer)["quat6D"]
    true_deg = np.rad2deg(np.unwrap(2.0 * np.arctan2(quaternion[:, 3], quaternion[:, 0])))
    assert np.allclose(yaw("vqf", t_s, rate_dps), true_deg - true_deg[0], rtol=0.0, atol=0.11)


def test_defaults_of_other_packages_are_current() -> None:
    imufusion = pytest.importorskip("imufusion", reason="x-io Fusion is not installed")
    settings = imufusion.BiasSettings()
    for name, value in BY_KEY["xio"].defaults.items():
        assert getattr(settings, name) == value
    vqf = pytest.importorskip("vqf", reason="VQF is not installed")
    documented = vqf.VQF(0.01).params
    for name, value in BY_KEY["vqf"].defaults.items():
        assert documented[name] == value


@pytest.mark.parametrize("key", BY_KEY)
def test_every_searched_parameter_has_a_default_in_its_range(key: str) -> None:
    """Every parameter is searched, except parameters that do not change yaw."""
    for axis in BY_KEY[key].axes:
        assert axis.low <= BY_KEY[key].defaults[axis.name] <= axis.high
    idle = {"scale_percent"} if key == "restlevel" else set()  # yaw does not depend on it
    assert not BY_KEY[key].axes or {axis.name for axis in BY_KEY[key].axes} == set(BY_KEY[key].defaults) - idle
