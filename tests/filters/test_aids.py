"""Second sources: headings, turn rates, wheels and speeds beside a gyro that never rests."""

from collections.abc import Callable, Iterable
from math import inf, nan
from typing import NamedTuple

import numpy as np
import pytest

from gyrodrift.filters.hdr_filter import HDR
from gyrodrift.filters.restlevel_filter import RESTLEVEL
from gyrodrift.filters.run import FilterRun
from gyrodrift.values.aid import Aid, AidStatus
from gyrodrift.values.arrays import Floats
from gyrodrift.values.sample import Inertial

HZ, TRACK_M = 50, 0.3


class Drive(NamedTuple):
    """Times in s, true rates and measured rates in deg/s, and true yaw in deg."""

    t_s: Floats
    true_dps: Floats
    rate_dps: Floats
    yaw_deg: Floats


class Filtered(NamedTuple):
    """Errors of yaw and its sigma in deg after each sample, and the run."""

    error_deg: Floats
    sigma_deg: Floats
    run: FilterRun

    @property
    def status(self) -> AidStatus:
        return self.run.aids["aid"]


def drive(seconds: float = 300.0, seed: int = 1, rests: Iterable[tuple[float, float]] = ()) -> Drive:
    """A device that turns all the time but in `rests`, with a bias of 0.4 deg/s."""
    rng = np.random.default_rng(seed)
    t_s = np.arange(round(seconds * HZ)) / HZ
    true_dps = 12.0 * np.sin(t_s / 3.1) + 7.0 * np.sin(1.3 * t_s) + 3.0 * np.sign(np.sin(t_s / 29.0))
    for begin_s, end_s in rests:
        true_dps[(t_s >= begin_s) & (t_s < end_s)] = 0.0
    yaw_deg = np.concatenate(([0.0], np.cumsum(0.5 * (true_dps[1:] + true_dps[:-1]) / HZ)))
    return Drive(t_s, true_dps, true_dps + 0.4 + rng.normal(0.0, 0.05, len(t_s)), yaw_deg)


def filtered(ride: Drive, aid_at: Callable[[int], Aid | None] = lambda _: None, *, axes: bool = False) -> Filtered:
    """Run restlevel; `aid_at` gives the measurement before a sample."""
    run = FilterRun(RESTLEVEL, RESTLEVEL.params())
    rng = np.random.default_rng(0)
    error_deg, sigma_deg = np.empty(len(ride.t_s)), np.empty(len(ride.t_s))
    noise = rng.normal(0.0, 0.03, (len(ride.t_s), 5))
    for i, (t_s, rate_dps) in enumerate(zip(ride.t_s.tolist(), ride.rate_dps.tolist(), strict=True)):
        if (aid := aid_at(i)) is not None:
            run.aid(aid)
        x, y, fx, fy, fz = noise[i].tolist()
        run.step(t_s, rate_dps, Inertial(x, y, rate_dps, fx, fy, 9.81 + fz) if axes else None)
        error_deg[i], sigma_deg[i] = run.state.yaw_deg - ride.yaw_deg[i], run.state.yaw_sigma_deg
    return Filtered(error_deg, sigma_deg, run)


def headings(
    ride: Drive, every_s: float, of: Callable[[int, np.random.Generator], float], *, sigma: float = 1.0, **fields: float
) -> Callable[[int], Aid | None]:
    """A heading every so many seconds, with a normal error."""
    rng = np.random.default_rng(5)
    every = round(every_s * HZ)

    def aid_at(i: int) -> Aid | None:
        if i % every or i == 0:
            return None
        return Aid("aid", "heading", of(i, rng) + rng.normal(0.0, sigma), sigma=sigma, **fields)

    return aid_at


@pytest.fixture(scope="module")
def ride() -> Drive:
    return drive()


@pytest.fixture(scope="module")
def alone(ride: Drive) -> Filtered:
    return filtered(ride)


