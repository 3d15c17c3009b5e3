"""What restlevel believes of yaw and bias, and keeps from block to block: one small record for each thing.

Laid out like `restlevel.rate_state`.
"""

from dataclasses import dataclass, field


@dataclass(slots=True)
class YawCheckpoint:
    """Yaw of a hypothesis as it was where the present segment began; a rest is counted from there.

    yaw_deg, yaw_var, covariance, moving_s
        As in `Hypothesis`.
    """

    yaw_deg: float = 0.0
    yaw_var: float = 0.0
    covariance: float = 0.0
    moving_s: float = 0.0


@dataclass(slots=True)
class RestMark:
    """The bias of a rest as it was some time ago, deg/s, its variance in (deg/s)², and how long ago that was, s."""

    bias_dps: float = 0.0
    bias_var: float = 0.0
    ago_s: float = 0.0


@dataclass(slots=True)
class Hypothesis:
    """Which of the segments were rests, and the Gaussian over yaw and bias that follows. Weight 0 is a free place.

    weight
        Its probability.
    bias_dps, yaw_deg
        Mean.
    bias_var, covariance, yaw_var
        Covariance matrix: (deg/s)², deg²/s and deg².
    knows_bias
        It has had a zero-velocity update. Until then the bias is 0 with the sigma of the turn-on bias.
    is_at_rest, was_at_rest
        The device is at rest in the present segment; it was in the one before.
    moving_s
        Time since its last rest, s.
    rest_odds, chance_density, noisy_density, odds
        Of its present or last rest: prior odds, densities of levels by chance and of noisy motions at its rate,
        1/(deg/s), and the odds against all that is no rest that its weight holds by now; see `restlevel.durations`.
    slide_dps, has_been_flat
        How far the bias has slid in its last rest beyond what is usual, to one side, and whether it stood still before.
    recent, settled
        Bias of its last rest up to four seconds ago, and before it began to slide; where the rest has ended gradually,
        the settled one is exchanged with its bias. See `restlevel.slide`.
    turn_density
        What it was weighed by last by the mean turns; see `restlevel.turns`.
    checkpoint
        Yaw where the present segment began.
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
    settled: RestMark = field(default_factory=RestMark)
    checkpoint: YawCheckpoint = field(default_factory=YawCheckpoint)


@dataclass(slots=True)
class MixtureMoments:
    """All hypotheses collapsed into one Gaussian as the present block began; its bias is `RestlevelState.bias_dps`.

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
    """What something else than the rate says of rest, and whether it is believed; see `restlevel.witness`.

    still, moving
        Samples of the present block that are said to stand still, and to move.
    is_claiming
        The block before was said to stand still.
    was_certain
        It was one, and that was believed.
    is_believed
        Until it is found out, and again once it has said something else.
    refuted
        How often it was found out.
    doubt
        Blocks that have contradicted it, less what was forgiven.
    alike, level_dps
        The last of them that agree with each other, and their mean.
    before_dps
        Bias estimate when it began to say so.
    since_s
        Time since the last rest, s.
    """

    still: int = 0
    moving: int = 0
    is_claiming: bool = False
    was_certain: bool = False
    is_believed: bool = True
    refuted: int = 0
    doubt: float = 0.0
    alike: int = 0
    level_dps: float = 0.0
    before_dps: float = 0.0
    since_s: float = 0.0


@dataclass(slots=True)
class RememberedBias:
    """A bias that the filter begins with, beside those of any sensor: its probability, mean and variance."""

    weight: float = 0.0
    bias_dps: float = 0.0
    bias_var: float = 0.0


@dataclass(slots=True)
class RecalledNoise:
    """Noise at rest that is remembered, as in `NoiseModel`, and the time between two samples, s; 0 where none is."""

    period_s: float = 0.0
    sample_var: float = 0.0
    angle_walk_var: float = 0.0
    flicker_var: float = 0.0
    resolution_dps: float = -1.0


@dataclass(slots=True)
class SureRest:
    """The last rest that the filter is sure of, and the first one.

    seconds
        How long the present one has lasted, s; 0 where there is none.
    rests
        How many there were.
    begin_dps, begin_c
        Bias and temperature when the present one began.
    bias_dps, bias_var, temp_c, t_s, period_s
        Bias of the last one as it is known now and its variance, temperature, time, and the time between two samples.
    has_first, first_dps, first_dps_sigma, first_c, first_s
        Of the first one: bias where it began and its sigma, temperature there, and when it was sure.
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
"""Temperature before one was said."""

NEW_SLOPE_VAR = 0.01**2
"""Variance of the slope of a new sensor, (deg/s per °C)²: data sheets of common parts."""


@dataclass(slots=True)
class TempLine:
    """Bias against temperature; see `restlevel.temperature`.

    temp_c, rest_c
        Averaged temperature, °C, and what it was at the last probable rest; UNSAID_C until one was said.
    points
        Measurements of the level.
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
