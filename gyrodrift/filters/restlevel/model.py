"""Parameters, coefficients and state of restlevel."""

from dataclasses import dataclass, field
from typing import Annotated

from annotated_types import Ge, Gt, Le, Lt

from gyrodrift.filters.beliefs import MAX_HYPOTHESES
from gyrodrift.filters.gaps import GapWatch
from gyrodrift.filters.restlevel.bias_state import (
    UNSAID_C,
    AxisKnowledge,
    Hypothesis,
    MixtureMoments,
    RecalledNoise,
    RememberedBias,
    SureRest,
    TempLine,
    Witness,
    level_axes,
    remembered_slots,
)
from gyrodrift.filters.restlevel.rate_state import (
    BlockStats,
    EndedSegment,
    MeanTurns,
    NoiseModel,
    RateSegment,
    RateWander,
    VibrationNoise,
)

UNKNOWN_C = UNSAID_C
"""Temperature before the first measurement, °C."""

COLDEST_C, WARMEST_C = -100.0, 200.0
"""Range of temperatures, °C. A value outside of it is ignored. Chosen: beyond the range of any part."""


@dataclass(frozen=True, slots=True)
class RestlevelParams:
    """Parameters that a person or `tune` sets.

    window_s
        Length of the blocks tested for rest, s. Small: short stops are detected. Large: more noise is averaged.
    quiet
        Stationarity threshold: largest excess of a block's variance over the noise of the sensor, in standard errors
        of a variance. Small: noisy rests are missed. Large: slow motion counts as rest until its block means differ.
    turn_on_dps
        Sigma of the turn-on bias, deg/s. With 0 the sensor subtracts its own bias: the bias is 0 at the first sample,
        and walks and drifts from there like a known bias. Small: a first constant rate far from zero counts as a spin.
        Large: a slow spin counts as a bias.
    walk_dps_rts
        Rate random walk K of IEEE Std 952, deg/s/√s. Small: the bias is averaged over many rests. Large: each rest
        replaces the estimate.
    drift_dps_s
        Rate ramp R of IEEE Std 952, deg/s²: fastest drift of the bias, during a warm-up or a change of the air. Small:
        a rest after a fast change counts as a spin. Large: a slow change of the true rate counts as drift.
    still_start
        Prior probability of rest at the first sample. Near 1: a constant rate from the first sample on is a bias.
        Small: it is a spin until the rate returns to it. The rate itself cannot decide between the two.
    rest_share
        Prior probability of rest for a later constant-rate segment. Small: a rate counts as a bias once it returns.
        Large: it counts at once.
    scale_percent
        Sigma of the scale factor, %. It changes only `yaw_sigma_deg`.
    """

    window_s: Annotated[float, Gt(0.0), Le(60.0)] = 0.3
    quiet: Annotated[float, Gt(0.0), Le(100.0)] = 5.0
    turn_on_dps: Annotated[float, Ge(0.0), Le(1000.0)] = 0.5
    walk_dps_rts: Annotated[float, Ge(0.0), Le(10.0)] = 0.0005
    drift_dps_s: Annotated[float, Ge(0.0), Le(10.0)] = 0.004
    still_start: Annotated[float, Ge(0.0), Lt(1.0)] = 0.99
    rest_share: Annotated[float, Ge(0.0), Lt(1.0)] = 0.2
    scale_percent: Annotated[float, Ge(0.0), Le(100.0)] = 1.0


@dataclass(frozen=True, slots=True)
class RestlevelCoefficients:
    """Values that follow from the parameters alone: variances for sigmas, odds for probabilities.

    window_s
        Length of a block, s.
    stationarity_sigmas
        Stationarity threshold, in sigmas of a variance.
    turn_on_var
        Variance of the turn-on bias, (deg/s)².
    rate_walk_var
        K² of the rate random walk: growth of the variance of the bias, (deg/s)² per s.
    rate_ramp_dps_s
        R of the rate ramp, deg/s².
    start_odds, rest_odds
        Prior odds of a rest against a segment that is no rest, at the start and later.
    scale_sigma
        Sigma of the scale factor, as a share.
    """

    window_s: float
    stationarity_sigmas: float
    turn_on_var: float
    rate_walk_var: float
    rate_ramp_dps_s: float
    start_odds: float
    rest_odds: float
    scale_sigma: float


