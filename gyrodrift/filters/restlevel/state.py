"""The parts of restlevel's state: one small record for each thing that is followed from block to block.

Fields are plain numbers and flags, and other such records: `gyrodrift.evaluation.kernels.compiled` lays them out as
a structured array, on which the same source runs compiled.
"""

from dataclasses import dataclass, field

NEVER = 1 << 30
"""Blocks ago."""


@dataclass(slots=True)
class BlockStats:
    """Running sums over the samples of the block that is being filled.

    seconds, samples
        Its length so far in s, and its number of samples.
    turned_deg
        Angle turned, by the trapezoidal rule.
    origin_dps
        Its first rate. The sums are of rates less this one, so that a large rate costs no digits.
    sum_dps, sum_squares
        Of the rates less `origin_dps`, deg/s, and of their squares, (deg/s)².
    """

    seconds: float = 0.0
    samples: int = 0
    turned_deg: float = 0.0
    origin_dps: float = 0.0
    sum_dps: float = 0.0
    sum_squares: float = 0.0


@dataclass(slots=True)
class NoiseModel:
    """What is known of the sensor's own noise. Variances and the resolution are −1 until they are known.

    sample_var
        Variance of the samples of stationary blocks, (deg/s)².
    last_block_var
        Variance of the samples of the block before, (deg/s)².
    stationary_blocks
        Blocks that `sample_var` is known from; it stops counting at `noise.NOISE_BLOCKS`.
    resolution_dps
        Smallest step ever seen between two samples, deg/s.
    has_steps
        A step has been seen before the present block, so that the noise is one.
    angle_walk_var
        N² of the angle random walk (IEEE Std 952), deg²/s: the variance of a block mean times the block's length.
    is_walk_measured
        Whether N² has been measured at a rest; before that it is what white noise makes of `sample_var`.
    has_dropped
        It has just been found to be smaller than what it was taken for.
    mute_blocks
        Blocks so far in which nothing but zero was said; −1 where the block before was the first with a step.
    flicker_var
        Bias instability, (deg/s)²: how far block means at rest wander beyond what N² explains.
    is_frozen, frozen_deg
        The sensor hung all through the block that has just ended, and what it has turned yaw by since it hangs.
    """

    sample_var: float = -1.0
    last_block_var: float = -1.0
    stationary_blocks: int = 0
    resolution_dps: float = -1.0
    has_steps: bool = False
    angle_walk_var: float = -1.0
    is_walk_measured: bool = False
    has_dropped: bool = False
    mute_blocks: int = 0
    flicker_var: float = 0.0
    is_frozen: bool = False
    frozen_deg: float = 0.0


@dataclass(slots=True)
class RateWander:
    """How the levels of stationary blocks follow on each other, outside of confirmed segments.

    log_odds
        Logarithm of how much likelier wandering levels give what was seen than a sensor's noise does.
    step_dps
        Typical step from one level to the next: as many are larger as smaller.
    steps
        Steps that it is known from.
    was_stationary
        The block before was.
    """

    log_odds: float = 0.0
    step_dps: float = 10.0
    steps: int = 0
    was_stationary: bool = False


@dataclass(slots=True)
class RateSegment:
    """The present constant-rate segment: stationary blocks of one mean.

    blocks
        Its blocks so far; 0 where there is no segment, 1 where one begins.
    mean_dps
        Mean of its block means, a running one after the first few.
    head_sum_dps
        Sum of its first two block means.
    last_mean_dps
        Mean of the block before, whether that belonged to a segment or not.
    least_dps, most_dps
        Range of all block means since the start, but for that of the first block.
    """

    blocks: int = 0
    mean_dps: float = 0.0
    head_sum_dps: float = 0.0
    last_mean_dps: float = 0.0
    least_dps: float = 0.0
    most_dps: float = 0.0


