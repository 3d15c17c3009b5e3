"""Base of effects: parameters with bounds and units, a slot in the measurement, and an act on blocks of numbers.

An effect is a value from a rig file. `begin` returns its act for one session, which keeps its state between blocks.
Every effect has its own random generator, so adding one does not change the realizations of others.
"""

from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from firmware_sim.yaml_file import Checked

Floats = NDArray[np.float64]
Rng = np.random.Generator


class EffectSlot(IntEnum):
    """Slot of an effect in the order of a measurement, with the values that its act gets.

    - LAG: times at which the gyro senses the motion, s
    - ANALOG: rate before sampling, on the fine grid, deg/s
    - LOW_PASS: rate before sampling with noise and all additions, deg/s
    - RATE: sampled rate, for gain and bias, deg/s
    - OUTPUT: output of the sensor before rounding to counts, deg/s
    - HOLD: rate that the device reads, deg/s
    - ENCODER: angle at the encoder, degrees
    - COUNTS: angle in encoder counts, degrees
    - CLOCK: time stamps of the device, s
    - ARRIVAL: arrival at the host, s; NaN for lost samples
    """

    LAG = 0
    ANALOG = 1
    LOW_PASS = 2
    RATE = 3
    OUTPUT = 4
    HOLD = 5
    ENCODER = 6
    COUNTS = 7
    CLOCK = 8
    ARRIVAL = 9


@dataclass(frozen=True, slots=True)
class Moments:
    """True values at the times of a block; every array has the shape (n,).

    t_s
        Time since the beginning of the session, s.
    powered_s
        Time since power-on, s.
    angle_deg, rate_dps
        True angle of the table, including the phase of the rig, and its rate.
    temp_c
        Temperature of the sensor, °C.
    step_s
        Step of the times, s.
    """

    t_s: Floats
    powered_s: Floats
    angle_deg: Floats
    rate_dps: Floats
    temp_c: Floats
    step_s: float


Act = Callable[[Floats, Moments], Floats]


class Effect(Checked):
    """Base of all effects.

    `typical` holds parameters of a usual size from data sheets and field reports, `small` the smallest that matter for
    yaw. The gallery and the tests use both. `candidate` is for effects of other packages: the record by which a program
    looks for the effect in recordings.
    """

    name: str
    stage: ClassVar[str]
    slot: ClassVar[EffectSlot]
    typical: ClassVar[dict[str, float]]
    small: ClassVar[dict[str, float]]
    candidate: ClassVar[Any] = None

    def begin(self, rng: Rng, sample_rate_hz: float) -> Act:
        """Act of this effect for a session with a sample rate."""
        raise TypeError(f"{type(self).__name__} does not define begin")

    def finest_step_s(self) -> float:
        """Largest step of the fine grid for this effect, s; infinite if it needs no fine grid."""
        return float("inf")
