"""A second source beside a gyro: mean error with it and without, and whether a source that is wrong does harm.

The motions share nothing with the simulator. The gyro has a bias of 0.5 deg/s (a standard deviation) that warms up and
walks, a scale error of 0.5 %, and no rest but where a row says so.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from evaluate.figures import Figure, mean_figure, share_figure
from gyrodrift.filters.restlevel_filter import RESTLEVEL
from gyrodrift.filters.run import FilterRun
from gyrodrift.values.aid import Aid
from gyrodrift.values.arrays import Floats

HZ = 50
WHEEL_STEP_MPS, TRACK_M = 0.002, 0.3
HARM, HARMLESS_DEG = 1.1, 0.2
"""A source harms where the mean error is above 1.1 times that without it, and 0.2 deg more."""

Dice = np.random.Generator


@dataclass(frozen=True, slots=True)
class Ride:
    """Times in s, measured rates in deg/s, true yaw in deg, speeds in m/s, and measurements by sample."""

    t_s: Floats
    rate_dps: Floats
    yaw_deg: Floats
    speed_mps: Floats
    aids: dict[int, Aid]


def measure(seed: int, count: int, folder: Path, say: Callable[[str], None]) -> list[Figure]:
    """Mean errors with each source, the share within two sigma, and the share of wrong sources that do harm."""
    del folder
    figures = []
    for name, draw in RIDES.items():
        rides = [draw(np.random.default_rng([seed, number])) for number in range(count)]
        errors = [error_of(ride) for ride in rides]
        plain = [error_of(replace(ride, aids={}))[0] for ride in rides]
        say(f"{name}: {np.mean([error for error, _ in errors]):.3g} deg, without {np.mean(plain):.3g}")
        figures.append(mean_figure(f"{name}: error in deg", [error for error, _ in errors]))
        figures.append(mean_figure(f"{name}: share beyond 2 sigma", [1.0 - within for _, within in errors]))
    figures += [_harm(name, spoil, seed, count, say) for name, spoil in WRONG.items()]
    return figures


def error_of(ride: Ride) -> tuple[float, float]:
    """Mean error of yaw, deg, and share within two sigma."""
    run, error_deg, sigma_deg = FilterRun(RESTLEVEL, RESTLEVEL.params(), "1"), [], []
    for i, (t_s, rate_dps) in enumerate(zip(ride.t_s.tolist(), ride.rate_dps.tolist(), strict=True)):
        if i in ride.aids:
            run.aid(ride.aids[i])
        run.step(t_s, rate_dps)
        error_deg.append(abs(run.state.yaw_deg - ride.yaw_deg[i]))
        sigma_deg.append(run.state.yaw_sigma_deg)
    return float(np.mean(error_deg)), float(np.mean(np.array(error_deg) < 2.0 * np.array(sigma_deg)))


def _harm(
    name: str, spoil: Callable[[float, Dice], float], seed: int, count: int, say: Callable[[str], None]
) -> Figure:
    harmed = 0
    for number in range(count):
        ride = never_at_rest(np.random.default_rng([seed, number]), minutes=10.0, every_s=1.0, spoil=spoil)
        plain = error_of(replace(ride, aids={}))[0]
        aided = error_of(ride)[0]
        harmed += aided > HARM * plain + HARMLESS_DEG
    say(f"{name}: {harmed} of {count} harmed")
    return share_figure(f"a heading that is {name} does harm", harmed, count, is_less_better=True)


def _gyro(dice: Dice, true_dps: Floats) -> tuple[Floats, Floats, Floats]:
    """Times, measured rates and true yaw of a rate."""
    t_s = np.arange(len(true_dps)) / HZ
    bias_dps = dice.normal(0.0, 0.5) + dice.normal(0.0, 0.1) * (1.0 - np.exp(-t_s / 300.0))
    bias_dps = bias_dps + 0.0005 * np.cumsum(dice.normal(0.0, 1.0, len(t_s))) / np.sqrt(HZ)
    rate_dps = true_dps * (1.0 + dice.normal(0.0, 0.005)) + bias_dps + dice.normal(0.0, 0.05, len(t_s))
    yaw_deg = np.concatenate(([0.0], np.cumsum(0.5 * (true_dps[1:] + true_dps[:-1]) / HZ)))
    return t_s, rate_dps, yaw_deg


def _wander(dice: Dice, seconds: float, sigma_dps: float, tau_s: float) -> Floats:
    """A rate that changes all the time: a Gauss-Markov process."""
    decay, values = np.exp(-1.0 / (tau_s * HZ)), [0.0]
    for step in dice.normal(0.0, sigma_dps * np.sqrt(1.0 - decay * decay), round(seconds * HZ) - 1).tolist():
        values.append(decay * values[-1] + step)
    return np.array(values)


def never_at_rest(
    dice: Dice, minutes: float = 60.0, every_s: float = 60.0, spoil: Callable[[float, Dice], float] | None = None
) -> Ride:
    """A hand or a vessel that turns all the time, and a heading with an error of 1 deg now and then."""
    t_s, rate_dps, yaw_deg = _gyro(dice, _wander(dice, 60.0 * minutes, 10.0, 2.0))
    aids = {}
    for i in range(HZ, len(t_s), round(every_s * HZ)):
        value = yaw_deg[i] if spoil is None else spoil(float(yaw_deg[i]), dice)
        aids[i] = Aid("heading", "heading", float(value + dice.normal(0.0, 1.0)), sigma=1.0)
    return Ride(t_s, rate_dps, yaw_deg, np.zeros(len(t_s)), aids)


def building(dice: Dice) -> Ride:
    """An hour of walking along corridors; at times a wall is seen, within 3 deg."""
    true_dps = _wander(dice, 3600.0, 4.0, 0.5)
    for begin, angle_deg in _corners(dice, len(true_dps)):
        true_dps[begin : begin + 2 * HZ] += angle_deg / 2.0
    t_s, rate_dps, yaw_deg = _gyro(dice, true_dps)
    aids = {
        i: Aid("wall", "heading", float(yaw_deg[i] + dice.normal(0.0, 3.0)) % 90.0, sigma=3.0, period_deg=90.0)
        for i in range(HZ, len(t_s), 5 * HZ)
    }
    return Ride(t_s, rate_dps, yaw_deg, np.zeros(len(t_s)), aids)


def _corners(dice: Dice, count: int) -> Iterator[tuple[int, float]]:
    begin = 0
    while (begin := begin + int(dice.uniform(5.0, 20.0) * HZ)) < count - 2 * HZ:
        yield begin, float(dice.choice((-90.0, 90.0, 180.0)))


def parked_and_driven(dice: Dice) -> Ride:
    """Ten minutes parked, ten minutes of driving on wheels whose track is 2 % off, and that slip."""
    true_dps = _wander(dice, 1200.0, 15.0, 2.0)
    speed_mps = 0.4 + 0.15 * np.sin(np.arange(len(true_dps)) / (7.0 * HZ))
    true_dps[: 600 * HZ] = speed_mps[: 600 * HZ] = 0.0
    return _on_wheels(dice, true_dps, speed_mps)


def cleaner(dice: Dice) -> Ride:
    """A robot cleaner that moves from its first sample: lanes, and turns on the spot."""
    true_dps, speed_mps = _wander(dice, 600.0, 0.5, 0.5), np.full(600 * HZ, 0.3)
    begin = 0
    while (begin := begin + int(dice.uniform(2.0, 8.0) * HZ)) < len(true_dps) - 2 * HZ:
        true_dps[begin : begin + 2 * HZ] += dice.choice((-1.0, 1.0)) * dice.uniform(30.0, 90.0)
        speed_mps[begin : begin + 2 * HZ] = 0.02
        begin += 2 * HZ
    return _on_wheels(dice, true_dps, speed_mps)


def _on_wheels(dice: Dice, true_dps: Floats, speed_mps: Floats) -> Ride:
    t_s, rate_dps, yaw_deg = _gyro(dice, true_dps)
    difference = np.radians(true_dps) * TRACK_M * (1.0 + dice.normal(0.0, 0.02))
    for begin in dice.integers(0, len(t_s), len(t_s) // (30 * HZ)):
        difference[begin : begin + HZ] += dice.normal(0.0, 0.1) * (speed_mps[begin] > 0.0)
    left = np.round((speed_mps - difference / 2.0) * (1.0 + dice.normal(0.0, 0.001)) / WHEEL_STEP_MPS) * WHEEL_STEP_MPS
    right = np.round((speed_mps + difference / 2.0) / WHEEL_STEP_MPS) * WHEEL_STEP_MPS
    aids = {
        i: Aid("wheels", "wheels", float(right[i] - left[i]), speed=float(0.5 * (left[i] + right[i])))
        for i in range(0, len(t_s), HZ // 10)
    }
    return Ride(t_s, rate_dps, yaw_deg, speed_mps, aids)


def boat(dice: Dice) -> Ride:
    """A boat that sways and turns; its receiver gives a course above 1 m/s, once a second and half a second late."""
    true_dps = 3.0 * np.sin(np.arange(1800 * HZ) / (1.3 * HZ)) + _wander(dice, 1800.0, 2.0, 10.0)
    speed_mps = 1.2 + np.sin(np.arange(1800 * HZ) / (90.0 * HZ))
    t_s, rate_dps, yaw_deg = _gyro(dice, true_dps)
    aids = {}
    for i in range(HZ, len(t_s) - HZ, HZ):
        if speed_mps[i] > 1.0:
            course_deg = float(yaw_deg[i] + np.degrees(dice.normal(0.0, 0.1) / speed_mps[i]))
            aids[i + HZ // 2] = Aid("course", "heading", course_deg, float(t_s[i]), speed=float(speed_mps[i]))
    return Ride(t_s, rate_dps, yaw_deg, speed_mps, aids)


RIDES: dict[str, Callable[[Dice], Ride]] = {
    "an hour never at rest, a heading a minute": never_at_rest,
    "an hour between right-angled walls": building,
    "ten minutes parked, ten driven, wheels": parked_and_driven,
    "a cleaner from its first sample, wheels": cleaner,
    "a boat with a course above 1 m/s": boat,
}

WRONG: dict[str, Callable[[float, Dice], float]] = {
    "of the other sign": lambda yaw_deg, _dice: -yaw_deg,
    "turned by 180 deg": lambda yaw_deg, _dice: yaw_deg + 180.0,
    "stuck": lambda _yaw_deg, _dice: 12.0,
    "wrong once in ten": lambda yaw_deg, dice: yaw_deg if dice.random() > 0.1 else float(dice.uniform(-180.0, 180.0)),
}
