"""State of restlevel between blocks: hypotheses, the rest sensor, remembered values, and bias against temperature.

The records have the layout that `restlevel.rate_state` describes.
"""

from dataclasses import dataclass, field


@dataclass(slots=True)
class YawCheckpoint:
    """Yaw of a hypothesis at the beginning of the present segment. If the segment is a rest, yaw returns to it.

    yaw_deg, yaw_var, covariance, moving_s
        Values of `Hypothesis` at that time.
    """

    yaw_deg: float = 0.0
    yaw_var: float = 0.0
    covariance: float = 0.0
    moving_s: float = 0.0


@dataclass(slots=True)
class RestMark:
    """Earlier bias of a rest, deg/s, its variance, (deg/s)², and its age, s."""

    bias_dps: float = 0.0
    bias_var: float = 0.0
    ago_s: float = 0.0


@dataclass(slots=True)
class Hypothesis:
    """Assumption about which segments were rests, and its Gaussian over yaw and bias. A slot with weight 0 is free.

    weight
        Probability.
    bias_dps, yaw_deg
        Mean of the Gaussian.
    bias_var, covariance, yaw_var
        Covariance matrix: (deg/s)², deg²/s and deg².
    knows_bias
        Whether there was a zero-velocity update. Before it, the bias is 0 with the sigma of the turn-on bias.
    is_at_rest, was_at_rest
        Whether the device is at rest in the present segment, and whether it was in the segment before.
    moving_s
        Time since the last rest, s.
    rest_odds, chance_density, noisy_density, odds
        Prior odds of the present or last rest; densities of chance levels and of noisy motions at its rate, 1/(deg/s);
        odds of the rest that the weight contains. See `restlevel.durations`.
    slide_dps, has_been_flat
        Cumulative sum of the steps of the bias in the last rest, deg/s, and whether the sum has begun.
    recent, safe
        Bias of the last rest at most four seconds ago, and before it began to slide. After a gradual end the bias and
        the safe bias are exchanged. See `restlevel.slide`.
    turn_density
        Density of the median mean rate that the weight contains, 1/(deg/s). See `restlevel.turns`.
    checkpoint
        Yaw at the beginning of the present segment.
    """

    weight: float = 0.0
    bias_dps: float = 0.0
    yaw_deg: float = 0.0
    bias_var: float = 0.0
    covariance: float = 0.0
    yaw_var: float = 0.0
    knows_bias: bool = False
    is_at_rest: bool = False
    was_at_rest: bool = False
    moving_s: float = 0.0
    rest_odds: float = 0.0
    chance_density: float = 0.0
    noisy_density: float = 0.0
    odds: float = 1.0
    slide_dps: float = 0.0
    has_been_flat: bool = False
    turn_density: float = 1.0
    recent: RestMark = field(default_factory=RestMark)
    safe: RestMark = field(default_factory=RestMark)
    checkpoint: YawCheckpoint = field(default_factory=YawCheckpoint)


@dataclass(slots=True)
class MixtureMoments:
    """Gaussian of all hypotheses at the beginning of the present block. Its mean bias is `RestlevelState.bias_dps`.

    yaw_deg
        Mean yaw.
    bias_var, covariance, yaw_var
        Covariance matrix: (deg/s)², deg²/s and deg².
    """

    yaw_deg: float = 0.0
    bias_var: float = 0.0
    covariance: float = 0.0
    yaw_var: float = 0.0


@dataclass(slots=True)
class Witness:
    """State of the external rest sensor; see `restlevel.witness`.

    still, moving
        Numbers of samples of the present block with a report of rest, and with a report of motion.
    is_reporting_rest
        Whether all samples of the block before had a report of rest.
    was_certain
        Whether the block before was a certain rest: the report was believed, and the rate did not contradict it.
    is_believed
        False after a refutation, until a block has no report of rest.
    refuted
        Number of refutations.
    contradictions
        Number of blocks that contradicted a report of rest. A block that fits removes `contradictions.FIT_CREDIT`.
    agreeing_blocks, level_dps
        Number of the last contradicting blocks that agree with each other, and their mean, deg/s.
    before_dps
        Bias estimate at the beginning of the report of rest, deg/s.
    since_s
        Time since the last rest, s.
    """

    still: int = 0
    moving: int = 0
    is_reporting_rest: bool = False
    was_certain: bool = False
    is_believed: bool = True
    refuted: int = 0
    contradictions: float = 0.0
    agreeing_blocks: int = 0
    level_dps: float = 0.0
    before_dps: float = 0.0
    since_s: float = 0.0


