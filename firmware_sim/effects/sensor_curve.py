"""Static curve of the sensor: gain, asymmetry, nonlinearity, dead band, saturation, quantization."""

from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from firmware_sim.effects.effect import Act, Effect, EffectSlot, Rng

FULL_SCALE_DPS = 250.0
"""Full scale of the nonlinearity, deg/s: the finest range of an MPU-6050."""


class ScaleFactor(Effect):
    """Rate × (1 + e). Typical e: 0.5 to 3 % (sensitivity tolerance of MEMS data sheets)."""

    name: Literal["scale_factor"] = "scale_factor"
    error_percent: Annotated[float, Field(ge=-20.0, le=20.0)]
    stage: ClassVar[str] = "sensor"
    slot: ClassVar[EffectSlot] = EffectSlot.RATE
    typical: ClassVar[dict[str, float]] = {"error_percent": 1.5}
    small: ClassVar[dict[str, float]] = {"error_percent": 0.2}

    def begin(self, rng: Rng, sample_rate_hz: float) -> Act:
        """Gain."""
        return lambda rate, _: rate * (1.0 + self.error_percent / 100.0)


class ScaleAsymmetry(Effect):
    """Rate + e·abs(rate): too large in one direction, too small in the other. Typical e: 0.1 to 0.5 %."""

    name: Literal["scale_asymmetry"] = "scale_asymmetry"
    error_percent: Annotated[float, Field(ge=-20.0, le=20.0)]
    stage: ClassVar[str] = "sensor"
    slot: ClassVar[EffectSlot] = EffectSlot.RATE
    typical: ClassVar[dict[str, float]] = {"error_percent": 0.4}
    small: ClassVar[dict[str, float]] = {"error_percent": 0.1}

    def begin(self, rng: Rng, sample_rate_hz: float) -> Act:
        """Gain by direction."""
        return lambda rate, moments: rate + self.error_percent / 100.0 * np.abs(moments.rate_dps)


class Nonlinearity(Effect):
    """Rate + e·FS·(rate/FS)³ with FS = 250 deg/s. Typical e: 0.05 to 0.2 % of full scale."""

    name: Literal["nonlinearity"] = "nonlinearity"
    error_percent_fs: Annotated[float, Field(ge=-10.0, le=10.0)]
    stage: ClassVar[str] = "sensor"
    slot: ClassVar[EffectSlot] = EffectSlot.RATE
    typical: ClassVar[dict[str, float]] = {"error_percent_fs": 0.2}
    small: ClassVar[dict[str, float]] = {"error_percent_fs": 0.05}

    def begin(self, rng: Rng, sample_rate_hz: float) -> Act:
        """Cubic."""
        share = self.error_percent_fs / 100.0 / FULL_SCALE_DPS**2
        return lambda rate, moments: rate + share * moments.rate_dps**3


class Deadband(Effect):
    """Output below a width reads 0. Typical: 0.05 to 0.5 deg/s (parts with zero-rate suppression)."""

    name: Literal["deadband"] = "deadband"
    width_dps: Annotated[float, Field(ge=0.0, le=20.0)]
    stage: ClassVar[str] = "sensor"
    slot: ClassVar[EffectSlot] = EffectSlot.OUTPUT
    typical: ClassVar[dict[str, float]] = {"width_dps": 0.5}
    small: ClassVar[dict[str, float]] = {"width_dps": 0.1}

    def begin(self, rng: Rng, sample_rate_hz: float) -> Act:
        """Suppression."""
        return lambda rate, _: np.where(np.abs(rate) < self.width_dps, 0.0, rate)


class Saturation(Effect):
    """Output clipped at ± a limit, without a flag. Typical: a range of 125 to 2000 deg/s."""

    name: Literal["saturation"] = "saturation"
    limit_dps: Annotated[float, Field(ge=1.0, le=4000.0)]
    stage: ClassVar[str] = "sensor"
    slot: ClassVar[EffectSlot] = EffectSlot.OUTPUT
    typical: ClassVar[dict[str, float]] = {"limit_dps": 125.0}
    small: ClassVar[dict[str, float]] = {"limit_dps": 170.0}

    def begin(self, rng: Rng, sample_rate_hz: float) -> Act:
        """Clipping."""
        return lambda rate, _: np.clip(rate, -self.limit_dps, self.limit_dps)


class Quantization(Effect):
    """Output in steps coarser than a count. Typical: 1/131 to 1/16 deg/s, × 16 on a 12-bit path."""

    name: Literal["quantization"] = "quantization"
    step_dps: Annotated[float, Field(ge=1e-6, le=20.0)]
    stage: ClassVar[str] = "sensor"
    slot: ClassVar[EffectSlot] = EffectSlot.OUTPUT
    typical: ClassVar[dict[str, float]] = {"step_dps": 0.25}
    small: ClassVar[dict[str, float]] = {"step_dps": 0.0625}

    def begin(self, rng: Rng, sample_rate_hz: float) -> Act:
        """Rounding."""
        return lambda rate, _: np.rint(rate / self.step_dps) * self.step_dps
