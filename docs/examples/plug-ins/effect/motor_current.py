"""Effect `motor_current`: a bias while the table turns, from the current of its motor."""

from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from firmware_sim.effects.effect import Act, Effect, EffectSlot, Rng
from gyrodrift.diagnose.simulate.candidate import Need, Touches
from gyrodrift.diagnose.simulate.candidate_kind import CandidateKind
from gyrodrift.diagnose.simulate.grids import linear

GYRODRIFT_API = 1


class MotorCurrent(Effect):
    """A bias while the table turns faster than 1 deg/s. Typical: 0.1 deg/s."""

    name: Literal["motor_current"] = "motor_current"
    bias_dps: Annotated[float, Field(ge=-5.0, le=5.0)]
    stage: ClassVar[str] = "platform"
    slot: ClassVar[EffectSlot] = EffectSlot.RATE
    typical: ClassVar[dict[str, float]] = {"bias_dps": 0.1}
    small: ClassVar[dict[str, float]] = {"bias_dps": 0.02}
    candidate: ClassVar[CandidateKind] = CandidateKind(
        name="motor_current",
        parameter="bias_dps",
        variants=linear(0.001, 1.0),
        meaning="the bias changes while the motor turns",
        needs=(Need.MOTION,),
        touches=Touches.SLOW_RATE,
        matters_from=0.004,
    )

    def begin(self, rng: Rng, sample_rate_hz: float) -> Act:
        """Add the bias to the sampled rate."""
        return lambda rate, moments: rate + self.bias_dps * (np.abs(moments.rate_dps) > 1.0)
