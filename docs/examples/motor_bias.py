"""A bias while the table turns, from motor currents."""

from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from firmware_sim.effects import catalogue
from firmware_sim.effects.effect import Act, Effect, EffectSlot, Rng
from gyrodrift.diagnose.simulate import candidates
from gyrodrift.diagnose.simulate.candidate import Need, Touches
from gyrodrift.diagnose.simulate.candidate_kind import CandidateKind
from gyrodrift.diagnose.simulate.grids import linear


@catalogue.register
class MotorBias(Effect):
    """A bias while the table turns faster than 1 deg/s. Typical: 0.1 deg/s."""

    name: Literal["motor_bias"] = "motor_bias"
    bias_dps: Annotated[float, Field(ge=-5.0, le=5.0)]
    stage: ClassVar[str] = "platform"
    slot: ClassVar[EffectSlot] = EffectSlot.RATE
    typical: ClassVar[dict[str, float]] = {"bias_dps": 0.1}
    small: ClassVar[dict[str, float]] = {"bias_dps": 0.02}

    def begin(self, rng: Rng, sample_rate_hz: float) -> Act:
        """Add the bias to the sampled rate."""
        return lambda rate, moments: rate + self.bias_dps * (np.abs(moments.rate_dps) > 1.0)


candidates.register(
    CandidateKind(
        name="motor_bias",
        parameter="bias_dps",
        variants=linear(0.001, 1.0),
        meaning="the bias changes while the motor turns",
        needs=(Need.MOTION,),
        touches=Touches.SLOW_RATE,
        matters_from=0.004,
    )
)
