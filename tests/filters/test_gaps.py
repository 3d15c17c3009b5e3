"""Gaps and restarts on one axis and on three: yaw is held, its sigma covers the unknown turn, the bias reopens."""

from collections.abc import Iterator

import numpy as np
import pytest
from numpy.typing import NDArray
from support import quick

from gyrodrift import AttitudeFilter, Hdr, Restlevel
from gyrodrift.filters.gaps import CIRCLE_VAR, longest_step_s, turn_var
from gyrodrift.filters.hdr_filter import HDR
from gyrodrift.filters.restlevel_filter import RESTLEVEL
from gyrodrift.filters.run import FilterRun
from gyrodrift.values.sample import Inertial

RATE_HZ = 100.0
BIAS_DPS = 0.2
both = pytest.mark.parametrize("axes", [1, 3])


class Device:
    """A level device with noise, whose samples go to a filter; `t_s` is its clock."""

    def __init__(self, axes: int, rate_hz: float = RATE_HZ) -> None:
        self.run = FilterRun(RESTLEVEL, RESTLEVEL.params(), "1" if axes == 1 else "auto")
        self.rng, self.axes, self.period_s = np.random.default_rng(1), axes, 1.0 / rate_hz
        self.t_s = self.true_deg = 0.0
        self.bias_dps = np.array([0.0, 0.0, BIAS_DPS])
        self.seen: list[tuple[float, float, float]] = []

    def play(self, rate_dps: float, seconds: float) -> None:
        for _ in range(round(seconds / self.period_s)):
            self.t_s += self.period_s
            self.true_deg += rate_dps * self.period_s
            gyro = self.bias_dps + self.rng.normal(0.0, 0.05, 3)
            gyro[2] += rate_dps
            accel = np.array([0.0, 0.0, 9.81]) + self.rng.normal(0.0, 0.02, 3)
            self.run.step(self.t_s, float(gyro[2]), Inertial(*gyro, *accel) if self.axes == 3 else None)
            self.seen.append((self.yaw_deg, self.run.correction_deg, self.sigma_deg))

    @property
    def yaw_deg(self) -> float:
        return float(self.run.state.yaw_deg)

    @property
    def sigma_deg(self) -> float:
        return float(self.run.state.yaw_sigma_deg)

    @property
    def error_deg(self) -> float:
        return self.yaw_deg - self.true_deg


@both
@pytest.mark.parametrize(("seconds", "turn_deg"), [(3.0, 165.0), (3.0, -165.0), (600.0, 0.0), (1.0, 40.0)])
def test_the_turn_in_a_gap_is_within_two_sigmas(axes: int, seconds: float, turn_deg: float) -> None:
    device = Device(axes)
    device.play(0.0, 20.0)
    held_deg = device.yaw_deg
    device.t_s, device.true_deg = device.t_s + seconds, device.true_deg + turn_deg
    device.play(0.0, 0.01)
    assert device.yaw_deg == pytest.approx(held_deg, abs=0.05)
    assert abs(device.error_deg) < 2.0 * device.sigma_deg <= 2.0 * CIRCLE_VAR**0.5 + 1.0
    device.play(0.0, 20.0)
    assert abs(device.error_deg) < 2.0 * device.sigma_deg
    assert device.run.gaps == 1


@both
def test_no_turn_is_integrated_over_a_gap(axes: int) -> None:
    device = Device(axes)
    device.play(0.0, 20.0)
    device.play(60.0, 2.75)
    device.t_s += 5.0
    device.play(0.0, 5.0)
    assert device.error_deg == pytest.approx(0.0, abs=1.0)
    assert device.sigma_deg > 100.0


@both
@pytest.mark.parametrize("rate_hz", [2.0, 5.0])
def test_a_slow_device_has_no_gaps(axes: int, rate_hz: float) -> None:
    device = Device(axes, rate_hz)
    device.play(0.0, 60.0)
    assert device.run.gaps == 0
    assert device.sigma_deg < 1.0


@both
def test_a_device_that_becomes_slow_has_a_few_gaps_and_then_none(axes: int) -> None:
    device = Device(axes)
    device.play(0.0, 10.0)
    device.period_s = 1.0
    device.play(0.0, 60.0)
    assert 1 <= device.run.gaps <= 2


@both
@pytest.mark.parametrize("step_dps", quick((0.2, 0.3, 1.0, 2.0), 0.2, 2.0))
@pytest.mark.parametrize("is_told", [True, False])
def test_after_a_restart_the_new_bias_is_learned(axes: int, step_dps: float, is_told: bool) -> None:  # noqa: FBT001 - parametrized
    """A told restart, with a clock that begins again, or a pause of 15 s."""
    device = Device(axes)
    device.play(0.0, 20.0)
    if is_told:
        device.run.gap(has_restarted=True)
    device.t_s = 0.0 if is_told else device.t_s + 15.0
    device.bias_dps[2] += step_dps
    device.play(0.0, 60.0)
    assert device.run.restarts == 1
    assert abs(device.error_deg) < 0.5
    assert device.run.state.bias_dps == pytest.approx(BIAS_DPS + step_dps, abs=0.02)


@both
def test_the_bias_is_kept_over_a_short_gap(axes: int) -> None:
    device = Device(axes)
    device.play(0.0, 20.0)
    before_dps = device.run.state.bias_dps
    device.t_s += 3.0
    device.play(20.0, 5.0)
    assert device.run.state.bias_dps == pytest.approx(before_dps, abs=1e-3)
    assert device.run.restarts == 0


