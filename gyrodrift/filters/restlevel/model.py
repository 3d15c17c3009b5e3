"""What restlevel consists of: parameters, the coefficients that follow from them, and the state."""

from dataclasses import dataclass, field
from typing import Annotated

from annotated_types import Ge, Gt, Le, Lt

from gyrodrift.filters.restlevel.bias_state import (
    UNSAID_C,
    Hypothesis,
    MixtureMoments,
    RecalledNoise,
    RememberedBias,
    SureRest,
    TempLine,
    Witness,
)
from gyrodrift.filters.restlevel.rate_state import (
    BlockStats,
    EndedSegment,
    MeanTurns,
    NoiseModel,
    RateSegment,
    RateWander,
)

UNKNOWN_C = UNSAID_C
COLDEST_C, WARMEST_C = -100.0, 200.0
"""Temperature before one was said; what a sensor says outside of these two is none."""

MAX_REMEMBERED = 2
"""Biases that may be remembered: of the last rest, and of a start like this one."""

MAX_HYPOTHESES = 6
"""Hypotheses that are kept from one segment to the next; each can branch into two at a segment."""


@dataclass(frozen=True, slots=True)
class RestlevelParams:
    """What a person or `tune` sets.

    window_s
        Length of the blocks that rest is looked for in, s. Small: short stops are found. Large: noise averages out.
    quiet
        Stationarity threshold: how far the variance of a block may lie above that of the sensor's own noise, in
        sigmas of a variance. Small: noisy rests are missed. Large: gentle motion passes for rest until its block
        means give it away.
    turn_on_dps
        Sigma of the turn-on bias, deg/s; 0 for a sensor that takes its own bias out: that is 0 at the first sample, and
        walks and drifts from there as a known bias does. Small: a first constant rate far from zero is taken for a
        spin. Large: a slow spin is taken for a bias.
    walk_dps_rts
        Rate random walk K of IEEE Std 952, deg/s/√s. Small: long averages. Large: every rest begins anew.
    drift_dps_s
        Rate ramp R of IEEE Std 952, deg/s²: the fastest that the bias drifts while the sensor warms up or the air
        changes. Small: a rest after a fast change is taken for a spin. Large: a slow change of a true rate is taken
        for drift.
    still_start
        Prior probability of rest at the first sample. Near 1: a constant rate from the first sample on is a bias.
        Small: it is a spin until the rate has come back to it. Nothing in the rate tells the two apart.
    rest_share
        Prior probability of rest for a later constant-rate segment. Small: a rate has to come back before it is
        believed to be a bias. Large: the first one is.
    scale_percent
        Sigma of the scale factor, %. It changes nothing but `yaw_sigma_deg`.
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
    """What follows from the parameters alone: variances in place of sigmas, odds in place of probabilities.

    window_s
        Length of a block, s.
    stationarity_sigmas
        Stationarity threshold, in sigmas of a variance.
    turn_on_var
        Variance of the turn-on bias, (deg/s)².
    rate_walk_var
        K² of the rate random walk: what it adds to the variance of the bias, (deg/s)² per s.
    rate_ramp_dps_s
        R of the rate ramp, deg/s².
    start_odds, rest_odds
        Prior odds of a rest against a segment that is none, at the start and later.
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


def _remembered_places() -> list[RememberedBias]:
    return [RememberedBias() for _ in range(MAX_REMEMBERED)]


def _free_places() -> list[Hypothesis]:
    return [Hypothesis() for _ in range(2 * MAX_HYPOTHESES)]


@dataclass(slots=True)
class RestlevelState:
    """All that changes from sample to sample; a deep copy of it is the filter saved.

    t_s, rate_dps
        Of the last accepted sample.
    temp_c
        Temperature that was said last, °C; UNKNOWN_C until one was.
    yaw_deg, yaw_sigma_deg
        Yaw, 0 at the first sample unless it was set before, and its sigma.
    bias_dps, bias_sigma_dps
        The bias estimate and its sigma, as of the last block.
    rest_probability
        Probability that the device is at rest, as of the last block.
    confidence
        Probability of the most probable hypothesis.
    samples, rejected
        Samples accepted, and samples passed by because T ≤ 0 or the rate or time was not finite.

    start_yaw_deg
        Yaw at the first sample.
    lived_s
        Time since the first sample, s, by block.
    travelled_deg
        Angle turned, to and fro, by block.
    blocks
        Blocks that have ended so far.
    witness
        What something else than the rate says of rest.
    remembered, recalled, sure, line
        Biases and noise that it begins with; the rests that it is sure of; bias against temperature.
    block, noise, turns, wander, segment, ended, hypotheses, moments
        The block that is being filled; the sensor's noise; mean turns; how levels wander; the present constant-rate
        segment and the last one that has ended; the Gaussian sum, and its moments as the block began.
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
    block: BlockStats = field(default_factory=BlockStats)
    start_yaw_deg: float = 0.0
    lived_s: float = 0.0
    travelled_deg: float = 0.0
    blocks: int = 0
    noise: NoiseModel = field(default_factory=NoiseModel)
    turns: MeanTurns = field(default_factory=MeanTurns)
    wander: RateWander = field(default_factory=RateWander)
    witness: Witness = field(default_factory=Witness)
    remembered: list[RememberedBias] = field(default_factory=_remembered_places)
    recalled: RecalledNoise = field(default_factory=RecalledNoise)
    sure: SureRest = field(default_factory=SureRest)
    line: TempLine = field(default_factory=TempLine)
    segment: RateSegment = field(default_factory=RateSegment)
    ended: EndedSegment = field(default_factory=EndedSegment)
    moments: MixtureMoments = field(default_factory=MixtureMoments)
    hypotheses: list[Hypothesis] = field(default_factory=_free_places)

    @property
    def temp_curve(self) -> dict[str, float] | None:
        """Bias against temperature for the status; None before there is a measurement."""
        line = self.line
        if line.points == 0:
            return None
        return {"points": line.points, "slope_dps_c": line.slope_dps_c, "slope_sigma_dps_c": line.slope_var**0.5}
