"""The kinds of segments that a motion is made of.

Each gives its rate and the angle gained since its start, in closed form or as the exact integral of straight lines;
only where there is none (chirp, multisine) it is integrated once, on a grid fine enough for a billionth of a degree.
Every segment takes the rate at which the one before ended.
"""

from functools import cached_property
from math import pi
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from firmware_sim.effects.effect import Floats
from firmware_sim.yaml_file import Checked

Seconds = Annotated[float, Field(gt=0.0, le=1e6)]
RateDps = Annotated[float, Field(ge=-4000.0, le=4000.0)]
FrequencyHz = Annotated[float, Field(gt=0.0, le=1000.0)]

FADE_S = 1.0
"""Chirps and multisines fade in and out over this time, so that the rate never jumps."""

GRID_PER_PERIOD = 200.0


class Rest(Checked):
    """Standing still for `seconds`."""

    kind: Literal["rest"]
    seconds: Seconds

    def end_rate_dps(self, start_dps: float) -> float:
        """Rate after the segment, deg/s."""
        return 0.0

    def rate_dps(self, t_s: Floats, start_dps: float) -> Floats:
        """Rate at `t_s` into the segment, deg/s."""
        return np.zeros_like(t_s)

    def angle_deg(self, t_s: Floats, start_dps: float) -> Floats:
        """Angle gained at `t_s` into the segment, degrees."""
        return np.zeros_like(t_s)


class Ramp(Checked):
    """From the present rate to `to_dps` at constant acceleration."""

    kind: Literal["ramp"]
    seconds: Seconds
    to_dps: RateDps

    def end_rate_dps(self, start_dps: float) -> float:
        """Rate after the segment, deg/s."""
        return self.to_dps

    def rate_dps(self, t_s: Floats, start_dps: float) -> Floats:
        """Rate at `t_s` into the segment, deg/s."""
        return start_dps + (self.to_dps - start_dps) * t_s / self.seconds

    def angle_deg(self, t_s: Floats, start_dps: float) -> Floats:
        """Angle gained at `t_s` into the segment, degrees."""
        return start_dps * t_s + 0.5 * (self.to_dps - start_dps) * t_s**2 / self.seconds


class Hold(Checked):
    """Going on at the present rate."""

    kind: Literal["hold"]
    seconds: Seconds

    def end_rate_dps(self, start_dps: float) -> float:
        """Rate after the segment, deg/s."""
        return start_dps

    def rate_dps(self, t_s: Floats, start_dps: float) -> Floats:
        """Rate at `t_s` into the segment, deg/s."""
        return np.full_like(t_s, start_dps)

    def angle_deg(self, t_s: Floats, start_dps: float) -> Floats:
        """Angle gained at `t_s` into the segment, degrees."""
        return start_dps * t_s


class Sine(Checked):
    """The present rate plus a sine of `amplitude_dps` at `frequency_hz`."""

    kind: Literal["sine"]
    seconds: Seconds
    amplitude_dps: RateDps
    frequency_hz: FrequencyHz

    def end_rate_dps(self, start_dps: float) -> float:
        """Rate after the segment, deg/s."""
        return start_dps

    def rate_dps(self, t_s: Floats, start_dps: float) -> Floats:
        """Rate at `t_s` into the segment, deg/s."""
        return start_dps + self.amplitude_dps * np.sin(2.0 * pi * self.frequency_hz * t_s)

    def angle_deg(self, t_s: Floats, start_dps: float) -> Floats:
        """Angle gained at `t_s` into the segment, degrees."""
        turn_rate = 2.0 * pi * self.frequency_hz
        return start_dps * t_s + self.amplitude_dps / turn_rate * (1.0 - np.cos(turn_rate * t_s))