@pytest.mark.parametrize(("axes", "bias_dps", "piece_s"), [(1, 0.6, 0.05), (3, 1.5, 0.5)])
def test_yaw_is_the_integral_of_the_rate_and_of_the_corrections(axes: int, bias_dps: float, piece_s: float) -> None:
    """A bias that is learned after a motion turns yaw by a step; the steps without motion are stated."""
    device = Device(axes)
    device.bias_dps[2] = bias_dps
    for index in range(round(20.0 / piece_s)):
        device.play(25.0 * np.sin(index), piece_s)
    device.play(0.0, 10.0)
    yaw_deg, correction_deg, _ = np.array(device.seen).T
    steps_deg = np.diff(yaw_deg) - correction_deg[1:]
    assert np.abs(correction_deg).max() > 1.0
    assert np.abs(steps_deg).max() < 1.2 * 27.0 / RATE_HZ
    assert device.run.corrections > 0
    assert device.run.corrections == np.count_nonzero(np.abs(correction_deg) > 1.0)


def test_hdr_holds_yaw_and_begins_again() -> None:
    run = FilterRun(HDR, HDR.params())
    for index in range(1000):
        run.step(index * 0.01, 30.0)
    held_deg = run.state.yaw_deg
    run.step(20.0, 30.0)
    assert run.state.yaw_deg == held_deg
    run.gap(has_restarted=True)
    assert run.step(1.0, 30.0)
    assert run.state.yaw_deg == held_deg
    assert run.gaps == 2


def rest(count: int) -> Iterator[tuple[float, float]]:
    return ((index / RATE_HZ, 0.1) for index in range(count))


@pytest.mark.parametrize("filter_class", [Restlevel, Hdr])
def test_the_library_takes_a_told_gap_and_a_restart(filter_class: type[Restlevel] | type[Hdr]) -> None:
    drift = filter_class()
    drift.restarted()  # before the first sample it has no effect
    for t_s, rate_dps in rest(1000):
        estimate = drift.update_at(rate_dps, t_s)
    held_deg = estimate.yaw_deg
    drift.gap()
    told = drift.update(0.1, 0.01)
    assert told.yaw_deg == pytest.approx(held_deg, abs=0.01)
    assert np.isnan(told.yaw_sigma_deg) or told.yaw_sigma_deg > 100.0
    drift.restarted()
    assert drift.update_at(0.1, 0.0).is_accepted
    assert drift.update(0.1, 0.01).is_accepted
    assert drift.corrections == 0


def test_the_attitude_filter_of_the_library_takes_them_too() -> None:
    attitude = AttitudeFilter()
    for t_s, rate_dps in rest(1000):
        attitude.update_at((0.0, 0.0, rate_dps), (0.0, 0.0, 9.81), t_s=t_s)
    attitude.gap()
    assert attitude.update_at((0.0, 0.0, 0.1), (0.0, 0.0, 9.81), t_s=10.0).yaw_sigma_deg > 100.0
    attitude.restarted()
    assert attitude.update_at((0.0, 0.0, 0.1), (0.0, 0.0, 9.81), t_s=0.0).is_accepted
    assert attitude.corrections == 0


def test_batches_state_the_corrections() -> None:
    t_s = np.arange(3000) / RATE_HZ
    rates: NDArray[np.float64] = (
        np.where(t_s < 10.0, 30.0, 0.0) + 1.0 + np.random.default_rng(2).normal(0.0, 0.05, 3000)
    )
    batch = Restlevel().update_batch(rates, t_s)
    assert np.abs(batch.correction_deg).max() > 1.0
    assert batch.correction_deg[0] == 0.0


def test_the_variance_of_a_gap_is_that_of_a_gauss_markov_process() -> None:
    """Against paths with both ends at rest, and with a sum of rates."""
    rng, step_s, seconds = np.random.default_rng(3), 0.02, 1.5
    count, decay = round(seconds / step_s), np.exp(-step_s)
    rate_dps = np.zeros((count + 1, 40_000))
    rate_dps[0] = 60.0 * rng.normal(size=40_000)
    for index in range(count):
        rate_dps[index + 1] = decay * rate_dps[index] + 60.0 * np.sqrt(1.0 - decay**2) * rng.normal(size=40_000)
    turns_deg = step_s * (rate_dps.sum(axis=0) - 0.5 * (rate_dps[0] + rate_dps[-1]))
    ends_dps = rate_dps[0] + rate_dps[-1]
    gain_s = float((turns_deg @ ends_dps) / (ends_dps @ ends_dps))
    at_rest_var = float(np.var(turns_deg - gain_s * ends_dps))
    assert turn_var(seconds, 0.0) == pytest.approx(at_rest_var, rel=0.03)
    assert turn_var(seconds, 100.0) == pytest.approx(at_rest_var + (100.0 * gain_s) ** 2, rel=0.03)
    assert turn_var(1e9, 0.0) == CIRCLE_VAR


def test_the_longest_step_follows_the_period() -> None:
    assert [longest_step_s(period_s) for period_s in (0.001, 0.1, 0.5, 60.0)] == [0.3, pytest.approx(0.3), 1.5, 3.0]
