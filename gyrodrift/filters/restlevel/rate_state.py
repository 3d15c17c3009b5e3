"""What restlevel follows of the rate itself, from block to block: one small record for each thing.

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
    seconds
        Its length, s, with that of the segments that it resumes.
    mean_dps
        Mean of its block means, a running one after the first few.
    sum_squares
        Sum of the squared steps between its block means, (deg/s)².
    head_sum_dps
        Sum of its first two block means.
    last_mean_dps
        Mean of the block before, whether that belonged to a segment or not.
    least_dps, most_dps
        Range of all block means since the start, but for that of the first block.
    """

    blocks: int = 0
    seconds: float = 0.0
    mean_dps: float = 0.0
    sum_squares: float = 0.0
    sensor_odds: float = 1.0
    head_sum_dps: float = 0.0
    last_mean_dps: float = 0.0
    least_dps: float = 0.0
    most_dps: float = 0.0


@dataclass(slots=True)
class EndedSegment:
    """The last constant-rate segment that has ended: a confirmed one, or a short rest from the start.

    mean_dps, seconds
        Its mean, deg/s, and its length, s.
    ended_gradually
        The rate left it slowly and without becoming noisy, as it leaves the flat part of a curve.
    blocks_ago
        Blocks since it ended; 1 for the block that ended it.
    short_start_blocks
        Its blocks where the present block has ended it before it was confirmed, as a rest from the start; else 0.
    """

    mean_dps: float = 0.0
    seconds: float = 0.0
    sensor_odds: float = 1.0
    ended_gradually: bool = False
    blocks_ago: int = NEVER
    short_start_blocks: int = 0


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
