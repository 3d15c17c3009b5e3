"""The attitude filter on simple motions that need no simulation."""

from math import cos, nan, radians, sin
from random import Random

import numpy as np
import pytest

from gyrodrift.filters.attitude.block import RAD
from gyrodrift.filters.attitude.hypotheses import BIAS as BIAS_STATES
from gyrodrift.filters.attitude.hypotheses import REST, first_hypothesis
from gyrodrift.filters.attitude.model import AttitudeCoefficients, AttitudeState, coefficients
from gyrodrift.filters.attitude.regimes import branch
from gyrodrift.filters.attitude.rests import LONG_NOISY, NOISY, QUIET, RestCandidate, RestKind
from gyrodrift.filters.attitude.step import step
from gyrodrift.filters.restlevel.model import RestlevelParams

DT = 0.01
BIAS = (0.3, -0.2, 0.5)


@pytest.fixture
def c() -> AttitudeCoefficients:
    return coefficients(RestlevelParams())


def run(
    c: AttitudeCoefficients,
    s: AttitudeState,
    seconds: float,
    rate_dps: tuple[float, float, float] = (0.0, 0.0, 0.0),
    accel_mps2: tuple[float, float, float] = (0.0, 0.0, 9.81),
) -> AttitudeState:
    """Feed constant true rates, with a bias, and constant accelerations."""
    for _ in range(round(seconds / DT)):
        gx, gy, gz = (rate + bias for rate, bias in zip(rate_dps, BIAS, strict=True))
        assert step(c, s, s.t_s + DT, gx, gy, gz, *accel_mps2)
    return s


def test_a_rest_shows_the_bias_of_three_axes(c: AttitudeCoefficients) -> None:
    s = run(c, AttitudeState(), 5.0)
    assert s.bias_xyz_dps == pytest.approx(BIAS, abs=0.02)
    assert abs(s.yaw_deg) < 0.1
    assert s.rest_probability > 0.99


def test_a_turn_of_a_tilted_sensor_has_its_full_angle(c: AttitudeCoefficients) -> None:
    """The sensor is pitched by 40° and turns about the vertical: its z axis sees cos 40° of the turn."""
    up = (-sin(radians(40.0)), 0.0, cos(radians(40.0)))
    accel = (9.81 * up[0], 0.0, 9.81 * up[2])
    s = run(c, AttitudeState(), 5.0, accel_mps2=accel)
    s = run(c, s, 9.0, (40.0 * up[0], 0.0, 40.0 * up[2]), accel)
    assert s.yaw_deg == pytest.approx(360.0, abs=0.5)
    assert s.tilt_deg == pytest.approx(40.0, abs=0.1)
    assert s.heading_rate_dps == pytest.approx(40.0 + s.bias_dps, abs=0.05)


def test_yaw_goes_on_when_acceleration_ends(c: AttitudeCoefficients) -> None:
    s = run(c, AttitudeState(), 5.0)
    sigma_deg = s.tilt_sigma_deg
    s = run(c, s, 9.0, (0.0, 0.0, 10.0), (nan, nan, nan))
    assert s.yaw_deg == pytest.approx(90.0, abs=0.5)
    assert s.tilt_sigma_deg > sigma_deg


def test_a_sample_without_progress_of_time_is_rejected(c: AttitudeCoefficients) -> None:
    s = run(c, AttitudeState(), 1.0)
    yaw_deg, samples = s.yaw_deg, s.samples
    assert not step(c, s, s.t_s, 1.0, 1.0, 1.0)
    assert not step(c, s, s.t_s + 1.0, nan, 1.0, 1.0)
    assert (s.rejected, s.yaw_deg, s.samples) == (2, yaw_deg, samples)


def test_yaw_stays_in_a_long_rest(c: AttitudeCoefficients) -> None:
    """Noise at rest is no turn: neither yaw nor its sigma grows."""
    rng, s = Random(3), AttitudeState()
    for i in range(15_000):
        gx, gy, gz = (bias + rng.gauss(0.0, 0.1) for bias in BIAS)
        step(c, s, i * DT, gx, gy, gz, rng.gauss(0.0, 0.02), rng.gauss(0.0, 0.02), rng.gauss(9.81, 0.02))
    assert abs(s.yaw_deg) < 0.05
    assert s.yaw_sigma_deg < 0.1


def rest_probability(c: AttitudeCoefficients, kind: RestKind, off_dps: float, sigma_dps: float) -> float:
    """Probability of a rest whose vertical rate is off a known bias by so much, after 20 s of motion."""
    h = first_hypothesis()
    h.knows_bias[:], h.moving_s[:] = True, 20.0
    h.cov[0, BIAS_STATES, BIAS_STATES] = (sigma_dps * RAD) ** 2 * np.eye(3)
    rates = np.array((0.0, 0.0, off_dps * RAD))
    candidate = RestCandidate(kind, rates, np.full(3, (0.1 * RAD) ** 2), np.array((0.0, 0.0, 9.81)))
    branches = branch(c, h, candidate, 1.0, np.zeros(3))
    return float(branches.weight[branches.regime == REST].sum() / branches.weight.sum())


@pytest.mark.parametrize("kind", [NOISY, LONG_NOISY])
def test_a_noisy_rest_agrees_with_a_sure_bias(c: AttitudeCoefficients, kind: RestKind) -> None:
    """A gentle bend is as noisy and as even as a rest with a running engine."""
    assert rest_probability(c, kind, 0.05, 0.02) > 0.9
    assert rest_probability(c, kind, 0.3, 0.02) < 0.05
    assert rest_probability(c, kind, 0.3, 0.2) > 0.3
    assert rest_probability(c, QUIET, 0.2, 0.02) > 0.9
