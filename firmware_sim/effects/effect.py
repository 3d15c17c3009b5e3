"""What an effect is: parameters with bounds and units, a place where it acts, and an act on blocks of numbers.

An effect is a value that a rig file states. `begin` gives its act for one session, with whatever state the act
carries from block to block, and a random generator of its own: switching one effect on leaves the
realisations of the others as they were.
"""

from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from firmware_sim.yaml_file import Checked

Floats = NDArray[np.float64]
Rng = np.random.Generator


class Place(IntEnum):
    """Where an effect acts, in the order of a measurement; the values that its act is handed stand behind.

    LAG        delay of the motion that the gyro sees: times of seeing, s
    ANALOGUE   the rate before it is sampled, on the fine grid: deg/s
    LOW_PASS   the same, with noise and all that was added to it: deg/s
    RATE       the sampled rate, its gain and its bias: deg/s
    OUTPUT     the rate as the sensor puts it out, before it is rounded to counts: deg/s
    HOLD       the rate as the device reads it out: deg/s
    ENCODER    the angle that the encoder sees: degrees
    COUNTS     the angle as the encoder counts it: degrees
    CLOCK      the device's time stamps: s
    ARRIVAL    when the host has the sample: s, NaN where it never does
    """

    LAG = 0
    ANALOGUE = 1
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
    """The truth at the times of a block; every array has the shape (n,).

    t_s
        Time since the session began, s.
    powered_s
        Time since power-on, s.
    angle_deg, rate_dps
        True angle of the table, from the rig's phase on, and its rate.
    temp_c
        Temperature of the sensor, °C.
    step_s
        Distance of the times, s.
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

    `typical` holds the parameters of a usual size, as data sheets and field reports have them, `small` those of a
    size that still matters for yaw; the gallery and the tests use both.
    """

    name: str
    stage: ClassVar[str]
    place: ClassVar[Place]
    typical: ClassVar[dict[str, float]]
    small: ClassVar[dict[str, float]]

    def begin(self, rng: Rng, sample_rate_hz: float) -> Act:
        """The act of this effect over one session whose samples come at `sample_rate_hz`."""
        raise TypeError(f"{type(self).__name__} says nothing of how it acts")

    def finest_step_s(self) -> float:
        """The coarsest analogue grid that this effect is right on, s; infinite where the samples will do."""
        return float("inf")
