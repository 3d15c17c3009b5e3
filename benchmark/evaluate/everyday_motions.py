"""Motions of everyday things, from a generator that shares nothing with the simulator.

Each session is drawn anew: 5 to 200 Hz, a bias of exactly 0 to 3 deg/s, steps of 0.004 to 0.1 deg/s, noise with and
without what lies beyond half the sample rate, one to ten minutes.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter

from gyrodrift.values.arrays import Floats

RATES_HZ = (5.0, 10.0, 20.0, 50.0, 100.0, 200.0)

Dice = np.random.Generator
Piece = tuple[float, float, float, float]
"""A rate in deg/s, for how many seconds, with how much more noise, and with how much unrest, deg/s."""
Draw = Callable[[Dice], list[Piece]]


@dataclass(frozen=True)
class Session:
    """Times in s, measured rates in deg/s, true yaw in deg, and the bias at its first sample, deg/s."""

    t_s: Floats
    rate_dps: Floats
    yaw_deg: Floats
    bias_dps: float


def either_way(dice: Dice, least: float, most: float) -> float:
    """Of such a size, to the left or to the right."""
    return float(dice.choice([-1.0, 1.0]) * dice.uniform(least, most))


def car(dice: Dice) -> Draw:
    """Bends, roundabouts and crossings, with the noise of a road; at times a stop with the engine on."""
    road = dice.uniform(0.05, 0.5)

    def drive(dice: Dice) -> list[Piece]:
        pieces = [
            [
                (dice.normal(0.0, 0.5), dice.uniform(3.0, 20.0), road, 0.2),
                (either_way(dice, 1.0, 3.0), dice.uniform(8.0, 40.0), road, 0.1),
                (either_way(dice, 15.0, 35.0), dice.uniform(2.0, 6.0), road, 1.0),
                (either_way(dice, 15.0, 30.0), dice.uniform(6.0, 20.0), road, 1.0),
                (0.0, dice.uniform(2.0, 10.0), road, 0.05),
            ][dice.choice(5, p=[0.45, 0.15, 0.15, 0.05, 0.2])]
            for _ in range(int(dice.integers(2, 8)))
        ]
        stop = (0.0, dice.uniform(2.0, 40.0), road * dice.uniform(0.02, 0.3), 0.0)
        return [*pieces, stop] if dice.random() < 0.5 else pieces

    return drive


def motorway(dice: Dice) -> Draw:
    """Gentle bends without an end."""
    road = dice.uniform(0.1, 0.6)
    return lambda dice: [(dice.normal(0.0, 0.6), dice.uniform(3.0, 40.0), road, 0.1)]


def bench(dice: Dice) -> Draw:
    """A balancing bench that hovers."""
    size_dps = dice.uniform(0.2, 4.0)
    return lambda dice: [(dice.normal(0.0, 0.3 * size_dps), dice.uniform(0.5, 3.0), 0.0, size_dps)]


def drone(dice: Dice) -> Draw:
    """In the air, with all the noise of its propellers."""
    shake = dice.uniform(0.3, 2.0)
    return lambda dice: [
        (dice.normal(0.0, 15.0) * dice.choice([0.0, 1.0]), dice.uniform(2.0, 8.0), shake, dice.uniform(0.5, 3.0))
    ]


def vacuum(dice: Dice) -> Draw:
    """A robot cleaner: straight on with a shaking motor, a turn, at times a stop of a few seconds."""
    motor = dice.uniform(0.1, 0.4)

    def clean(dice: Dice) -> list[Piece]:
        lane = (0.0, dice.uniform(2.0, 10.0), motor, dice.uniform(0.5, 2.0))
        turn = (either_way(dice, 20.0, 60.0), dice.uniform(1.0, 4.0), motor, 2.0)
        stop = (0.0, dice.uniform(0.5, 4.0), dice.choice([0.0, 0.05]), 0.0)
        return [lane, turn, stop] if dice.random() < 0.4 else [lane, turn]

    return clean


def mower(dice: Dice) -> Draw:
    """Lanes and turns over rough ground, never at rest."""
    motor = dice.uniform(0.5, 2.0)
    return lambda dice: [
        (0.0, dice.uniform(5.0, 30.0), motor, dice.uniform(0.5, 2.0)),
        (either_way(dice, 30.0, 60.0), dice.uniform(2.0, 4.0), motor, 3.0),
    ]


def boat(dice: Dice) -> Draw:
    """At anchor: to and fro, for ever."""
    size_dps, period_s = dice.uniform(0.3, 4.0), dice.uniform(4.0, 25.0)
    at_s = np.arange(0.0, period_s, 0.3)
    sway_dps = size_dps * np.sin(2.0 * np.pi * at_s / period_s)
    return lambda _dice: [(float(dps), 0.3, 0.0, 0.1) for dps in sway_dps]


def crane(_dice: Dice) -> Draw:
    """Turns slowly and evenly, and hangs about."""
    return lambda dice: [
        (either_way(dice, 0.3, 4.0), dice.uniform(5.0, 30.0), 0.02, 0.02),
        (0.0, dice.uniform(2.0, 20.0), 0.0, dice.uniform(0.0, 0.1)),
    ]


def pocket(_dice: Dice) -> Draw:
    """Steps of somebody who walks, and stands with a sway."""

    def walk(dice: Dice) -> list[Piece]:
        steps = int(dice.integers(10, 60))
        stand = (0.0, dice.uniform(2.0, 10.0), 0.0, dice.choice([0.0, 0.2, 0.5]))
        return [*((dice.normal(0.0, 3.0), dice.uniform(0.4, 0.6), 0.0, 8.0) for _ in range(steps)), stand]

    return walk


def robot(_dice: Dice) -> Draw:
    """An arm: quick turns, and stops."""
    return lambda dice: [
        (either_way(dice, 10.0, 90.0), dice.uniform(0.5, 3.0), 0.1, 1.0),
        (0.0, dice.uniform(0.5, 4.0), 0.0, 0.0),
    ]


def table(_dice: Dice) -> Draw:
    """A turntable: even turns of any speed, and stops."""
    return lambda dice: [
        (either_way(dice, 0.3, 60.0), dice.uniform(2.0, 20.0), 0.0, 0.0),
        (0.0, dice.uniform(2.0, 10.0), 0.0, 0.0),
    ]


MOTIONS: Mapping[str, Callable[[Dice], Draw]] = {
    "car": car,
    "motorway": motorway,
    "balancing bench": bench,
    "drone": drone,
    "robot cleaner": vacuum,
    "mower": mower,
    "boat": boat,
    "crane": crane,
    "pocket": pocket,
    "robot arm": robot,
    "turntable": table,
}


def unrest(dice: Dice, samples: int, rate_hz: float, memory_s: float, size: float) -> Floats:
    """Random, with a memory of so many seconds."""
    kept = float(np.exp(-1.0 / (rate_hz * memory_s)))
    return np.asarray(lfilter([size * np.sqrt(1.0 - kept**2)], [1.0, -kept], dice.standard_normal(samples)))


def put_together(dice: Dice, draw: Draw, rate_hz: float, seconds: float) -> tuple[Floats, Floats]:
    """True rates and the standard deviation of the noise on top of the sensor's own, both in deg/s."""
    before_dps, passed_s, rates, noises = 0.0, 0.0, [], []
    while passed_s < seconds:
        for rate_dps, piece_s, noise_dps, unrest_dps in draw(dice):
            samples = max(1, round(piece_s * rate_hz))
            ramp = np.minimum(np.arange(samples) / (dice.uniform(0.2, 0.8) * rate_hz), 1.0)
            wobble_dps = unrest(dice, samples, rate_hz, dice.uniform(0.1, 1.0), unrest_dps)
            rates.append(before_dps + (rate_dps - before_dps) * ramp + wobble_dps)
            noises.append(np.full(samples, noise_dps))
            before_dps, passed_s = rate_dps, passed_s + piece_s
    return np.concatenate(rates), np.concatenate(noises)


