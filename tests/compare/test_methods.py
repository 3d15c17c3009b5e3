"""The methods, each on rates whose outcome can be said beforehand, and none with a reason to run elsewhere."""

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
BY_KEY = by_key()
STREAMS = [method.key for method in BY_KEY.values() if not method.is_offline]
LEARNERS = ["start", "sign", "kalman", "xio", "vqf", "vqf_offline"]


def method(key: str) -> Method:
    """Of this key; skips with the reason where its package is missing."""
    found = BY_KEY[key]
    if not found.is_installed:
        pytest.skip(f"{found.title} needs the package {found.package}")
    return found


def still(seconds: float, noise_dps: float = 0.05, bias_dps: float = BIAS_DPS) -> tuple[Floats, Floats]:
    count = round(seconds * RATE_HZ)
    return np.arange(count) / RATE_HZ, bias_dps + np.random.default_rng(3).normal(0.0, noise_dps, count)


def yaw(key: str, t_s: Floats, rate_dps: Floats, **other: float) -> Floats:
    known: Mapping[str, Any] = {**method(key).defaults, **other}
    return method(key).run(t_s, rate_dps, known)


@pytest.mark.parametrize("key", BY_KEY)
def test_yaw_has_a_value_for_every_sample_and_begins_at_zero(key: str) -> None:
    """However far apart the samples are."""
    t_s, rate_dps = still(10.0)
    kept = np.random.default_rng(4).random(len(t_s)) > 0.1
    found = yaw(key, t_s[kept] + 1234.5, rate_dps[kept])
    assert found.shape == (np.count_nonzero(kept),)
    assert found[0] == 0.0
    assert np.isfinite(found).all()


@pytest.mark.parametrize("key", [key for key in BY_KEY if key != "hdr"])
def test_every_method_integrates_by_the_trapezoidal_rule(key: str) -> None:
    """A quarter turn within 0.05 deg; rate times step is off by 0.5 deg while this rate of 100 deg/s lasts.

    HDR is as published: its equation 8 is rate times step.
    """
    t_s = np.arange(800) / RATE_HZ
    rate_dps = 100.0 * np.clip((t_s - 4.0) / 0.5, 0.0, 1.0)
    turned_deg = np.concatenate([[0.0], np.cumsum(0.5 * (rate_dps[1:] + rate_dps[:-1]) / RATE_HZ)])
    found = yaw(key, t_s, rate_dps)
    assert np.abs(found - turned_deg).max() < 0.05


