"""Vibration by motors, which shakes gyro and accelerometer together."""

from math import pi, sqrt
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from firmware_sim.effects.effect import Floats, Rng
from firmware_sim.effects.recursion import SLOW_STEP_S, OnePole, SlowTrack
from firmware_sim.effects.triaxial.effect import Sensed, TriaxialAct, TriaxialEffect, TriaxialMoments

STEPS_PER_PERIOD = 25.0
"""Steps of the fine grid per period, as for a tone of one axis."""


class MotorVibration(TriaxialEffect):
    """Tone in all axes whose frequency wanders, as that of a motor under load.

    Typical: 1 to 5 deg/s and 1 to 4 m/s² at 60 to 250 Hz (multirotors), a tenth of it on a robot. Above half the sample
    rate it aliases. `wander_hz` is the standard deviation of the frequency. At rest the share `rest_share` remains:
    1 for motors that always run, 0 for motors that stop with the device.
    """

    name: Literal["motor_vibration"] = "motor_vibration"
    gyro_dps: Annotated[float, Field(ge=0.0, le=500.0)] = 2.0
    accel_mps2: Annotated[float, Field(ge=0.0, le=200.0)] = 2.0
    frequency_hz: Annotated[float, Field(gt=0.0, le=5000.0)] = 120.0
    wander_hz: Annotated[float, Field(ge=0.0, le=1000.0)] = 5.0
    rest_share: Annotated[float, Field(ge=0.0, le=1.0)] = 1.0
    typical: ClassVar[dict[str, float]] = {"gyro_dps": 2.0, "accel_mps2": 2.0, "frequency_hz": 120.0}

    def finest_step_s(self) -> float:
        """Fraction of a period, for a low-pass after it."""
        return 1.0 / self.frequency_hz / STEPS_PER_PERIOD

    def begin_triaxial(self, rng: Rng) -> TriaxialAct:
        """Tones of one motor: root mean squares per axis, with fixed phases between the axes."""
        phases = rng.uniform(0.0, 2.0 * pi, (2, 3))
        # Frequency: Markov process of 1 s; the phase is its sum on the slow grid.
        kept = np.exp(-SLOW_STEP_S)
        frequency = OnePole(np.float64(kept), np.float64(self.wander_hz * rng.standard_normal()))
        total = OnePole(np.float64(1.0), np.float64(0.0))
        scale_hz = self.wander_hz * sqrt(1.0 - kept**2)
        turns = SlowTrack(lambda count: total(frequency(scale_hz * rng.standard_normal(count)) * SLOW_STEP_S))

        def act(sensed: Sensed, moments: TriaxialMoments) -> Sensed:
            share = np.where(moments.is_still, self.rest_share, 1.0)[:, None]
            phase = 2.0 * pi * (self.frequency_hz * moments.t_s + turns.values_at(moments.t_s))[:, None]
            shaken = [sqrt(2.0) * share * np.sin(phase + offsets) for offsets in phases]
            return Sensed(*_sums(sensed, self.gyro_dps * shaken[0], self.accel_mps2 * shaken[1]))

        return act


def _sums(sensed: Sensed, rates_dps: Floats, force_mps2: Floats) -> tuple[Floats, Floats]:
    return sensed.rates_dps + rates_dps, sensed.force_mps2 + force_mps2