MAX_REMEMBERED = 2
"""Largest number of remembered biases: of the last rest, and of a start at a similar temperature. By definition."""


@dataclass(slots=True)
class RememberedBias:
    """Remembered bias as an initial hypothesis: probability, mean, deg/s, and variance, (deg/s)²."""

    weight: float = 0.0
    bias_dps: float = 0.0
    bias_var: float = 0.0


@dataclass(slots=True)
class RecalledNoise:
    """Remembered noise at rest, as in `NoiseModel`, and its sample period, s; the period is 0 without a memory."""

    period_s: float = 0.0
    sample_var: float = 0.0
    angle_walk_var: float = 0.0
    flicker_var: float = 0.0
    resolution_dps: float = -1.0


@dataclass(slots=True)
class SureRest:
    """Sure rests of this run, from which `restlevel.memory` learns; see `restlevel.recall`.

    seconds
        Time for which rest has been probable, s; 0 if it is not.
    rests
        Number of sure rests.
    begin_dps, begin_c
        Bias and temperature at the beginning of the present rest, deg/s and °C.
    bias_dps, bias_var, temp_c, t_s, period_s
        Last sure rest: bias, deg/s, its variance, temperature, °C, time, s, and sample period, s.
    has_first, first_dps, first_dps_sigma, first_c, first_s
        First sure rest: whether there was one; bias at its beginning and its sigma, deg/s; temperature there, °C; time
        at which it became sure, s.
    """

    seconds: float = 0.0
    rests: int = 0
    begin_dps: float = 0.0
    begin_c: float = 0.0
    bias_dps: float = 0.0
    bias_var: float = 0.0
    temp_c: float = 0.0
    t_s: float = 0.0
    period_s: float = 0.0
    has_first: bool = False
    first_dps: float = 0.0
    first_dps_sigma: float = 0.0
    first_c: float = 0.0
    first_s: float = 0.0


UNSAID_C = -1000.0
"""Temperature before the first measurement, °C. By definition: below every temperature."""

NEW_SLOPE_VAR = 0.01**2
"""Variance of the slope of a new sensor, (deg/s per °C)². Source: data sheets of common parts."""


@dataclass(slots=True)
class TempLine:
    """Bias against temperature; see `restlevel.temperature`.

    temp_c, rest_c
        Averaged temperature, now and at the last probable rest, °C; UNSAID_C before the first measurement.
    points
        Number of measurements of the level.
    slope_dps_c, slope_var
        Slope, deg/s per °C, and its variance.
    level_dps, level_var, covariance
        Level at the last measurement, deg/s, its variance, and its covariance with the slope.
    level_c, level_s
        Temperature and time of the last measurement, °C and s.
    """

    temp_c: float = UNSAID_C
    rest_c: float = UNSAID_C
    points: int = 0
    slope_dps_c: float = 0.0
    slope_var: float = NEW_SLOPE_VAR
    level_dps: float = 0.0
    level_var: float = 0.0
    covariance: float = 0.0
    level_c: float = 0.0
    level_s: float = 0.0


def remembered_slots() -> list[RememberedBias]:
    """Slots without a remembered bias."""
    return [RememberedBias() for _ in range(MAX_REMEMBERED)]


@dataclass(slots=True)
class AxisKnowledge:
    """Knowledge of an axis: of earlier runs, and of the sure rests of this one.

    remembered
        Remembered biases.
    line
        Bias against temperature.
    sure
        Sure rests.
    """

    remembered: list[RememberedBias] = field(default_factory=remembered_slots)
    line: TempLine = field(default_factory=TempLine)
    sure: SureRest = field(default_factory=SureRest)


def level_axes() -> list[AxisKnowledge]:
    """Two axes of which nothing is known."""
    return [AxisKnowledge(), AxisKnowledge()]
