"""Features of a sensor with three axes: angles of its yaw axis to the turn axis and to gravity.

A tilt θ of the sensor reduces the yaw rate by 1 − cos θ, as a scale error does. Unlike a scale error, it also
adds sin θ of the turn to the rates about x and y. And it tilts gravity by θ in the frame of the sensor.
"""

from dataclasses import dataclass

import numpy as np

from gyrodrift.diagnose.features.block_means import block_means
from gyrodrift.diagnose.features.design_matrix import DesignMatrix
from gyrodrift.diagnose.features.feature import FeatureReading, Statistic
from gyrodrift.diagnose.recording.gravity import NO_LEAN, Lean, fixed_lean
from gyrodrift.diagnose.recording.recording import Recording, filled
from gyrodrift.values.arrays import Floats

DEGREES = FeatureReading("deg", lambda sine: np.degrees(np.arcsin(np.clip(sine, -1.0, 1.0))))
"""Reading of a sine as an angle, deg."""


@dataclass(frozen=True, slots=True)
class Leans:
    """Components of the turn axis and of gravity along x and y of the sensor, relative to their length.

    turn
        Rates about x and y, divided by the rate of the encoder.
    gravity
        Specific force along x and y, divided by its length; (0, 0) without an accelerometer.
    """

    turn: Lean
    gravity: Lean


def axes_of(recording: Recording, design: DesignMatrix, *, has_gravity: bool) -> Leans:
    """Leans of the sensor in a recording or simulation, whose motion is that of `design`."""
    motion = design.motion
    gravity = fixed_lean(recording, motion.angle_deg, motion.rate_dps) if has_gravity else NO_LEAN
    return Leans(turn_lean(recording, design), gravity)


def turn_lean(recording: Recording, design: DesignMatrix) -> Lean:
    """Slopes of the rates about x and y over the rate of the encoder, from block means; (0, 0) without motion.

    A bias and a linear drift of the axis are fitted together with the slope.
    """
    if recording.gyro_xy_dps is None:
        return NO_LEAN
    rate_dps = block_means(design.motion.rate_dps, design.block)
    if not np.ptp(rate_dps) > LEAST_MOTION_DPS:
        return NO_LEAN
    x, y = (_slope(block_means(filled(axis), design.block), rate_dps) for axis in recording.gyro_xy_dps.T)
    return Lean(x, y)


LEAST_MOTION_DPS = 1.0
"""Range of the block means of the rate, deg/s, below which a recording has no motion. Chosen: a hundred times the error
of a block mean."""


def _slope(axis_dps: Floats, rate_dps: Floats) -> float:
    time = np.linspace(-1.0, 1.0, len(rate_dps))
    columns = np.column_stack([rate_dps, np.ones(len(time)), time])
    return float(np.linalg.lstsq(columns, axis_dps, rcond=None)[0][0])


# fmt: off
AXES: tuple[Statistic[Leans], ...] = (
    Statistic(
        "turn_across", "sensor", "moving", "the gyro turns about x and y when the table turns", 0.01,
        "half of a cross-axis sensitivity of 2 % (MPU-6050, 6.1), as of a tilt of 0.6 deg", reading=DEGREES,
        compute=lambda leans: leans.turn.sine,
    ),
    Statistic(
        "gravity_across", "sensor", "rest", "gravity leans from the yaw axis of the sensor", 0.05,
        "zero-g offset of 50 mg (MPU-6050, 6.2), as of a tilt of 2.9 deg", reading=DEGREES,
        compute=lambda leans: leans.gravity.sine,
    ),
)
# fmt: on
