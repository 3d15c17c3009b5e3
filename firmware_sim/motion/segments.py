"""Segments of a motion; chirp and multisine are in `waves`.

A segment has a rate and the angle gained since its start, in closed form, or as the exact integral of straight lines.
It starts at the final rate of the previous segment.
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


class Rest(Checked):
    """Rest for `seconds`."""

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
    """Change from the present rate to `to_dps` at constant acceleration."""

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
    """Constant rate."""

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
    """Present rate plus a sine of `amplitude_dps` at `frequency_hz`."""

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
    """Base of segments with linear rates between knots; the angle is the exact integral."""

    def _knots(self) -> tuple[list[float], list[float]]:
        """Times, s, and rates, deg/s; the first knot is at 0 s."""
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
    """All `rates_dps` in turn, added to the present rate, for `hold_seconds`, with ramps of `ramp_seconds`."""

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
    """Vehicle: smooth curves of random rates, with short stops.

    Every `curve_seconds` the rate approaches another value, normal with `rms_dps`. A share of the values is 0, and the
    vehicle stops for that time. The same `seed` gives the same drive.
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