def _free_slots() -> list[Hypothesis]:
    return [Hypothesis() for _ in range(2 * MAX_HYPOTHESES)]


@dataclass(slots=True)
class RestlevelState:
    """State of the filter. A deep copy saves the filter.

    t_s, rate_dps
        Time, s, and rate, deg/s, of the last accepted sample.
    temp_c
        Last temperature, °C; UNKNOWN_C before the first.
    yaw_deg, yaw_sigma_deg
        Yaw and its sigma. Yaw is 0 at the first sample, unless it was set before.
    bias_dps, bias_sigma_dps
        Bias estimate and its sigma at the end of the last block.
    rest_probability
        Probability that the device is at rest, at the end of the last block.
    confidence
        Probability of the most probable hypothesis.
    samples, rejected
        Numbers of accepted and of rejected samples. A sample is rejected if T ≤ 0, or if its rate or time is not finite
        or exceeds a limit.
    correction_deg, corrections
        Step of yaw in the last sample that is no motion, deg: a change of the estimate. Number of those over 1 deg.

    start_yaw_deg
        Yaw at the first sample or the last zero.
    lived_s
        Time since the first sample up to the present block, s.
    travelled_deg, travelled_s
        Sum of the absolute angles of all blocks since the first sample or the last zero, and their length, s.
    blocks
        Number of complete blocks.
    watch
        Limit that tells a gap from a step.
    witness
        External rest sensor.
    remembered, recalled, sure, line
        Remembered biases; remembered noise; sure rests; bias against temperature.
    level
        What a memory says of the x and y axes of the sensor. One axis carries it for a filter of three.
    block, noise, vibration, turns, wander, segment, ended, hypotheses, moments
        Present block; noise of the sensor; noise of noisier blocks; mean rates; agreement of levels; present
        constant-rate segment; last segment that has ended; Gaussian sum, and its moments at the beginning of the block.
    """

    t_s: float = 0.0
    rate_dps: float = 0.0
    temp_c: float = UNKNOWN_C
    yaw_deg: float = 0.0
    yaw_sigma_deg: float = 0.0
    bias_dps: float = 0.0
    bias_sigma_dps: float = 0.0
    rest_probability: float = 0.0
    confidence: float = 1.0
    samples: int = 0
    rejected: int = 0
    correction_deg: float = 0.0
    corrections: int = 0
    watch: GapWatch = field(default_factory=GapWatch)
    block: BlockStats = field(default_factory=BlockStats)
    start_yaw_deg: float = 0.0
    lived_s: float = 0.0
    travelled_deg: float = 0.0
    travelled_s: float = 0.0
    blocks: int = 0
    noise: NoiseModel = field(default_factory=NoiseModel)
    vibration: VibrationNoise = field(default_factory=VibrationNoise)
    turns: MeanTurns = field(default_factory=MeanTurns)
    wander: RateWander = field(default_factory=RateWander)
    witness: Witness = field(default_factory=Witness)
    remembered: list[RememberedBias] = field(default_factory=remembered_slots)
    recalled: RecalledNoise = field(default_factory=RecalledNoise)
    sure: SureRest = field(default_factory=SureRest)
    line: TempLine = field(default_factory=TempLine)
    level: list[AxisKnowledge] = field(default_factory=level_axes)
    segment: RateSegment = field(default_factory=RateSegment)
    ended: EndedSegment = field(default_factory=EndedSegment)
    moments: MixtureMoments = field(default_factory=MixtureMoments)
    hypotheses: list[Hypothesis] = field(default_factory=_free_slots)

    @property
    def temp_curve(self) -> dict[str, float] | None:
        """Bias against temperature for the status; None before the first measurement."""
        return curve(self.line.points, self.line.slope_dps_c, self.line.slope_var)


def curve(points: int, slope_dps_c: float, slope_var: float) -> dict[str, float] | None:
    """Bias against temperature for the status; None before the first measurement."""
    if points == 0:
        return None
    return {"points": points, "slope_dps_c": slope_dps_c, "slope_sigma_dps_c": slope_var**0.5}