@dataclass(slots=True)
class EndedSegment:
    """The last constant-rate segment that has ended: a confirmed one, or a short rest from the start.

    mean_dps
        Its mean, deg/s.
    was_long
        It lasted `segments.LONG_SEGMENT_S` or more.
    ended_gently
        The rate left it slowly and without becoming noisy, as it leaves the flat part of a curve.
    blocks_ago
        Blocks since it ended; 1 for the block that ended it.
    short_start_blocks
        Its blocks where the present block has ended it before it was confirmed, as a rest from the start; else 0.
    """

    mean_dps: float = 0.0
    was_long: bool = False
    ended_gently: bool = False
    blocks_ago: int = NEVER
    short_start_blocks: int = 0


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
    is_unexpected_bias
        Its last rest began with a bias that it did not expect, and has not lasted long yet.
    moving_s
        Time since its last rest, s.
    held_back
        Factor by which its probability is held back until its rest has lasted longer than a level does by chance.
    recent_dps, recent_var, settled_dps, settled_var
        Bias and its variance as its last rest had them up to four seconds ago, and four seconds before that; where the
        rest has ended gently, the settled ones are exchanged with its bias.
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
    is_unexpected_bias: bool = False
    moving_s: float = 0.0
    held_back: float = 1.0
    recent_dps: float = 0.0
    recent_var: float = 0.0
    settled_dps: float = 0.0
    settled_var: float = 0.0
    turn_density: float = 1.0
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


TURN_PLACES = 32
"""Places for mean rates, some five minutes of motion."""


@dataclass(slots=True)
class MeanTurn:
    """A mean rate in deg/s, of some seconds of motion or of a constant-rate segment."""

    dps: float = 0.0


def _mean_turns() -> list[MeanTurn]:
    return [MeanTurn() for _ in range(TURN_PLACES)]


@dataclass(slots=True)
class MeanTurns:
    """Mean rates and their median; see `restlevel.turns`.

    seconds, turned_deg
        Of the present one, so far.
    seen
        How many there were.
    latest, ordered
        The latest ones, in a ring, and the same from the least to the largest.
    median_dps, median_var
        Their median, and its variance in (deg/s)².
    """

    seconds: float = 0.0
    turned_deg: float = 0.0
    seen: int = 0
    latest: list[MeanTurn] = field(default_factory=_mean_turns)
    ordered: list[MeanTurn] = field(default_factory=_mean_turns)
    median_dps: float = 0.0
    median_var: float = 0.0


TEMP_POINTS = 64
"""Places for points of bias against temperature: two degrees each, from −40 °C on."""

UNSAID_C = -1000.0
"""Temperature before one was said."""


@dataclass(slots=True)
class TempPoint:
    """The bias around a temperature.

    count
        Values that it is from; 0 for a free place.
    temp_c, bias_dps, bias_var, t_s
        Mean temperature, °C, mean bias, deg/s, its variance, and when the last value came.
    weight
        In the fit of the line.
    """

    count: int = 0
    temp_c: float = 0.0
    bias_dps: float = 0.0
    bias_var: float = 0.0
    t_s: float = 0.0
    weight: float = 0.0


def _temp_points() -> list[TempPoint]:
    return [TempPoint() for _ in range(TEMP_POINTS)]


@dataclass(slots=True)
class TempCurve:
    """Bias against temperature; see `restlevel.temperature`.

    temp_c
        Averaged temperature, °C; UNSAID_C until one was said.
    points
        By bins of temperature.
    known, least_c, most_c
        How many there are, and from where to where.
    is_accepted, slope_dps_c, level_dps, middle_c, fit_var
        Whether the line is, its slope in deg/s per °C, the bias at `middle_c`, and the variance of points about it.
    refused, is_refusing, rests
        Outliers in a row; whether the present rest is one; the rest that was judged last.
    """

    temp_c: float = UNSAID_C
    points: list[TempPoint] = field(default_factory=_temp_points)
    known: int = 0
    least_c: float = 0.0
    most_c: float = 0.0
    is_accepted: bool = False
    slope_dps_c: float = 0.0
    level_dps: float = 0.0
    middle_c: float = 0.0
    fit_var: float = 0.0
    refused: int = 0
    is_refusing: bool = False
    rests: int = 0
