"""State of restlevel that describes the rate: the block, noise, levels, segments and mean rates.

Fields are plain numbers, flags, and records of them. `gyrodrift.evaluation.kernels.restlevel` lays them out as a
structured array, on which the same source runs compiled.
"""

from dataclasses import dataclass, field

NEVER = 1 << 30
"""Number of blocks since an event that has not happened. By definition: above every count."""


@dataclass(slots=True)
class BlockStats:
    """Sums over the samples of the present block.

    seconds, samples
        Length so far, s, and number of samples.
    repeats
        Number of samples that repeat the value before of a fine sensor. They are no new measurements.
    angle_deg
        Angle turned, by the trapezoidal rule.
    origin_dps
        First rate. It is subtracted from the rates of the sums, so that a large rate costs no digits.
    sum_dps, sum_squares
        Sums of the rates minus `origin_dps`, deg/s, and of their squares, (deg/s)².
    """

    seconds: float = 0.0
    samples: int = 0
    repeats: int = 0
    angle_deg: float = 0.0
    origin_dps: float = 0.0
    sum_dps: float = 0.0
    sum_squares: float = 0.0


@dataclass(slots=True)
class NoiseModel:
    """Noise of the sensor. Variances and the resolution are −1 until they are known.

    sample_var
        Variance of the samples of stationary blocks, (deg/s)².
    last_block_var
        Variance of the samples of the block before, (deg/s)².
    stationary_blocks
        Number of blocks that `sample_var` comes from, at most `noise.NOISE_BLOCKS`.
    resolution_dps
        Smallest step between two samples so far, deg/s.
    has_steps
        Whether `sample_var` comes from blocks after the first step between two samples.
    angle_walk_var
        N² of the angle random walk (IEEE Std 952), deg²/s: the variance of a block mean times the block's length.
    is_walk_measured
        Whether N² has been measured at a rest. Before that it follows from `sample_var`, as if the noise were white.
    has_dropped
        Whether the last block has replaced `sample_var` by a much smaller value.
    same_blocks
        Number of blocks at power-on that contain a single value; below 0 for some blocks after the first step.
    flicker_var
        Bias instability, (deg/s)²: variance of block means at rest that N² does not explain.
    is_frozen, frozen_deg
        Whether the sensor repeated a single value through the last block, and the angle since it began to, deg.
    """

    sample_var: float = -1.0
    last_block_var: float = -1.0
    stationary_blocks: int = 0
    resolution_dps: float = -1.0
    has_steps: bool = False
    angle_walk_var: float = -1.0
    is_walk_measured: bool = False
    has_dropped: bool = False
    same_blocks: int = 0
    flicker_var: float = 0.0
    is_frozen: bool = False
    frozen_deg: float = 0.0


@dataclass(slots=True)
class VibrationNoise:
    """Noise of blocks that are noisier than the sensor; see `restlevel.vibration`.

    blocks, sample_var
        Number of consecutive blocks that are equally noisy, at most `noise.NOISE_BLOCKS`; mean variance of their
        samples, (deg/s)².
    mean_var
        Variance of the block means of the present vibrating segment, (deg/s)².
    ended_var
        Mean variance of the samples of the last vibrating segment, (deg/s)².
    motions, motion_var
        Number of vibrating segments that were motions, and the mean variance of their samples, (deg/s)².
    """

    blocks: int = 0
    sample_var: float = 0.0
    mean_var: float = 0.0
    ended_var: float = 0.0
    motions: float = 0.0
    motion_var: float = 0.0


@dataclass(slots=True)
class RateWander:
    """Agreement of consecutive stationary blocks outside of confirmed segments; see `restlevel.wander`.

    log_odds
        Logarithm of the likelihood ratio of wandering levels against the noise of a sensor.
    step_dps
        Median step between two levels, deg/s.
    steps
        Number of steps that the median comes from.
    was_stationary
        Whether the block before was stationary.
    """

    log_odds: float = 0.0
    step_dps: float = 10.0
    steps: int = 0
    was_stationary: bool = False


@dataclass(slots=True)
class RateSegment:
    """Present constant-rate segment: a run of stationary blocks with the same mean.

    blocks
        Number of blocks so far; 0 without a segment, 1 where a segment begins.
    is_vibrating
        Whether its blocks are noisier than the sensor, and equally noisy.
    seconds
        Length, s, with the segments that it resumes.
    mean_dps
        Mean of the block means, deg/s: of all up to `segments.MEAN_BLOCKS`, and after that a running mean; of all in a
        vibrating segment.
    sum_squares
        Sum of the squared steps between block means, (deg/s)².
    sensor_odds
        Likelihood ratio of its scatter, as in `noise.sensor_odds`; 1 in a vibrating segment.
    averages_out
        Whether its block means scatter less than white noise.
    head_sum_dps
        Sum of the first two block means, deg/s.
    last_mean_dps
        Mean of the last block, inside or outside of a segment, deg/s.
    least_dps, most_dps
        Range of all block means since the start without the first block, deg/s.
    """

    blocks: int = 0
    is_vibrating: bool = False
    seconds: float = 0.0
    mean_dps: float = 0.0
    sum_squares: float = 0.0
    sensor_odds: float = 1.0
    averages_out: bool = False
    head_sum_dps: float = 0.0
    last_mean_dps: float = 0.0
    least_dps: float = 0.0
    most_dps: float = 0.0


@dataclass(slots=True)
class EndedSegment:
    """Last constant-rate segment that has ended: a confirmed segment, or a short rest from the start.

    mean_dps, seconds, sensor_odds
        Mean, deg/s, length, s, and likelihood ratio of its scatter.
    is_vibrating
        Whether it was vibrating.
    ended_gradually
        Whether the rate left it slowly and stayed stationary, as it leaves the flat part of a curve.
    blocks_ago
        Number of blocks since its end; 1 for the block that ended it.
    short_start_blocks
        Number of its blocks if the present block has ended a short rest from the start; else 0.
    """

    mean_dps: float = 0.0
    seconds: float = 0.0
    sensor_odds: float = 1.0
    is_vibrating: bool = False
    ended_gradually: bool = False
    blocks_ago: int = NEVER
    short_start_blocks: int = 0


TURN_SLOTS = 32
"""Number of stored mean rates. Chosen: those of about five minutes of motion."""


@dataclass(slots=True)
class MeanTurn:
    """Mean rate of ten seconds of motion, or of a constant-rate segment, deg/s."""

    dps: float = 0.0


def _mean_turns() -> list[MeanTurn]:
    return [MeanTurn() for _ in range(TURN_SLOTS)]


@dataclass(slots=True)
class MeanTurns:
    """Mean rates and their median; see `restlevel.turns`.

    seconds, angle_deg
        Length and angle of the present mean rate so far, s and deg.
    count
        Number of mean rates since the start.
    latest, ordered
        Last `TURN_SLOTS` mean rates as a ring buffer, and in ascending order.
    median_dps, median_var
        Median, deg/s, and its variance, (deg/s)².
    """

    seconds: float = 0.0
    angle_deg: float = 0.0
    count: int = 0
    latest: list[MeanTurn] = field(default_factory=_mean_turns)
    ordered: list[MeanTurn] = field(default_factory=_mean_turns)
    median_dps: float = 0.0
    median_var: float = 0.0
