"""Motions of everyday things, from a generator that shares nothing with the simulator: who keeps yaw where."""

from collections.abc import Callable, Mapping

import numpy as np
import pytest
from bench_support import show
from scipy.signal import lfilter

pytest.importorskip("numba", reason="comparing needs the workstation extra")
from gyrodrift.arrays import Floats
from gyrodrift.compare.methods.registry import by_key

pytestmark = [pytest.mark.bench, pytest.mark.timeout(1200)]

RATE_HZ = 100.0
SECONDS = 600.0
SESSIONS = 6
NOISE_DPS = 0.05
RESOLUTION_DPS = 0.061
STILL = (0.0, 10.0, 0.0, 0.0)

BY_KEY = by_key()
METHODS = ("euler", "start", "kalman", "hdr", "restlevel", "xio", "vqf")

Dice = np.random.Generator
Piece = tuple[float, float, float, float]
"""A rate in deg/s, for how many seconds, with how much more noise, and with how much unrest, deg/s."""


def unrest(dice: Dice, samples: int, memory_s: float, size: float) -> Floats:
    """Random, with a memory of so many seconds."""
    kept = float(np.exp(-1.0 / (RATE_HZ * memory_s)))
    return np.asarray(lfilter([size * np.sqrt(1.0 - kept**2)], [1.0, -kept], dice.standard_normal(samples)))


def put_together(dice: Dice, draw: Callable[[Dice], list[Piece]], *, is_still: bool) -> tuple[Floats, Floats]:
    """True rates and the standard deviation of the noise on top of the sensor's own, both in deg/s."""
    pieces = [STILL] if is_still else []
    while sum(piece[1] for piece in pieces) < SECONDS:
        pieces += draw(dice)
    before_dps, rates, noises = 0.0, [], []
    for rate_dps, seconds, noise_dps, unrest_dps in pieces:
        samples = round(seconds * RATE_HZ)
        ramp = np.minimum(np.arange(samples) / (0.3 * RATE_HZ), 1.0)
        rates.append(before_dps + (rate_dps - before_dps) * ramp + unrest(dice, samples, 0.3, unrest_dps))
        noises.append(np.full(samples, noise_dps))
        before_dps = rate_dps
    return np.concatenate(rates), np.concatenate(noises)


def vacuum(dice: Dice) -> list[Piece]:
    """A robot cleaner: straight on with a shaking motor, a turn, at times a stop of a second or two."""
    turn_dps = float(dice.choice([-1.0, 1.0]) * dice.uniform(20.0, 60.0))
    stop = [(0.0, dice.uniform(0.5, 2.5), dice.choice([0.0, 0.1]), 0.0)] if dice.random() < 0.4 else []
    return [(0.0, dice.uniform(2.0, 10.0), 0.3, 1.5), (turn_dps, dice.uniform(1.0, 4.0), 0.3, 2.0), *stop]


def hand(dice: Dice) -> list[Piece]:
    """Held in the hand for a while, and put down."""
    return [(dice.normal(0.0, 10.0), dice.uniform(5.0, 20.0), 0.0, 6.0), (0.0, dice.uniform(4.0, 20.0), 0.0, 0.0)]


def drone(dice: Dice) -> list[Piece]:
    """In the air, with all the noise of its propellers."""
    return [(dice.normal(0.0, 20.0), dice.uniform(2.0, 8.0), 1.0, 3.0)]


def indexing(dice: Dice) -> list[Piece]:
    """A stage that turns slowly and stops."""
    turn_dps = float(dice.choice([-1.0, 1.0]) * dice.uniform(0.2, 3.0))
    return [(turn_dps, dice.uniform(4.0, 30.0), 0.0, 0.0), (0.0, dice.uniform(3.0, 8.0), 0.0, 0.0)]


def belt(dice: Dice) -> list[Piece]:
    """On the belt of somebody who walks and stands, and sways a little then."""
    walk = [
        (float(side) * 30.0 + dice.normal(0.0, 3.0), 0.55, 0.0, 5.0)
        for side in np.resize([-1.0, 1.0], int(dice.integers(20, 70)))
    ]
    return [*walk, (0.0, dice.uniform(2.0, 6.0), 0.0, 0.15)]


def boat(dice: Dice) -> list[Piece]:
    """At anchor: to and fro, for ever."""
    size_dps, period_s = dice.uniform(0.5, 3.0), dice.uniform(6.0, 20.0)
    at_s = np.arange(0.0, period_s, 0.3)
    return [(size_dps * float(np.sin(2.0 * np.pi * each_s / period_s)), 0.3, 0.0, 0.1) for each_s in at_s]


MOTIONS: Mapping[str, Callable[[Dice], list[Piece]]] = {
    "robot cleaner": vacuum,
    "in the hand": hand,
    "drone": drone,
    "slow stage": indexing,
    "on a belt": belt,
    "boat": boat,
}


def session(motion: str, number: int, *, is_still: bool) -> tuple[Floats, Floats, Floats]:
    """Times in s, measured rates in deg/s, true yaw in deg."""
    dice = np.random.default_rng([2, list(MOTIONS).index(motion), number])
    true_dps, more_noise_dps = put_together(dice, MOTIONS[motion], is_still=is_still)
    samples = len(true_dps)
    bias_dps = dice.normal(0.0, 0.5) + unrest(dice, samples, 100.0, 0.01) + unrest(dice, samples, 3.0, 0.004)
    noise_dps = dice.standard_normal(samples) * np.hypot(NOISE_DPS, more_noise_dps)
    measured_dps = np.round((true_dps + bias_dps + noise_dps) / RESOLUTION_DPS) * RESOLUTION_DPS
    turned_deg = np.cumsum(0.5 * (true_dps + np.r_[true_dps[0], true_dps[:-1]])) / RATE_HZ
    return np.arange(samples) / RATE_HZ, measured_dps, turned_deg - turned_deg[0]


def test_everyday_motions() -> None:
    """Mean |yaw error| in deg over sessions of ten minutes, everything at its defaults."""
    chosen = [BY_KEY[key] for key in METHODS if BY_KEY[key].is_installed]
    rows = []
    for motion in MOTIONS:
        for is_still in (True, False):
            sessions = [session(motion, number, is_still=is_still) for number in range(SESSIONS)]
            e_deg = [
                np.mean([np.abs(method.run(t_s, w, method.defaults) - yaw).mean() for t_s, w, yaw in sessions])
                for method in chosen
            ]
            told = ", ".join(f"{method.title} {found:.3g}" for method, found in zip(chosen, e_deg, strict=True))
            rows.append((f"{motion}, {'still' if is_still else 'moving'}", told))
    show(f"Everyday motions, mean E in deg of {SESSIONS} sessions", rows)
