"""Segments whose angle has no closed form: integrated once, on a grid for errors below 1e-9 degrees."""

from functools import cached_property
from math import pi
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from firmware_sim.effects.effect import Floats
from firmware_sim.motion.segments import FrequencyHz, RateDps, Seconds
from firmware_sim.yaml_file import Checked

FADE_S = 1.0
"""Time of fading in and out, s, so that the rate never jumps."""

GRID_PER_PERIOD = 200.0


class _Integrated(Checked):
    """Base of segments whose angle has no closed form: Simpson's rule, with cubic Hermite interpolation."""

    seconds: Seconds

    def _wave_dps(self, t_s: Floats) -> Floats:
        """Rate that is added to the present one, before fading, deg/s."""
        raise TypeError("an integrated segment has a wave")

    def _highest_hz(self) -> float:
        raise TypeError("an integrated segment knows its highest frequency")

    def _faded_dps(self, t_s: Floats) -> Floats:
        fade_s = min(FADE_S, self.seconds / 4.0)
        edge = np.clip(np.minimum(t_s, self.seconds - t_s) / fade_s, 0.0, 1.0)
        return self._wave_dps(t_s) * 0.5 * (1.0 - np.cos(pi * edge))

    @cached_property
    def _angles(self) -> tuple[float, Floats, Floats]:
        """Step of the grid, s, and rates and angles at its points."""
        steps = int(np.ceil(self.seconds * max(self._highest_hz(), 1.0) * GRID_PER_PERIOD))
        grid_s = np.linspace(0.0, self.seconds, steps + 1)
        rates = self._faded_dps(grid_s)
        middles = self._faded_dps(0.5 * (grid_s[1:] + grid_s[:-1]))
        step_s = self.seconds / steps
        gained = (rates[:-1] + 4.0 * middles + rates[1:]) * step_s / 6.0
        return step_s, rates, np.concatenate([[0.0], np.cumsum(gained)])

    def end_rate_dps(self, start_dps: float) -> float:
        """Rate after the segment, deg/s."""
        return start_dps

    def rate_dps(self, t_s: Floats, start_dps: float) -> Floats:
        """Rate at `t_s` into the segment, deg/s."""
        return start_dps + self._faded_dps(t_s)

    def angle_deg(self, t_s: Floats, start_dps: float) -> Floats:
        """Angle gained at `t_s` into the segment, degrees."""
        step_s, rates, angles = self._angles
        point = np.clip((t_s / step_s).astype(np.int64), 0, len(angles) - 2)
        u = t_s / step_s - point
        rise = angles[point + 1] - angles[point]
        slope_start, slope_end = rates[point] * step_s, rates[point + 1] * step_s
        curve = u * (1.0 - u) * ((slope_start - rise) * (1.0 - u) - (slope_end - rise) * u)
        angle: Floats = start_dps * t_s + angles[point] + rise * u + curve
        return angle


class Chirp(_Integrated):
    """Sine of `amplitude_dps` whose frequency changes linearly from `from_hz` to `to_hz`."""

    kind: Literal["chirp"]
    amplitude_dps: RateDps
    from_hz: FrequencyHz
    to_hz: FrequencyHz

    def _wave_dps(self, t_s: Floats) -> Floats:
        turns = self.from_hz * t_s + 0.5 * (self.to_hz - self.from_hz) * t_s**2 / self.seconds
        return self.amplitude_dps * np.sin(2.0 * pi * turns)

    def _highest_hz(self) -> float:
        return max(self.from_hz, self.to_hz)


class Multisine(_Integrated):
    """`tones` sines, evenly spaced in log frequency from `from_hz` to `to_hz`, with a total of `rms_dps`.

    Phases of Schroeder (1970), for low peaks.
    """

    kind: Literal["multisine"]
    rms_dps: RateDps
    from_hz: FrequencyHz
    to_hz: FrequencyHz
    tones: Annotated[int, Field(ge=1, le=200)]

    def _wave_dps(self, t_s: Floats) -> Floats:
        amplitude = self.rms_dps * np.sqrt(2.0 / self.tones)
        wave = np.zeros_like(t_s)
        for tone, frequency_hz in enumerate(np.geomspace(self.from_hz, self.to_hz, self.tones)):
            wave += amplitude * np.sin(2.0 * pi * frequency_hz * t_s - pi * tone * (tone + 1) / self.tones)
        return wave

    def _highest_hz(self) -> float:
        return max(self.from_hz, self.to_hz)
