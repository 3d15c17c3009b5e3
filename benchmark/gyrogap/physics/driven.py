"""Motion without a table: a robot that trembles as it drives, a hand, a drone that hovers.

Their motion is random and never smooth: a band of frequencies and the tail above it, which falls with a power of the
frequency. A gyro shows some of that tail above its noise, and an encoder none.
"""

from typing import Literal

import numpy as np

from gyrogap.physics.dice import Rng, sign
from gyrogap.physics.motion import TOP_DPS, Floats, TableMotion

Mover = Literal["robot", "hand", "drone"]
MOVERS: tuple[Mover, ...] = ("robot", "hand", "drone")

EDGE_S = 0.5
"""Over which a motor, or a hand, begins and ends to tremble."""

STARTS_AT_REST = 0.6
"""Share of the sessions that begin with the device lying still, as after power-on."""


def driven_motion(rng: Rng, step_s: float, seconds: float, mover: Mover) -> TableMotion:
    """A session of one of MOVERS; it lies still at first, or moves already when it begins."""
    points = round(seconds / step_s)
    at_rest_s = rng.uniform(5.0, 15.0) if rng.random() < STARTS_AT_REST else 0.0
    moves = _moves(step_s, points, at_rest_s)
    rate_dps = _RATES[mover](rng, step_s, points) * moves
    return TableMotion(step_s, np.clip(rate_dps, -TOP_DPS, TOP_DPS), moves > 0.0)


def random_band(rng: Rng, step_s: float, points: int, band_hz: tuple[float, float], order: float) -> Floats:
    """Random values of standard deviation 1, (points,), even within a band; beyond it amplitudes fall as f^-order."""
    frequency_hz = np.fft.rfftfreq(points, step_s)
    low_hz, high_hz = band_hz
    shape = np.sqrt(1.0 / (1.0 + (frequency_hz / high_hz) ** (2.0 * order))) * (frequency_hz >= low_hz)
    waves = rng.standard_normal(len(shape)) + 1j * rng.standard_normal(len(shape))
    values: Floats = np.fft.irfft(waves * shape, points)
    standard: Floats = values / values.std()
    return standard


def _moves(step_s: float, points: int, at_rest_s: float) -> Floats:
    """0 at rest and 1 in motion, (points,), along half a cosine between both."""
    if at_rest_s == 0.0:
        return np.ones(points)
    into = (np.arange(points) * step_s - at_rest_s) / EDGE_S
    moves: Floats = 0.5 - 0.5 * np.cos(np.pi * np.clip(into, 0.0, 1.0))
    return moves


def _robot(rng: Rng, step_s: float, points: int) -> Floats:
    """Turns with pauses between them; it trembles all the while."""
    high_hz, order = np.exp(rng.uniform(np.log(4.0), np.log(20.0))), rng.uniform(1.5, 4.0)
    size_dps = np.exp(rng.uniform(np.log(0.6), np.log(3.0)))
    tremble = random_band(rng, step_s, points, (0.3, float(high_hz)), float(order))
    rate_dps: Floats = _turns(rng, step_s, points) + float(size_dps) * tremble
    return rate_dps


def _hand(rng: Rng, step_s: float, points: int) -> Floats:
    """To and fro once or twice a second, and the tremor of muscles."""
    to_and_fro = rng.uniform(15.0, 45.0) * random_band(rng, step_s, points, (0.5, 3.0), rng.uniform(4.0, 6.0))
    return to_and_fro + rng.uniform(0.2, 1.0) * random_band(rng, step_s, points, (6.0, 12.0), rng.uniform(3.0, 5.0))


def _drone(rng: Rng, step_s: float, points: int) -> Floats:
    """It sways, turns now and then, and its propellers shake it a little."""
    sways = rng.uniform(3.0, 10.0) * random_band(rng, step_s, points, (0.2, 1.0), rng.uniform(2.0, 4.0))
    shakes = rng.uniform(0.005, 0.02) * random_band(rng, step_s, points, (30.0, 80.0), 4.0)
    return sways + _turns(rng, step_s, points) + shakes


def _turns(rng: Rng, step_s: float, points: int) -> Floats:
    """A rate held for some seconds and none for some, in turn, with ramps along half a cosine, (points,)."""
    rate_dps, first = np.zeros(points), 0
    while first < points:
        first += round(rng.uniform(1.0, 4.0) / step_s)
        length = round(rng.uniform(3.0, 9.0) / step_s)
        part = rate_dps[first : first + length]
        edge = np.minimum(np.arange(length), np.arange(length)[::-1]) * step_s / rng.uniform(0.4, 1.0)
        turn = sign(rng) * rng.uniform(5.0, 90.0) * (0.5 - 0.5 * np.cos(np.pi * np.clip(edge, 0.0, 1.0)))
        part += turn[: len(part)]
        first += length
    return rate_dps


_RATES = {"robot": _robot, "hand": _hand, "drone": _drone}
