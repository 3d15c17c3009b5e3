"""Smooth functions of time, with their derivatives: steps between values, and tones inside a window.

A step is the polynomial of the ninth degree whose first four derivatives are zero at both ends:
S(u) = 126u⁵ − 420u⁶ + 540u⁷ − 315u⁸ + 70u⁹. Its highest slope is 2.46. So a motion has a continuous snap, and a rest is
exact: all derivatives are 0.
"""

from dataclasses import dataclass, field
from math import comb, pi

import numpy as np

from firmware_sim.effects.effect import Floats, Rng

ORDER = 4
"""Highest derivative: the acceleration of a rate that follows from an acceleration."""

PEAK_SLOPE = 630.0 / 256.0
"""Highest slope of a step of height 1 in time 1, at its middle: 630·(1/4)⁴."""


@dataclass(slots=True)
class StepTrack:
    """A value that moves in steps, one after the other.

    start
        Value before the first step.
    """

    start: float = 0.0
    _starts_s: list[float] = field(default_factory=list)
    _seconds: list[float] = field(default_factory=list)
    _values: list[float] = field(default_factory=list)

    @property
    def end(self) -> float:
        """Value after the last step."""
        return self._values[-1] if self._values else self.start

    def move_to(self, value: float, start_s: float, seconds: float) -> None:
        """Add a step to a value; it starts after the end of the last one."""
        self._values.append(value)
        self._starts_s.append(start_s)
        self._seconds.append(seconds)

    def values_at(self, t_s: Floats) -> Floats:
        """Value and derivatives, shape (ORDER + 1, n)."""
        if not self._values:
            return np.concatenate([np.full((1, len(t_s)), self.start), np.zeros((ORDER, len(t_s)))])
        chosen = np.maximum(np.searchsorted(self._starts_s, t_s, side="right") - 1, 0)
        after = np.array(self._values)
        before = np.concatenate([[self.start], after[:-1]])
        seconds = np.array(self._seconds)[chosen]
        shape = _smooth(np.clip((t_s - np.array(self._starts_s)[chosen]) / seconds, 0.0, 1.0))
        track: Floats = shape * (after - before)[chosen] / seconds ** np.arange(ORDER + 1)[:, None]
        # After a step the value is the new one to the last bit, so that a rest has no rate.
        track[0] = np.where(shape[0] >= 1.0, after[chosen], before[chosen] + track[0])
        return track


def _smooth(u: Floats) -> Floats:
    """The step at shares of its time, and its derivatives, shape (ORDER + 1, n); exact zeros at both ends."""
    w, slope = u * (1.0 - u), 1.0 - 2.0 * u
    value = u**5 * (126.0 + u * (-420.0 + u * (540.0 + u * (-315.0 + 70.0 * u))))
    return np.stack(
        [
            value,
            630.0 * w**4,
            2520.0 * w**3 * slope,
            2520.0 * w**2 * (3.0 * slope**2 - 2.0 * w),
            15120.0 * w * slope * (slope**2 - 3.0 * w),
        ]
    )


@dataclass(frozen=True, slots=True)
class Tones:
    """Sum of sines."""

    amplitudes: Floats
    frequencies_hz: Floats
    phases: Floats

    def values_at(self, t_s: Floats) -> Floats:
        """Value and derivatives, shape (ORDER + 1, n)."""
        track = np.zeros((ORDER + 1, len(t_s)))
        for amplitude, frequency_hz, phase in zip(self.amplitudes, self.frequencies_hz, self.phases, strict=True):
            omega = 2.0 * pi * frequency_hz
            sine, cosine = np.sin(omega * t_s + phase), np.cos(omega * t_s + phase)
            for order, wave in enumerate((sine, cosine, -sine, -cosine, sine)):
                track[order] += amplitude * omega**order * wave
        return track


def drawn_tones(rng: Rng, rms: float, band_hz: tuple[float, float], fall: float = 1.0, count: int = 5) -> Tones:
    """Tones of a total root mean square in a band, with amplitudes ∝ 1/frequency^`fall` and random phases.

    The frequencies are even in their logarithm, but for a random tenth of their spacing: so the sum does not repeat.
    """
    edges = np.geomspace(*band_hz, count + 1)
    frequencies_hz = edges[:-1] * (edges[1:] / edges[:-1]) ** rng.uniform(0.45, 0.55, count)
    weights = frequencies_hz**-fall
    amplitudes = rms * np.sqrt(2.0) * weights / np.linalg.norm(weights)
    return Tones(amplitudes, frequencies_hz, rng.uniform(0.0, 2.0 * pi, count))


@dataclass(frozen=True, slots=True)
class Track:
    """Steps, and tones inside a window that opens and closes in steps."""

    steps: StepTrack
    tones: Tones | None = None
    window: StepTrack | None = None

    def values_at(self, t_s: Floats) -> Floats:
        """Value and derivatives, shape (ORDER + 1, n)."""
        track = self.steps.values_at(t_s)
        if self.tones is None:
            return track
        tones = self.tones.values_at(t_s)
        added: Floats = tones if self.window is None else _product(self.window.values_at(t_s), tones)
        return track + added


def _product(first: Floats, then: Floats) -> Floats:
    """Product of two functions with their derivatives, by the rule of Leibniz."""
    return np.stack(
        [
            np.sum([comb(order, k) * first[k] * then[order - k] for k in range(order + 1)], axis=0)
            for order in range(ORDER + 1)
        ]
    )
