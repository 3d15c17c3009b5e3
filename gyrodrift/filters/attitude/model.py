"""Coefficients and state of the attitude filter. Units inside: rad, s, m."""

from dataclasses import dataclass, field
from math import nan, sqrt

import numpy as np

from gyrodrift.filters.attitude.block import RAD, InertialBlock
from gyrodrift.filters.attitude.hypotheses import Hypotheses, first_hypothesis
from gyrodrift.filters.attitude.motion import MotionMemory
from gyrodrift.filters.attitude.rests import AttitudeWitness, Segment, Windows
from gyrodrift.filters.gaps import GapWatch
from gyrodrift.filters.restlevel.bias_state import AxisKnowledge
from gyrodrift.filters.restlevel.model import UNKNOWN_C, RestlevelParams, curve
from gyrodrift.values.arrays import Floats
from gyrodrift.values.quaternion import IDENTITY, Quaternion, heading_axis, tilt_deg
from gyrodrift.values.vectors import Vector

BLOCKS_PER_WINDOW = 3.0
"""Blocks in `window_s`: at its default of 0.3 s a block has 0.1 s, as in the recordings of `SPREAD_OF_BIAS`."""

SPREAD_OF_BIAS = 1.4
BIAS_WALK = 3.0
"""Factors on `turn_on_dps` and `walk_dps_rts`: 0.7 deg/s and 0.0015 deg/s/√s at the defaults.
Measured: recordings of five rigs, median heading error."""

CROSS_AXIS = 0.2
"""Misalignment as a share of the scale factor's spread: 0.002 at 1 %. Measured: as above."""

DEFAULT_QUIET = 5.0
"""`quiet` at which the limits of rests are those of the recordings. By definition: the default of `quiet`."""


@dataclass(frozen=True, slots=True)
class AttitudeCoefficients:
    """Values that follow from the parameters of restlevel.

    block_s
        Length of a block, s.
    bias_sigma, walk_var, drift_rate
        Standard deviation of the bias at power-on, rad/s; its random walk, (rad/s)²/s; its fastest drift, rad/s².
    scale_sigma, cross_sigma
        Standard deviations of scale factor and misalignment, as shares.
    start_odds, rest_odds
        Prior odds of a rest against an even turn at the start, and later.
    limits
        Factor on the spread of block means in a rest.
    """

    block_s: float
    bias_sigma: float
    walk_var: float
    drift_rate: float
    scale_sigma: float
    cross_sigma: float
    start_odds: float
    rest_odds: float
    limits: float


def coefficients(params: RestlevelParams) -> AttitudeCoefficients:
    """Coefficients of the parameters of restlevel."""
    scale = params.scale_percent / 100.0
    return AttitudeCoefficients(
        block_s=params.window_s / BLOCKS_PER_WINDOW,
        bias_sigma=SPREAD_OF_BIAS * params.turn_on_dps * RAD,
        walk_var=(BIAS_WALK * params.walk_dps_rts * RAD) ** 2,
        drift_rate=params.drift_dps_s * RAD,
        scale_sigma=scale,
        cross_sigma=CROSS_AXIS * scale,
        start_odds=params.still_start / (1.0 - params.still_start),
        rest_odds=params.rest_share / (1.0 - params.rest_share),
        limits=sqrt(params.quiet / DEFAULT_QUIET),
    )


def three_axes() -> list[AxisKnowledge]:
    """Three axes of which nothing is known."""
    return [AxisKnowledge(), AxisKnowledge(), AxisKnowledge()]


