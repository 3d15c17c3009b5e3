"""Yaw rates that a bench is told to drive, deg/s at STEP_S: styles in any order, with rests before, between and after.

A style takes a generator, its duration, s, its largest rate, deg/s, and its fastest tone, Hz.
"""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from simulators.flaws import Floats, Rng
from simulators.unseen.drive import STEP_S

Style = Callable[[Rng, float, float, float], Floats]


def _steps(seconds: float) -> int:
    return max(1, round(seconds / STEP_S))


def _constant(rate_dps: float, seconds: float) -> Floats:
    return np.full(_steps(seconds), rate_dps)


def _lasts(parts: Sequence[Floats], seconds: float) -> bool:
    return sum(map(len, parts)) >= _steps(seconds)


def _joined(parts: Sequence[Floats], seconds: float) -> Floats:
    return np.concatenate(parts)[: _steps(seconds)]


def sweep(rng: Rng, seconds: float, amplitude_dps: float, most_hz: float) -> Floats:
    """Logarithmic chirp up, or up and down. Its amplitude falls above 1.2 Hz, so that accelerations stay moderate."""
    t_s = np.arange(_steps(seconds)) * STEP_S
    share = t_s / seconds
    share = 1 - np.abs(2 * share - 1) if rng.random() < 0.5 else share
    hz = 0.15 * (most_hz / 0.15) ** share
    phase = 2 * np.pi * np.cumsum(hz) * STEP_S + rng.uniform(0, 6.28)
    fade = np.minimum(1, np.minimum(t_s, seconds - t_s) / 0.5)
    swept: Floats = 0.6 * amplitude_dps * np.minimum(1.0, 1.2 / hz) * np.sin(phase) * fade
    return swept


def scan(rng: Rng, seconds: float, amplitude_dps: float, most_hz: float) -> Floats:
    """A slow ramp through zero, and slow scans to and fro."""
    ramp = np.linspace(-1, 1, _steps(0.3 * seconds)) * rng.choice([-1, 1]) * rng.uniform(3.0, 5.0)
    parts, sign = [ramp], rng.choice([-1.0, 1.0])
    while not _lasts(parts, seconds):
        speed_dps = rng.uniform(0.05, 0.25) * amplitude_dps
        parts.append(_constant(sign * speed_dps, min(rng.uniform(20.0, 70.0) / speed_dps, 6.0)))
        parts.append(_constant(0.0, rng.uniform(0.3, 1.0)))
        sign = -sign
    return _joined(parts, seconds)


def hand(rng: Rng, seconds: float, amplitude_dps: float, most_hz: float) -> Floats:
    """Filtered noise around 0.3 to 1.2 Hz, as of a hand; it fades to rest now and then."""
    count = _steps(seconds)
    hz = np.fft.rfftfreq(count, STEP_S)
    shape = hz / (1 + (hz / 0.5) ** 2) ** 1.5 / (1 + (hz / 2.5) ** 4)
    noise = np.fft.irfft(np.fft.rfft(rng.standard_normal(count)) * shape, count)
    gate = np.repeat(rng.random(int(seconds / 2.5) + 2) > 0.2, _steps(2.5))[:count].astype(float)
    gate = np.convolve(gate, np.hanning(301) / np.hanning(301).sum(), "same")
    moved: Floats = np.clip(0.45 * amplitude_dps * noise / noise.std(), -amplitude_dps, amplitude_dps) * gate
    return moved


def mission(rng: Rng, seconds: float, amplitude_dps: float, most_hz: float) -> Floats:
    """Drives: turns on the spot by round angles, gentle curves, straight legs and stops."""
    parts: list[Floats] = []
    while not _lasts(parts, seconds):
        kind = rng.random()
        if kind < 0.55:
            angle_deg = rng.choice([45, 90, 90, 135, 180, 360]) * rng.choice([-1, 1])
            speed_dps = amplitude_dps * rng.uniform(0.4, 1.0)
            parts.append(_constant(np.sign(angle_deg) * speed_dps, abs(angle_deg) / speed_dps))
        elif kind < 0.75:
            count = _steps(rng.uniform(2.5, 5.0))
            parts.append(amplitude_dps * rng.uniform(-0.3, 0.3) * np.sin(np.linspace(0, np.pi, count)))
        parts.append(_constant(0.0, rng.uniform(0.6, 2.2)))
    return _joined(parts, seconds)


