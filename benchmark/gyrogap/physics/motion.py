"""Motion of a motor in one session: pieces of rate on a fine grid, each from standstill to standstill.

A piece never jumps: rates change along half a cosine, at accelerations a small motor has. Order, rates and lengths of
the pieces are drawn for every session.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gyrogap.physics.dice import Rng, sign

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]

STEP_SPEEDS_DPS = (5.5, 11.0, 24.0, 48.0, 80.0, 125.0, 193.0)
TOP_DPS = 193.0
LEAST_RAMP_S = 0.3
LEAST_HOLD_S = 2.5


@dataclass(frozen=True, slots=True)
class TableMotion:
    """Rate in deg/s on a grid of `step_s`, and where the motor is on; shape (n,) each."""

    step_s: float
    rate_dps: Floats
    motor_on: Mask


def session_motion(rng: Rng, step_s: float, seconds: float, still_factor: float = 1.0) -> TableMotion:
    """Still from power-on; steps both ways in both orders, turns at two speeds, reversals, shaking, a slow ramp."""
    first = _still(step_s, still_factor * rng.uniform(40.0, 55.0))
    last_s, gaps_s = still_factor * rng.uniform(18.0, 28.0), rng.uniform(3.0, 7.0, 7)
    pieces = [
        _turns(step_s, sign(rng) * rng.uniform(75.0, 110.0), rng.uniform(4.0, 6.0)),
        _turns(step_s, sign(rng) * rng.uniform(32.0, 48.0), rng.uniform(3.0, 4.0)),
        _reversals(step_s, rng),
        _multisine(step_s, rng) if rng.random() < 0.65 else _chirp(step_s, rng),
        _slow_ramp(step_s, rng),
    ]
    left_s = seconds - last_s - gaps_s.sum() - step_s * (len(first) + sum(map(len, pieces)))
    pieces += _both_orders(step_s, rng, left_s)
    rates, powered = [first], [np.zeros(len(first), bool)]
    for gap_s, which in zip(gaps_s, rng.permutation(len(pieces)), strict=True):
        gap = _still(step_s, gap_s)
        rates += [pieces[which], gap]
        powered += [np.ones(len(pieces[which]), bool), np.zeros(len(gap), bool)]
    return _cut(step_s, np.concatenate(rates), np.concatenate(powered), round(seconds / step_s))


def _cut(step_s: float, rate_dps: Floats, motor_on: Mask, points: int) -> TableMotion:
    """The last still is what is left; a session that came out too long ends early."""
    missing = max(0, points - len(rate_dps))
    rate_dps = np.concatenate([rate_dps, np.zeros(missing)])[:points]
    return TableMotion(step_s, rate_dps, np.concatenate([motor_on, np.zeros(missing, bool)])[:points])


def _still(step_s: float, seconds: float) -> Floats:
    return np.zeros(round(seconds / step_s))


def _ramp(step_s: float, from_dps: float, to_dps: float, seconds: float) -> Floats:
    points = max(2, round(seconds / step_s))
    rise: Floats = 0.5 - 0.5 * np.cos(np.pi * np.arange(points) / points)
    return from_dps + (to_dps - from_dps) * rise


def _sequence(step_s: float, rates_dps: list[float], hold_s: Floats, ramp_s_of: float, least_s: float) -> Floats:
    """One rate after the other and back to zero; `ramp_s_of` is the time for one deg/s of change."""
    parts, before = [], 0.0
    for rate_dps, seconds in zip(rates_dps, hold_s, strict=True):
        ramp_s = max(least_s, abs(rate_dps - before) * ramp_s_of)
        parts += [_ramp(step_s, before, rate_dps, ramp_s), np.full(round(seconds / step_s), rate_dps)]
        before = rate_dps
    parts.append(_ramp(step_s, before, 0.0, max(least_s, abs(before) * ramp_s_of)))
    return np.concatenate(parts)


def _both_orders(step_s: float, rng: Rng, seconds: float) -> list[Floats]:
    """Steps up through the speeds with alternating signs, and down again with the other signs, in `seconds`."""
    speeds_dps = np.array(STEP_SPEEDS_DPS) * rng.uniform(0.97, 1.03, len(STEP_SPEEDS_DPS))
    ways = sign(rng) * np.tile([1.0, -1.0], len(speeds_dps))
    up_dps = (np.repeat(speeds_dps, 2) * ways).tolist()
    down_dps = [-rate for rate in reversed(up_dps)]
    ramp_s_of = 1.0 / rng.uniform(250.0, 500.0)
    ramps_s = [_sequence(step_s, order, np.zeros(14), ramp_s_of, LEAST_RAMP_S) for order in (up_dps, down_dps)]
    hold_s = max(LEAST_HOLD_S, (seconds - step_s * sum(map(len, ramps_s))) / 28.0)
    shares = rng.uniform(0.8, 1.2, (2, 14))
    holds_s = hold_s * shares / shares.mean()
    return [
        _sequence(step_s, order, hold, ramp_s_of, LEAST_RAMP_S)
        for order, hold in zip((up_dps, down_dps), holds_s, strict=True)
    ]


def _turns(step_s: float, rate_dps: float, turns: float) -> Floats:
    return _sequence(step_s, [rate_dps], np.array([turns * 360.0 / abs(rate_dps)]), 0.004, LEAST_RAMP_S)


def _reversals(step_s: float, rng: Rng) -> Floats:
    """Eight to eleven sharp ones: a tenth of a second from full speed to full speed the other way."""
    count, speed_dps = int(rng.integers(8, 12)), sign(rng) * rng.uniform(40.0, 75.0)
    rates_dps = [speed_dps * (-1.0) ** number for number in range(count)]
    return _sequence(step_s, rates_dps, rng.uniform(0.8, 1.8, count), 0.0, rng.uniform(0.07, 0.13))


def _window(points: int, step_s: float, edge_s: float = 1.0) -> Floats:
    """From 0 to 1 and back, along half a cosine at either end."""
    into_s = np.minimum(np.arange(points), np.arange(points)[::-1]) * step_s
    window: Floats = 0.5 - 0.5 * np.cos(np.pi * np.minimum(into_s / edge_s, 1.0))
    return window


def _multisine(step_s: float, rng: Rng) -> Floats:
    t_s = np.arange(round(rng.uniform(38.0, 50.0) / step_s)) * step_s
    tones_hz = 0.2 * (rng.uniform(8.0, 10.0) / 0.2) ** rng.uniform(0.0, 1.0, 26)
    phases = rng.uniform(0.0, 2.0 * np.pi, len(tones_hz))
    summed = sum(np.sin(2.0 * np.pi * hz * t_s + phase) for hz, phase in zip(tones_hz, phases, strict=True))
    rate_dps: Floats = rng.uniform(24.0, 34.0) * np.sqrt(2.0 / len(tones_hz)) * summed * _window(len(t_s), step_s)
    return np.clip(rate_dps, -TOP_DPS, TOP_DPS)


def _chirp(step_s: float, rng: Rng) -> Floats:
    """A sine whose frequency grows in equal ratios; fast ones are smaller, for the sake of the motor."""
    seconds, top_hz = rng.uniform(38.0, 50.0), rng.uniform(8.0, 10.0)
    t_s = np.arange(round(seconds / step_s)) * step_s
    growth = np.log(top_hz / 0.2) / seconds
    phase = 2.0 * np.pi * 0.2 * np.expm1(growth * t_s) / growth
    size_dps = rng.uniform(50.0, 75.0) / np.sqrt(1.0 + 0.2 * np.exp(growth * t_s))
    rate_dps: Floats = size_dps * np.sin(phase) * _window(len(t_s), step_s)
    return rate_dps


def _slow_ramp(step_s: float, rng: Rng) -> Floats:
    """Through zero at some hundredths of a deg/s in a second."""
    ends_dps = sign(rng) * rng.uniform(2.5, 3.5)
    points = round(rng.uniform(42.0, 55.0) / step_s)
    slow = np.linspace(-ends_dps, ends_dps, points)
    return np.concatenate([_ramp(step_s, 0.0, -ends_dps, 1.0), slow, _ramp(step_s, ends_dps, 0.0, 1.0)])
