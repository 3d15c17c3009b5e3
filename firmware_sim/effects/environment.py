"""Effects of temperature. The sensor heats itself by 8 °C within minutes after power-on."""

from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from firmware_sim.effects.effect import Act, Effect, EffectSlot, Floats, Moments, Rng

REFERENCE_C = 25.0
"""Temperature at which the effects are zero, °C."""

SINGLE_DECAY = {"fast_share": 0.0, "fast_time_constant_s": 30.0}
"""Parameters of a warm-up with a single decay."""

SELF_HEATING_C = 8.0
SELF_HEATING_S = 240.0
"""A small board in still air (MPU-6050 field reports: stable after ten to fifteen minutes)."""


def sensor_temperature_c(ambient_c: Floats, powered_s: Floats) -> Floats:
    """Ambient temperature plus self-heating, °C, in the shape of both."""
    return ambient_c + SELF_HEATING_C * (1.0 - np.exp(-powered_s / SELF_HEATING_S))


class TempBias(Effect):
    """Bias k·ΔT·(1 + c·ΔT), with ΔT = T − 25 °C. Typical k: 0.005 to 0.16 deg/s/°C; c: 0 (a line) to ± 0.02 /°C."""

    name: Literal["temp_bias"] = "temp_bias"
    slope_dps_per_c: Annotated[float, Field(ge=-2.0, le=2.0)]
    curve_per_c: Annotated[float, Field(ge=-0.5, le=0.5)] = 0.0
    stage: ClassVar[str] = "environment"
    slot: ClassVar[EffectSlot] = EffectSlot.RATE
    typical: ClassVar[dict[str, float]] = {"slope_dps_per_c": 0.03, "curve_per_c": 0.0}
    small: ClassVar[dict[str, float]] = {"slope_dps_per_c": 0.005, "curve_per_c": 0.0}

    def begin(self, rng: Rng, sample_rate_hz: float) -> Act:
        """A line, or a parabola."""

        def act(rate: Floats, moments: Moments) -> Floats:
            over_c = moments.temp_c - REFERENCE_C
            changed: Floats = rate + self.slope_dps_per_c * over_c * (1.0 + self.curve_per_c * over_c)
            return changed

        return act


class TempScale(Effect):
    """Gain 1 + k·(T − 25 °C). Typical k: 0.005 to 0.05 %/°C."""

    name: Literal["temp_scale"] = "temp_scale"
    slope_percent_per_c: Annotated[float, Field(ge=-2.0, le=2.0)]
    stage: ClassVar[str] = "environment"
    slot: ClassVar[EffectSlot] = EffectSlot.RATE
    typical: ClassVar[dict[str, float]] = {"slope_percent_per_c": 0.05}
    small: ClassVar[dict[str, float]] = {"slope_percent_per_c": 0.02}

    def begin(self, rng: Rng, sample_rate_hz: float) -> Act:
        """Linear."""
        return lambda rate, m: rate + self.slope_percent_per_c / 100.0 * (m.temp_c - REFERENCE_C) * m.rate_dps


class Warmup(Effect):
    """Bias A·exp(−t/τ) after power-on; a share may decay faster, like a die inside its package.

    Typical: 0.05 to 0.5 deg/s over 30 to 600 s.
    """

    name: Literal["warmup"] = "warmup"
    amplitude_dps: Annotated[float, Field(ge=-20.0, le=20.0)]
    time_constant_s: Annotated[float, Field(ge=1.0, le=1e5)] = 120.0
    fast_share: Annotated[float, Field(ge=0.0, le=1.0)] = 0.0
    fast_time_constant_s: Annotated[float, Field(ge=1.0, le=1e5)] = 30.0
    stage: ClassVar[str] = "environment"
    slot: ClassVar[EffectSlot] = EffectSlot.RATE
    typical: ClassVar[dict[str, float]] = {"amplitude_dps": 0.3, "time_constant_s": 120.0, **SINGLE_DECAY}
    small: ClassVar[dict[str, float]] = {"amplitude_dps": 0.05, "time_constant_s": 120.0, **SINGLE_DECAY}

    def begin(self, rng: Rng, sample_rate_hz: float) -> Act:
        """One decay, or two."""

        def act(rate: Floats, moments: Moments) -> Floats:
            remaining = np.exp(-moments.powered_s / self.time_constant_s)
            if self.fast_share:
                fast = np.exp(-moments.powered_s / self.fast_time_constant_s)
                remaining = remaining + self.fast_share * (fast - remaining)
            changed: Floats = rate + self.amplitude_dps * remaining
            return changed

        return act