class _Lines(Checked):
    """Base of segments whose rate runs straight from knot to knot; the angle is the exact integral."""

    def _knots(self) -> tuple[list[float], list[float]]:
        """Times in s and rates in deg/s, the first of them at 0 s."""
        raise TypeError("a segment of straight lines has knots")

    @cached_property
    def _table(self) -> tuple[Floats, Floats, Floats, Floats]:
        """Times, rates, slopes and angles at the knots."""
        times, rates = (np.array(values) for values in self._knots())
        slopes = np.diff(rates) / np.diff(times)
        angles = np.concatenate([[0.0], np.cumsum(0.5 * (rates[1:] + rates[:-1]) * np.diff(times))])
        return times, rates, slopes, angles

    @property
    def seconds(self) -> float:
        """Length, s."""
        return float(self._table[0][-1])

    def end_rate_dps(self, start_dps: float) -> float:
        """Rate after the segment, deg/s."""
        return start_dps + float(self._table[1][-1])

    def rate_dps(self, t_s: Floats, start_dps: float) -> Floats:
        """Rate at `t_s` into the segment, deg/s."""
        times, rates, _, _ = self._table
        return start_dps + np.interp(t_s, times, rates)

    def angle_deg(self, t_s: Floats, start_dps: float) -> Floats:
        """Angle gained at `t_s` into the segment, degrees."""
        times, rates, slopes, angles = self._table
        knot = np.clip(np.searchsorted(times, t_s, side="right") - 1, 0, len(slopes) - 1)
        into = t_s - times[knot]
        angle: Floats = start_dps * t_s + angles[knot] + rates[knot] * into + 0.5 * slopes[knot] * into**2
        return angle


class Steps(_Lines):
    """Each of `rates_dps`, on top of the present rate, for `hold_seconds`, with ramps of `ramp_seconds`."""

    kind: Literal["steps"]
    rates_dps: Annotated[tuple[RateDps, ...], Field(min_length=1, strict=False)]
    ramp_seconds: Seconds
    hold_seconds: Seconds

    def _knots(self) -> tuple[list[float], list[float]]:
        times, rates = [0.0], [0.0]
        for rate_dps in self.rates_dps:
            times += [times[-1] + self.ramp_seconds, times[-1] + self.ramp_seconds + self.hold_seconds]
            rates += [rate_dps, rate_dps]
        return [*times, times[-1] + self.ramp_seconds], [*rates, 0.0]


class Drive(_Lines):
    """A vehicle: gentle curves of random rate, one after the other, with short stops now and then.

    Every `curve_seconds` the rate heads for another value, normal with `rms_dps`; a share of them is 0 and the
    vehicle stands for that long. The same `seed` is the same drive.
    """

    kind: Literal["drive"]
    minutes: Annotated[float, Field(gt=0.0, le=10000.0)]
    rms_dps: Annotated[float, Field(ge=0.0, le=1000.0)]
    curve_seconds: Seconds
    rest_share: Annotated[float, Field(ge=0.0, le=1.0)]
    seed: Annotated[int, Field(ge=0)]

    def _knots(self) -> tuple[list[float], list[float]]:
        rng = np.random.default_rng(self.seed)
        count = max(1, round(self.minutes * 60.0 / self.curve_seconds))
        times, rates = [0.0], [0.0]
        for _ in range(count - 1):
            stands = rng.random() < self.rest_share
            rate_dps = 0.0 if stands else self.rms_dps * float(rng.standard_normal())
            if stands:  # brake within a quarter, then stand
                times.append(times[-1] + 0.25 * self.curve_seconds)
                rates.append(0.0)
            times.append(times[-1] + self.curve_seconds * (0.75 if stands else 1.0))
            rates.append(rate_dps)
        return [*times, times[-1] + self.curve_seconds], [*rates, 0.0]


class _Integrated(Checked):
    """Base of segments whose angle has no closed form: integrated once by Simpson's rule, read by cubic Hermite."""

    seconds: Seconds

    def _wave_dps(self, t_s: Floats) -> Floats:
        """The rate that is added to the present one, before fading, deg/s."""
        raise TypeError("an integrated segment has a wave")

    def _highest_hz(self) -> float:
        raise TypeError("an integrated segment knows its highest frequency")

    def _faded_dps(self, t_s: Floats) -> Floats:
        fade_s = min(FADE_S, self.seconds / 4.0)
        edge = np.clip(np.minimum(t_s, self.seconds - t_s) / fade_s, 0.0, 1.0)
        return self._wave_dps(t_s) * 0.5 * (1.0 - np.cos(pi * edge))

    @cached_property
    def _angles(self) -> tuple[float, Floats, Floats]:
        """Step of the grid in s, rates and angles at its points."""
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
    """A sine of `amplitude_dps` whose frequency runs from `from_hz` to `to_hz` at a constant pace."""

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
    """`tones` sines, evenly spaced in log frequency from `from_hz` to `to_hz`, of `rms_dps` together.

    Phases after Schroeder (1970), which keep the peaks low.
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
