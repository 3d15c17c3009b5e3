"""Effects on the accelerometer: bias, walk, range, steps, and samples without acceleration."""

from math import sqrt
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from firmware_sim.effects.effect import Rng
from firmware_sim.effects.recursion import SLOW_STEP_S, OnePole, SlowTrack
from firmware_sim.effects.triaxial.effect import Sensed, TriaxialAct, TriaxialEffect, TriaxialMoments, TriaxialSlot

AccelBiasMps2 = Annotated[float, Field(ge=-20.0, le=20.0)]
FaultTime = Annotated[float, Field(ge=0.0, le=1e6)]


class AccelBias(TriaxialEffect):
    """Constant offset of each axis. Typical: 0.05 to 0.8 m/s² (MPU-6050, 6.2: ±50 mg in x and y, ±80 mg in z)."""

    name: Literal["accel_bias"] = "accel_bias"
    x_mps2: AccelBiasMps2 = 0.0
    y_mps2: AccelBiasMps2 = 0.0
    z_mps2: AccelBiasMps2 = 0.0
    typical: ClassVar[dict[str, float]] = {"x_mps2": 0.3, "y_mps2": -0.2, "z_mps2": 0.4}

    def begin_triaxial(self, rng: Rng) -> TriaxialAct:
        """Addition."""
        bias = np.array([self.x_mps2, self.y_mps2, self.z_mps2])
        return lambda sensed, _: sensed._replace(force_mps2=sensed.force_mps2 + bias)


class AccelWalk(TriaxialEffect):
    """The offset of each axis walks: db = K·dW. Typical K: 0.0005 to 0.003 m/s²/√s."""

    name: Literal["accel_walk"] = "accel_walk"
    density_mps2_rts: Annotated[float, Field(ge=0.0, le=1.0)]
    typical: ClassVar[dict[str, float]] = {"density_mps2_rts": 0.001}

    def begin_triaxial(self, rng: Rng) -> TriaxialAct:
        """A slow track per axis."""
        tracks = [self._track(generator) for generator in rng.spawn(3)]

        def act(sensed: Sensed, moments: TriaxialMoments) -> Sensed:
            walked = np.stack([track.values_at(moments.t_s) for track in tracks], axis=1)
            return sensed._replace(force_mps2=sensed.force_mps2 + walked)

        return act

    def _track(self, rng: Rng) -> SlowTrack:
        walk = OnePole(np.float64(1.0), np.float64(0.0))
        step_mps2 = self.density_mps2_rts * sqrt(SLOW_STEP_S)
        return SlowTrack(lambda count: walk(step_mps2 * rng.standard_normal(count)))


class AccelRange(TriaxialEffect):
    """Output clipped at ± a limit. Typical: a range of 2 to 16 g, so 19.6 to 157 m/s²."""

    name: Literal["accel_range"] = "accel_range"
    limit_mps2: Annotated[float, Field(ge=1.0, le=1000.0)]
    triaxial_slot: ClassVar[TriaxialSlot] = TriaxialSlot.OUTPUT
    typical: ClassVar[dict[str, float]] = {"limit_mps2": 19.6}

    def begin_triaxial(self, rng: Rng) -> TriaxialAct:
        """Clipping."""
        limit = self.limit_mps2
        return lambda sensed, _: sensed._replace(force_mps2=np.clip(sensed.force_mps2, -limit, limit))


class AccelSteps(TriaxialEffect):
    """Output in steps coarser than a count. Typical: 0.01 to 0.15 m/s² (parts of 10 or 12 bits)."""

    name: Literal["accel_steps"] = "accel_steps"
    step_mps2: Annotated[float, Field(ge=1e-6, le=20.0)]
    triaxial_slot: ClassVar[TriaxialSlot] = TriaxialSlot.OUTPUT
    typical: ClassVar[dict[str, float]] = {"step_mps2": 0.04}

    def begin_triaxial(self, rng: Rng) -> TriaxialAct:
        """Rounding."""
        step = self.step_mps2
        return lambda sensed, _: sensed._replace(force_mps2=np.rint(sensed.force_mps2 / step) * step)


class AccelDropout(TriaxialEffect):
    """The accelerometer is silent from `from_s` to `to_s`; rates go on. Typical: a driver that gives up."""

    name: Literal["accel_dropout"] = "accel_dropout"
    from_s: FaultTime = 20.0
    to_s: FaultTime = 1e6
    triaxial_slot: ClassVar[TriaxialSlot] = TriaxialSlot.OUTPUT
    typical: ClassVar[dict[str, float]] = {"from_s": 20.0, "to_s": 40.0}

    def begin_triaxial(self, rng: Rng) -> TriaxialAct:
        """NaN."""

        def act(sensed: Sensed, moments: TriaxialMoments) -> Sensed:
            is_silent = (moments.t_s >= self.from_s) & (moments.t_s < self.to_s)
            return sensed._replace(force_mps2=np.where(is_silent[:, None], np.nan, sensed.force_mps2))

        return act