@dataclass(slots=True)
class AttitudeState:
    """State after a sample.

    t_s, gyro_dps
        Time of the last accepted sample, and rates of the last one that is no suspect.
    suspect_dps, suspect_s
        Rates of a sample that may be a spike, and the time since the sample before, s; 0 without a suspect.
    accel_mps2, accel_t_s
        Last acceleration that was not NaN, and its time.
    q
        Attitude (w, x, y, z), sensor to earth, z up.
    yaw_deg, yaw_sigma_deg
        Unwrapped twist of q about the vertical, 0 at the first sample, and its standard deviation.
    tilt_sigma_deg
        Standard deviation of the inclination.
    bias_xyz_dps, bias_sigma_xyz_dps
        Bias estimate of the three axes, and its standard deviations.
    bias_dps, bias_sigma_dps
        Bias estimate of the rate of the heading, and its standard deviation.
    rest_probability, confidence
        Probability of rest, and of the most probable hypothesis.
    samples, rejected
        Numbers of accepted and of rejected samples.
    correction_deg, corrections
        Step of yaw in the last sample that is no motion, deg: a change of the estimate. Number of those over 1 deg.
    watch
        Limit that tells a gap from a step.
    start_q, start_yaw_deg
        Output attitude and yaw at the beginning of the block.
    block, windows, segment, hypotheses, witness
        Samples of the block; means of the last blocks; the present rest candidate; the Gaussian sum; the rest sensor.
    noise_var
        Angle random walk of the gyro, rad²/s.
    turn_on_bias
        Mean (3) of the prior of an unknown bias, rad/s: 0, or the last estimate before a restart.
    motion
        Properties of the motion in the last seconds.
    temp_c
        Last temperature, °C; UNKNOWN_C before the first.
    lived_s
        Time since the first sample up to the present block, s.
    axes, remembers
        Remembered biases, bias against temperature and sure rests of x, y and z. Whether hypotheses have a remembered
        bias, and there was no rest candidate yet.
    """

    t_s: float = 0.0
    gyro_dps: Vector = (0.0, 0.0, 0.0)
    suspect_dps: Vector = (0.0, 0.0, 0.0)
    suspect_s: float = 0.0
    accel_mps2: Vector = (nan, nan, nan)
    accel_t_s: float = -1e300
    q: Quaternion = IDENTITY
    yaw_deg: float = 0.0
    yaw_sigma_deg: float = 0.0
    tilt_sigma_deg: float = 180.0
    bias_xyz_dps: Vector = (0.0, 0.0, 0.0)
    bias_sigma_xyz_dps: Vector = (0.0, 0.0, 0.0)
    bias_dps: float = 0.0
    bias_sigma_dps: float = 0.0
    rest_probability: float = 0.0
    confidence: float = 1.0
    samples: int = 0
    rejected: int = 0
    correction_deg: float = 0.0
    corrections: int = 0
    watch: GapWatch = field(default_factory=GapWatch)
    start_q: Quaternion = IDENTITY
    start_yaw_deg: float = 0.0
    block: InertialBlock = field(default_factory=InertialBlock)
    windows: Windows = field(default_factory=Windows)
    segment: Segment = field(default_factory=Segment)
    hypotheses: Hypotheses = field(default_factory=first_hypothesis)
    witness: AttitudeWitness = field(default_factory=AttitudeWitness)
    noise_var: float = 0.0
    turn_on_bias: Floats = field(default_factory=lambda: np.zeros(3))
    motion: MotionMemory = field(default_factory=MotionMemory)
    temp_c: float = UNKNOWN_C
    lived_s: float = 0.0
    axes: list[AxisKnowledge] = field(default_factory=three_axes)
    remembers: bool = False

    @property
    def tilt_deg(self) -> float:
        """Angle between the sensor's z axis and the vertical, deg."""
        return tilt_deg(*self.q)

    @property
    def heading_rate_dps(self) -> float:
        """Rate of the heading, deg/s, from the measured rates, before the bias is subtracted."""
        axis, rate = heading_axis(self.q), self.gyro_dps
        return axis[0] * rate[0] + axis[1] * rate[1] + axis[2] * rate[2]

    @property
    def temp_curve(self) -> dict[str, float] | None:
        """Bias of the rate of the heading against temperature, for the status; None before the first measurement."""
        lines = [(share, axis.line) for share, axis in zip(heading_axis(self.q), self.axes, strict=True)]
        slope_dps_c = sum(share * line.slope_dps_c for share, line in lines)
        return curve(lines[0][1].points, slope_dps_c, sum(share * share * line.slope_var for share, line in lines))
