"""Effects of the readout: spikes, and samples that repeat the one before."""

from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from firmware_sim.effects.effect import Act, Effect, EffectSlot, Floats, Moments, Rng

SharePercent = Annotated[float, Field(ge=0.0, le=50.0)]


class Spikes(Effect):
    """Rare samples that are off by ± a height. Typical: one in 10⁵ to 10³, 10 to 500 deg/s (bus glitches)."""

    name: Literal["spikes"] = "spikes"
    height_dps: Annotated[float, Field(ge=0.0, le=4000.0)]
    share_percent: SharePercent = 0.1
    stage: ClassVar[str] = "sensor"
    slot: ClassVar[EffectSlot] = EffectSlot.OUTPUT
    typical: ClassVar[dict[str, float]] = {"height_dps": 50.0, "share_percent": 0.1}
    small: ClassVar[dict[str, float]] = {"height_dps": 5.0, "share_percent": 0.1}

    def begin(self, rng: Rng, sample_rate_hz: float) -> Act:
        """Independent spikes; one draw per sample decides on a spike and its sign."""

        def act(rate: Floats, _: Moments) -> Floats:
            draws, half = rng.random(len(rate)), self.share_percent / 200.0
            return rate + self.height_dps * ((draws < half).astype(np.float64) - (draws > 1.0 - half))

        return act


class StaleHold(Effect):
    """A sample repeats the rate of the one before. Typical: 0.01 to 5 % (reading faster than the sensor refreshes)."""

    name: Literal["stale_hold"] = "stale_hold"
    share_percent: SharePercent
    stage: ClassVar[str] = "link"
    slot: ClassVar[EffectSlot] = EffectSlot.HOLD
    typical: ClassVar[dict[str, float]] = {"share_percent": 2.0}
    small: ClassVar[dict[str, float]] = {"share_percent": 0.2}

    def begin(self, rng: Rng, sample_rate_hz: float) -> Act:
        """Last fresh value until the next fresh one."""
        last = [float("nan")]

        def act(rate: Floats, _: Moments) -> Floats:
            fresh = rng.random(len(rate)) >= self.share_percent / 100.0
            fresh[0] |= last[0] != last[0]  # the first sample has nothing to repeat
            values = np.concatenate([last, rate])
            output = values[np.maximum.accumulate(np.where(fresh, np.arange(1, len(values)), 0))]
            last[0] = float(output[-1])
            return output

        return act