@pytest.mark.parametrize("key", LEARNERS)
def test_a_bias_at_rest_is_learnt(key: str) -> None:
    """Plain integration drifts by 48 degrees in these two minutes."""
    t_s, rate_dps = still(120.0)
    assert yaw("euler", t_s, rate_dps)[-1] == pytest.approx(120.0 * BIAS_DPS, rel=0.02)
    found = yaw(key, t_s, rate_dps)
    assert abs(found[-1] - found[len(found) // 2]) < 1.5


@pytest.mark.parametrize("key", STREAMS)
def test_what_streams_does_not_see_the_future(key: str) -> None:
    """A session that ends early has the same yaw until then; the start calibration knows its first seconds."""
    t_s, rate_dps = still(40.0)
    rate_dps[2000:3000] += 30.0
    whole, part = yaw(key, t_s, rate_dps), yaw(key, t_s[:2500], rate_dps[:2500])
    assert np.allclose(part, whole[:2500], rtol=0.0, atol=1e-3)  # the mean step of a session moves by an ulp


def test_the_offline_one_does() -> None:
    """That is why it is told apart."""
    t_s, rate_dps = still(40.0)
    assert method("vqf_offline").is_offline
    whole, part = yaw("vqf_offline", t_s, rate_dps), yaw("vqf_offline", t_s[:500], rate_dps[:500])
    assert abs(whole[400] - part[400]) > 1e-3


def test_the_start_calibration_takes_off_the_mean_of_its_seconds() -> None:
    """And nothing later."""
    t_s = np.arange(1000) / RATE_HZ
    rate_dps = np.where(t_s < 3.0, 0.5, 10.5)
    assert yaw("start", t_s, rate_dps)[-1] == pytest.approx(69.95)  # half a step of the rise
    assert yaw("start", t_s, rate_dps, calibration_s=1.0)[-1] == pytest.approx(69.95)


def test_the_sign_integrator_climbs_by_its_step_and_stops_at_its_threshold() -> None:
    """A rate of 1 deg/s: after n samples n steps are off; one of 3 deg/s is left alone."""
    t_s = np.arange(101) / RATE_HZ
    found = yaw("sign", t_s, np.ones(101), step_dps=0.001, theta_dps=2.0)
    assert found[-1] == pytest.approx(sum(1.0 - 0.001 * (n - 0.5) for n in range(1, 101)) / RATE_HZ)
    assert yaw("sign", t_s, np.full(101, 3.0), step_dps=0.001, theta_dps=2.0)[-1] == pytest.approx(3.0)


def test_the_kalman_filter_learns_after_its_time_at_rest_and_not_above_its_largest_bias() -> None:
    """With hardly any noise the first sample at rest says it all."""
    t_s = np.arange(1001) / RATE_HZ
    found = yaw("kalman", t_s, np.full(1001, 0.5), rest_s=2.0, noise_dps=1e-6)
    assert found[-1] == pytest.approx(0.5 * 2.0, abs=0.01)
    assert yaw("kalman", t_s, np.full(1001, 4.0))[-1] == pytest.approx(40.0)


def test_hdr_is_the_filter_itself() -> None:
    """Bit for bit, with the given parameters."""
    t_s, rate_dps = still(20.0)
    params = HdrParams(i_c_dps=0.002, theta_w_dps=3.0)
    state, known = HdrState(), coefficients(params)
    expected = []
    for at_s, at_dps in zip(t_s.tolist(), rate_dps.tolist(), strict=True):
        step(known, state, at_s, at_dps)
        expected.append(state.yaw_deg)
    (hdr,) = (one for one in methods({"hdr": params}) if one.key == "hdr")
    assert hdr.run(t_s, rate_dps, hdr.defaults).tolist() == expected


def test_vqf_turns_as_its_own_quaternion_does() -> None:
    """Within half a sample of the turn: the package adds up rate times step."""
    vqf = pytest.importorskip("vqf", reason="VQF is not installed")
    t_s, rate_dps = still(60.0)
    rate_dps[3000:4000] += 20.0
    gyroscope, accelerometer = np.zeros((2, len(t_s), 3))
    gyroscope[:, 2], accelerometer[:, 2] = np.deg2rad(rate_dps), 9.81
    quaternion = vqf.VQF(1.0 / RATE_HZ).updateBatch(gyroscope, accelerometer)["quat6D"]
    turned_deg = np.rad2deg(np.unwrap(2.0 * np.arctan2(quaternion[:, 3], quaternion[:, 0])))
    assert np.allclose(yaw("vqf", t_s, rate_dps), turned_deg - turned_deg[0], rtol=0.0, atol=0.11)


def test_the_defaults_of_the_peers_are_those_of_their_packages() -> None:
    """They may change; then so does what is said of them."""
    imufusion = pytest.importorskip("imufusion", reason="x-io Fusion is not installed")
    settings = imufusion.BiasSettings()
    for name, value in BY_KEY["xio"].defaults.items():
        assert getattr(settings, name) == value
    vqf = pytest.importorskip("vqf", reason="VQF is not installed")
    documented = vqf.VQF(0.01).params
    for name, value in BY_KEY["vqf"].defaults.items():
        assert documented[name] == value


@pytest.mark.parametrize("key", BY_KEY)
def test_what_is_tuned_is_what_it_runs_with(key: str) -> None:
    """Every axis is a parameter, and holds its default."""
    for axis in BY_KEY[key].axes:
        assert axis.low <= BY_KEY[key].defaults[axis.name] <= axis.high
    idle = {"scale_percent"} if key == "restlevel" else set()  # yaw does not depend on it
    assert not BY_KEY[key].axes or {axis.name for axis in BY_KEY[key].axes} == set(BY_KEY[key].defaults) - idle