def turns(rng: Rng, seconds: float, amplitude_dps: float, most_hz: float) -> Floats:
    """Long turns at two speeds in both directions."""
    slow, fast = np.array([0.35, 0.9]) * amplitude_dps * rng.uniform(0.9, 1.1)
    return np.concatenate([_constant(rate, seconds / 4) for rate in rng.permutation([slow, -slow, fast, -fast])])


def rock(rng: Rng, seconds: float, amplitude_dps: float, most_hz: float) -> Floats:
    """Whole cycles of sines of other frequencies and strengths, with short stops between them."""
    parts: list[Floats] = []
    while not _lasts(parts, seconds):
        hz = np.exp(rng.uniform(np.log(0.2), np.log(min(2.5, most_hz))))
        level_dps = amplitude_dps * rng.uniform(0.3, 1.0) * min(1.0, 0.9 / hz)
        t_s = np.arange(_steps(max(1, round(rng.uniform(3.0, 6.0) * hz)) / hz)) * STEP_S
        parts.append(rng.choice([-1, 1]) * level_dps * np.sin(2 * np.pi * hz * t_s))
        parts.append(_constant(0.0, rng.uniform(0.2, 0.8)))
    return _joined(parts, seconds)


def ramps(rng: Rng, seconds: float, amplitude_dps: float, most_hz: float) -> Floats:
    """Trapezoids: slow ramps to a held speed and on to one of the other sign; a quarter are stops."""
    parts: list[Floats] = []
    last_dps, sign = 0.0, rng.choice([-1.0, 1.0])
    while not _lasts(parts, seconds):
        rate_dps = 0.0 if rng.random() < 0.25 else sign * amplitude_dps * _share(rng)
        parts.append(np.linspace(last_dps, rate_dps, _steps(rng.uniform(0.5, 2.0))))
        parts.append(_constant(rate_dps, rng.uniform(0.8, 2.5)))
        last_dps, sign = rate_dps, -sign if rate_dps else sign
    return _joined(parts, seconds)


def _share(rng: Rng) -> float:
    """Often close to the largest rate."""
    return rng.uniform(0.8, 1.0) if rng.random() < 0.4 else rng.uniform(0.05, 0.8)


STYLES: Mapping[str, Style] = {style.__name__: style for style in (sweep, scan, hand, mission, turns, rock, ramps)}


def commanded_dps(
    rng: Rng, seconds: float, styles: Sequence[str], amplitude_dps: float, most_hz: float, most_dps2: float
) -> Floats:
    """Rates of a session, whose changes are limited to `most_dps2`, deg/s²."""
    order = rng.permutation(styles)
    rests_s = rng.uniform(2.0, 4.0, len(order) + 1)
    rests_s[0] = rng.uniform(4.0, 7.0)
    style_s = (seconds - rests_s.sum()) / len(order)
    parts = [_constant(0.0, rests_s[0])]
    for style, rest_s in zip(order, rests_s[1:], strict=True):
        parts.append(STYLES[style](rng, style_s, amplitude_dps * rng.uniform(0.85, 1.0), most_hz))
        parts.append(_constant(0.0, rest_s))
    return _limited(np.concatenate(parts), most_dps2 * STEP_S)


def _limited(rates_dps: Floats, most_dps: float) -> Floats:
    """Rates that change by at most `most_dps` in a step."""
    limited, rate_dps = np.empty_like(rates_dps), 0.0
    for index, wanted_dps in enumerate(rates_dps.tolist()):
        rate_dps += min(max(wanted_dps - rate_dps, -most_dps), most_dps)
        limited[index] = rate_dps
    return limited