def bias_of(dice: Dice, samples: int, rate_hz: float) -> Floats:
    """A quarter has none, a quarter has hardly any; the rest warms up, or not, and wanders."""
    kind = dice.choice(4, p=[0.25, 0.25, 0.4, 0.1])
    first_dps = [0.0, dice.normal(0.0, 0.03), dice.normal(0.0, 0.5), either_way(dice, 1.0, 3.0)][kind]
    if kind == 0:
        return np.zeros(samples)
    warm_dps = dice.choice([0.0, 1.0]) * dice.normal(0.0, 0.2)
    warming = 1.0 - np.exp(-np.arange(samples) / rate_hz / dice.uniform(60.0, 300.0))
    return np.asarray(first_dps + warm_dps * warming + unrest(dice, samples, rate_hz, 100.0, 0.01))


def session(motion: str, number: int, *, is_still: bool, seed: int) -> Session:
    """One of a motion; the same number has the same sensor and motion, still for 3 to 20 s before it or not."""
    dice = np.random.default_rng([seed, list(MOTIONS).index(motion), number])
    rate_hz, still_s = float(dice.choice(RATES_HZ)), dice.uniform(3.0, 20.0)
    true_dps, more_noise_dps = put_together(dice, MOTIONS[motion](dice), rate_hz, dice.uniform(60.0, 600.0))
    lead = round(still_s * rate_hz) if is_still else 0
    begins = int(dice.uniform(0.0, 0.2) * len(true_dps)) * (not is_still)
    true_dps = np.r_[np.zeros(lead), true_dps[begins:]]
    more_noise_dps = np.r_[np.zeros(lead), more_noise_dps[begins:]]
    samples = len(true_dps)
    step_dps = np.exp(dice.uniform(np.log(0.004), np.log(0.1)))
    band_hz = rate_hz / 2.0 if dice.random() < 0.6 else 50.0
    noise_dps = np.exp(dice.uniform(np.log(0.003), np.log(0.02))) * np.sqrt(band_hz)
    bias_dps = bias_of(dice, samples, rate_hz)
    noise = dice.standard_normal(samples) * np.hypot(noise_dps, more_noise_dps)
    measured_dps = np.round((true_dps + bias_dps + noise) / step_dps) * step_dps
    yaw_deg = np.cumsum(0.5 * (true_dps + np.r_[true_dps[0], true_dps[:-1]])) / rate_hz
    t_s = np.arange(samples) / rate_hz
    return Session(t_s, measured_dps, yaw_deg - yaw_deg[0], float(bias_dps[0]))