def settled(result: Filtered) -> float:
    """Mean error of the second half, deg."""
    return float(np.abs(result.error_deg[len(result.error_deg) // 2 :]).mean())


@pytest.mark.parametrize("offset_deg", [0.0, 87.0, -130.0])
@pytest.mark.parametrize("axes", [False, True], ids=["one axis", "three axes"])
def test_a_heading_now_and_then_holds_yaw(ride: Drive, offset_deg: float, *, axes: bool) -> None:
    """From another zero than that of yaw, yaw keeps the error that it has at the first of them."""
    result = filtered(ride, headings(ride, 10.0, lambda i, _: float(ride.yaw_deg[i]) + offset_deg), axes=axes)
    half = result.error_deg[len(result.error_deg) // 2 :]
    assert np.abs(half - (half.mean() if offset_deg else 0.0)).mean() < 2.0
    assert (np.abs(result.error_deg) < 2.0 * result.sigma_deg + 0.1).mean() > 0.9
    assert result.status.differs == ""
    assert result.status.age_s == pytest.approx(10.0)
    assert result.status.weight == pytest.approx(1.0, abs=0.05)


def test_a_building_has_four_directions(ride: Drive) -> None:
    walls = headings(ride, 2.0, lambda i, _: float(ride.yaw_deg[i]) % 90.0, sigma=2.0, period_deg=90.0)
    assert settled(filtered(ride, walls)) < 1.0


def test_a_stated_time_is_that_of_the_measurement(ride: Drive) -> None:
    """It comes 1.5 s late, and turns of 20 deg/s lie between."""
    late, rng = round(1.5 * HZ), np.random.default_rng(2)

    def aid_at(i: int) -> Aid | None:
        if i < 2 * late or i % (2 * HZ):
            return None
        return Aid("aid", "heading", float(ride.yaw_deg[i - late]) + rng.normal(), float(ride.t_s[i - late]), 1.0)

    assert settled(filtered(ride, aid_at)) < 1.0


@pytest.mark.parametrize(
    "wrong",
    [
        lambda ride, i, _: -float(ride.yaw_deg[i]),
        lambda ride, i, _: float(ride.yaw_deg[HZ]),
        lambda ride, i, _: float(ride.yaw_deg[max(0, i - 2 * HZ)]),
        lambda _, i, rng: float(rng.uniform(-180.0, 180.0)),
    ],
    ids=["wrong sign", "stuck", "2 s late", "noise"],
)
def test_a_source_that_is_wrong_does_no_harm(
    ride: Drive, alone: Filtered, wrong: Callable[[Drive, int, np.random.Generator], float]
) -> None:
    """It is left out and told, and yaw is that without it."""
    result = filtered(ride, headings(ride, 1.0, lambda i, rng: wrong(ride, i, rng), sigma=2.0))
    assert "it differs by" in result.status.differs
    assert result.status.weight == 0.0
    assert np.abs(result.error_deg).mean() < 1.1 * np.abs(alone.error_deg).mean() + 0.2


def test_one_wrong_value_in_ten_is_no_matter(ride: Drive) -> None:
    def value(i: int, rng: np.random.Generator) -> float:
        return float(rng.uniform(-180.0, 180.0) if rng.uniform() < 0.1 else ride.yaw_deg[i])

    result = filtered(ride, headings(ride, 1.0, value))
    assert settled(result) < 1.0
    assert result.status.differs == ""


def test_a_source_that_fails_later_leaves_the_filter_as_it_was_before(ride: Drive) -> None:
    """After half a minute of right headings they stick, are left out, and come back once they are right."""

    def value(i: int, _: np.random.Generator) -> float:
        t_s = float(ride.t_s[i])
        return float(ride.yaw_deg[60 * HZ] if 60.0 <= t_s < 90.0 else ride.yaw_deg[i])

    result = filtered(ride, headings(ride, 1.0, value))
    assert np.abs(result.error_deg[60 * HZ : 90 * HZ]).max() < 10.0
    assert settled(result) < 1.5
    assert result.status.differs == ""


def wheels(ride: Drive, speed_mps: Floats, *, swapped: bool = False) -> Callable[[int], Aid | None]:
    """Differences of two wheels at 10 Hz with steps of 2 mm/s."""
    difference = np.radians(ride.true_dps) * TRACK_M * (-1.0 if swapped else 1.0)
    difference = np.round(difference / 0.002) * 0.002

    def aid_at(i: int) -> Aid | None:
        return None if i % 5 else Aid("aid", "wheels", float(difference[i]), speed=float(speed_mps[i]))

    return aid_at


def test_wheels_of_an_unknown_track_show_the_bias() -> None:
    """A robot that goes straight now and then; its track is not stated."""
    ride = drive(180.0)
    straight = np.sin(ride.t_s / 4.0) > 0.0
    true_dps = np.where(straight, 0.3 * np.sin(ride.t_s), ride.true_dps)
    yaw_deg = np.concatenate(([0.0], np.cumsum(0.5 * (true_dps[1:] + true_dps[:-1]) / HZ)))
    ride = Drive(ride.t_s, true_dps, true_dps + (ride.rate_dps - ride.true_dps), yaw_deg)
    result = filtered(ride, wheels(ride, np.full(len(ride.t_s), 0.1)))
    assert result.status.differs == ""
    assert np.abs(result.error_deg).mean() < 0.5 * np.abs(filtered(ride).error_deg).mean() + 0.5


def test_swapped_wheels_are_told(ride: Drive, alone: Filtered) -> None:
    result = filtered(ride, wheels(ride, np.full(len(ride.t_s), 0.3), swapped=True))
    assert result.status.differs == "it turns the other way: left and right are swapped"
    assert np.abs(result.error_deg).mean() < 1.1 * np.abs(alone.error_deg).mean() + 0.2


@pytest.mark.parametrize("is_backwards", [False, True], ids=["too much in turns", "wrong sign"])
def test_a_wrong_turn_rate_does_no_harm(ride: Drive, alone: Filtered, *, is_backwards: bool) -> None:
    """Steering that reads up to 80 % too much, each time another share."""
    reads_dps = -ride.true_dps if is_backwards else ride.true_dps * (1.4 + 0.4 * np.sin(ride.t_s / 11.0))
    result = filtered(ride, lambda i: None if i % 5 else Aid("aid", "turn_rate", float(reads_dps[i])))
    assert result.status.differs.endswith("deg/s" if is_backwards else "")
    assert np.abs(result.error_deg).mean() < 1.1 * np.abs(alone.error_deg).mean() + 0.2


def test_a_speed_of_zero_is_rest() -> None:
    """A quarter of the rests is too short for the filter alone, and an engine shakes all of them."""
    ride = drive(120.0, rests=((20.0, 26.0), (60.0, 66.0), (100.0, 106.0)))
    shaken = ride._replace(rate_dps=ride.rate_dps + 1.5 * np.sin(2.0 * np.pi * 11.0 * ride.t_s))
    speed_mps = np.where(ride.true_dps == 0.0, 0.0, 2.0)
    speed_mps[:5] = 0.1
    result = filtered(shaken, lambda i: None if i % 5 else Aid("aid", "speed", float(speed_mps[i])))
    alone = filtered(shaken)
    after = slice(26 * HZ, None)
    drift_deg = result.error_deg[after] - result.error_deg[26 * HZ]
    alone_deg = alone.error_deg[after] - alone.error_deg[26 * HZ]
    assert np.abs(drift_deg).max() < 1.0 < np.abs(alone_deg).max()


def test_a_speed_that_hides_slow_motion_tells_no_rest(ride: Drive, alone: Filtered) -> None:
    """It reads 0 below 0.8 m/s."""
    speed_mps = np.where(np.abs(ride.true_dps) < 5.0, 0.0, 0.8 + 0.01 * np.abs(ride.true_dps))
    result = filtered(ride, lambda i: Aid("aid", "speed", float(speed_mps[i])) if i > 2 * HZ else None)
    assert np.abs(ride.true_dps[: 2 * HZ]).max() > 5.0
    assert np.array_equal(result.error_deg, alone.error_deg)


def test_hdr_takes_no_headings() -> None:
    """It stays as published; the source is listed all the same."""
    run, other = FilterRun(HDR, HDR.params()), FilterRun(HDR, HDR.params())
    for i in range(1000):
        run.aid(Aid("aid", "heading", 50.0, sigma=1.0))
        run.step(i / HZ, 1.0)
        other.step(i / HZ, 1.0)
    assert run.state.yaw_deg == other.state.yaw_deg
    assert run.aids["aid"].age_s == pytest.approx(0.0, abs=1.0 / HZ)


def test_any_measurement_and_any_clock_are_taken() -> None:
    """Values that are no numbers, times far away, a clock that restarts; yaw stays a number."""
    run = FilterRun(RESTLEVEL, RESTLEVEL.params())
    for value in (nan, inf, -inf, 1e300, 0.0):
        for t_s in (nan, inf, -1e18, 0.0, 1e18):
            run.aid(Aid("aid", "heading", value, t_s, 1.0))
            run.aid(Aid("rate", "turn_rate", value, t_s))
    for i in range(2000):
        if i == 1000:
            run.gap(has_restarted=True)
        run.aid(Aid("aid", "heading", 5.0, (i % 1000) / HZ, 1.0))
        run.aid(Aid("aid", "wheels", 0.1, (i % 1000) / HZ))
        run.step((i % 1000) / HZ, 0.1)
    assert abs(run.state.yaw_deg) < 1000.0
    assert run.state.yaw_sigma_deg < 1000.0


def test_a_filter_without_sources_gives_the_same_bits(ride: Drive, alone: Filtered) -> None:
    """A source without a value changes nothing, either."""
    silent = filtered(ride, lambda _: Aid("aid", "heading", nan))
    assert np.array_equal(silent.error_deg, alone.error_deg)
