"""Restlevel worked out in another way: a recording is cut into blocks first, hypotheses are Gaussians with matrices.

Written from the equations of docs/restlevel.md, not from the filter's source: vectors (yaw, bias), covariances of two
by two, and a list of hypotheses that is made again at each constant-rate segment.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.stats import cauchy, norm

from gyrodrift.filters.restlevel.model import RestlevelParams
from gyrodrift.values.arrays import Floats


@dataclass
class ReferenceBlock:
    """Its last sample, its length in s, the angle turned in deg, its samples, and the variance of its rates."""

    end: int
    seconds: float
    turned_deg: float
    samples: int
    variance: float
    resolution_dps: float
    said: str = ""
    alike_dps: float | None = None


def blocks_of(t_s: Floats, rate_dps: Floats, window_s: float, still: Floats | None = None) -> list[ReferenceBlock]:
    """Cut a recording; `still` is what a witness says."""
    word = np.full(len(t_s), np.nan) if still is None else still
    steps_s = np.diff(t_s, prepend=t_s[0])
    steps_deg = steps_s * (rate_dps + np.r_[rate_dps[0], rate_dps[:-1]]) / 2.0
    apart = np.abs(np.diff(rate_dps, prepend=rate_dps[0]))
    finest = np.minimum.accumulate(np.where(apart > 0.0, apart, np.inf))
    result, first, seconds = [], 0, 0.0
    for n in range(len(t_s)):
        seconds += float(steps_s[n])  # one after the other: where a block ends hangs on the last bit
        if seconds >= window_s and n + 1 - first >= 6:
            inside = rate_dps[first : n + 1]
            result.append(
                ReferenceBlock(
                    n,
                    seconds,
                    float(steps_deg[first : n + 1].sum()),
                    len(inside),
                    float(inside.var()),
                    float(finest[n]) if np.isfinite(finest[n]) else 0.0,
                    said_of(word[first : n + 1]),
                    float(inside[0]) if (inside == inside[0]).all() else None,
                )
            )
            first, seconds = n + 1, 0.0
    return result


def said_of(words: Floats) -> str:
    if (words == 1.0).all():
        return "still"
    return "moves" if (words == 0.0).any() else ""


@dataclass
class ReferenceHypothesis:
    """A Gaussian over (yaw, bias), in one of twelve places: of two that are merged the first is kept."""

    place: int
    weight: float
    mean: Floats
    cov: Floats
    knows_bias: bool = False
    is_at_rest: bool = False
    was_at_rest: bool = False
    moving_s: float = 0.0
    prior: float = 0.0
    chance: float = 0.0
    noisy: float = 0.0
    odds: float = 1.0
    recent: tuple[float, float, float] = (0.0, 0.0, 0.0)
    slid_dps: float | None = None
    settled: tuple[float, float, float] = (0.0, 0.0, 0.0)
    turned: float = 1.0
    checkpoint: tuple[float, Floats, float] = (0.0, np.zeros((2, 2)), 0.0)


def kalman_update(
    h: ReferenceHypothesis, mean_dps: float, var: float, ramp_var: float
) -> tuple[ReferenceHypothesis, float]:
    """The hypothesis after a block mean at rest, and the logarithm of its likelihood."""
    lag = np.array([-h.moving_s / 2.0, 1.0])
    parts = []
    for share, cov in ((0.7, h.cov), (0.3, h.cov + ramp_var * np.outer(lag, lag))):
        s = cov[1, 1] + var
        gain = cov[:, 1] / s
        innovation = mean_dps - h.mean[1]
        parts.append(
            (
                np.log(share) + norm.logpdf(innovation, scale=np.sqrt(s)),
                h.mean + gain * innovation,
                cov - np.outer(gain, cov[1, :]),
            )
        )
    logs = np.array([part[0] for part in parts])
    total = np.logaddexp(*logs)
    mean, cov = moment_matched(np.exp(logs - total), [part[1] for part in parts], [part[2] for part in parts])
    return replace(h, mean=mean, cov=cov, moving_s=0.0), float(total)


def moment_matched(shares: Floats, means: list[Floats], covs: list[Floats]) -> tuple[Floats, Floats]:
    """Mean and covariance of a mixture."""
    mean = sum(share * item for share, item in zip(shares, means, strict=True))
    cov = sum(share * (item + np.outer(m - mean, m - mean)) for share, m, item in zip(shares, means, covs, strict=True))
    return np.asarray(mean), np.asarray(cov)


def first_kalman_update(
    h: ReferenceHypothesis, mean_dps: float, var: float, p: RestlevelParams
) -> tuple[ReferenceHypothesis, float]:
    if h.knows_bias:
        return kalman_update(h, mean_dps, var, (p.drift_dps_s * min(h.moving_s, 20.0)) ** 2)
    typical = norm.logpdf(mean_dps, scale=np.sqrt(h.cov[1, 1] + var)) + np.log(0.97)
    wide = norm.logpdf(mean_dps, scale=np.sqrt(16.0 * h.cov[1, 1] + var)) + np.log(0.03)
    far = max(1.0, mean_dps**2 / (9.0 * h.cov[1, 1]))
    cov = h.cov + (far - 1.0) * np.outer(h.cov[:, 1], h.cov[:, 1]) / h.cov[1, 1]
    result, _ = kalman_update(replace(h, cov=cov), mean_dps, var, 0.0)
    return replace(result, knows_bias=True), float(np.logaddexp(typical, wide))


def in_merge_gate(a: ReferenceHypothesis, b: ReferenceHypothesis) -> bool:
    """Whether two hypotheses may be one."""
    apart = np.abs(a.mean - b.mean)
    variances = (a.cov[1, 1], b.cov[1, 1])
    if not a.knows_bias and max(variances) > 4.0 * min(variances):
        return False
    return (
        a.is_at_rest == b.is_at_rest
        and a.knows_bias == b.knows_bias
        and apart[1] ** 2 < min(a.cov[1, 1], b.cov[1, 1])
        and apart[0] ** 2 < 1e-4 + min(a.cov[0, 0], b.cov[0, 0])
    )


@dataclass
class ReferenceFilter:
    """State after some blocks."""

    p: RestlevelParams
    hypotheses: list[ReferenceHypothesis]
    noise_var: float = -1.0
    before: float = -1.0
    walk: float = -1.0
    stationary_blocks: int = 0
    is_walk_measured: bool = False
    flicker: float = 0.0
    segment: list[float] = field(default_factory=list)
    segment_s: float = 0.0
    sensor_odds: float = 1.0
    mean: float = 0.0
    last: float = 0.0
    has_steps: bool = False
    number: int = 0
    means: list[float] = field(default_factory=list)
    blocks_ago: int = 10**9
    ended_mean: float = 0.0
    ended_s: float = 0.0
    ended_odds: float = 1.0
    is_gradual: bool = False
    wander: float = 0.0
    wander_dps: float = 10.0
    breaks: int = 0
    was_stationary: bool = False
    travelled: float = 0.0
    was_said: str = ""
    is_believed: bool = True
    refuted: int = 0
    doubt: float = 0.0
    against: list[float] = field(default_factory=list)
    before_dps: float = 0.0
    since_s: float = 0.0
    was_certain: bool = False
    temp_c: float = np.nan
    rest_c: float = np.nan
    sure_s: float = 0.0
    sure_rests: int = 0
    is_sure: bool = False
    turns: list[float] = field(default_factory=list)
    turn_s: float = 0.0
    turn_deg: float = 0.0
    line: Floats = field(default_factory=lambda: np.zeros(2))
    line_cov: Floats = field(default_factory=lambda: np.diag([0.0, 0.01**2]))
    line_at: tuple[float, float] | None = None
    frozen_deg: float = 0.0

    def __post_init__(self) -> None:
        """The output before the first block."""
        self.give_output()

    def give_output(self) -> None:
        """Moments of the mixture, and the probability of rest, at the end of a block."""
        self.yaw_deg, self.bias_dps, self.yaw_var, self.sigma_dps = collapsed(self.hypotheses)
        self.resting = sum(h.weight for h in self.hypotheses if h.is_at_rest)

    def hangs(self, b: ReferenceBlock) -> bool:
        """Whether one value is repeated through a block, though noise of two steps or more was seen at rest."""
        bias_dps = self.bias_dps
        is_noisy = self.is_walk_measured and np.sqrt(self.noise_var) > 2.0 * b.resolution_dps
        is_clamped = b.alike_dps == 0.0 and abs(bias_dps) <= np.sqrt(max(0.0, self.noise_var))
        if b.alike_dps is None or is_clamped or not is_noisy or not 0.0 < b.resolution_dps <= 0.03:
            self.frozen_deg = 0.0
            return False
        before, self.before = self.frozen_deg, self.noise_var
        self.frozen_deg += abs(b.turned_deg - bias_dps * b.seconds)
        for h in self.hypotheses:
            h.cov = h.cov + np.diag([self.frozen_deg**2 - before**2, 0.0])
        return True

    def is_stationary(self, b: ReferenceBlock) -> bool:
        """Whether the block shows no more than the noise, which is followed."""
        is_quiet = self.stationary_blocks < 5 or max(b.variance, 0.0009) < 1.44
        if b.resolution_dps > 0.0 and not self.has_steps and is_quiet:
            self.noise_var, self.before, self.stationary_blocks = -1.0, -1.0, 0
            self.has_steps, self.is_walk_measured = True, False
        variance = max(b.variance, self.rounding(b), 1e-12)
        error = np.sqrt(2.0 / b.samples)
        if self.noise_var < 0.0:
            self.noise_var = variance
        limit = 1.0 + self.p.quiet * error * np.sqrt(1.0 + 1.0 / max(self.stationary_blocks, 1))
        if max(variance, self.before) < self.noise_var * np.exp(-4.5 * error):
            self.noise_var = max(variance, self.before)
            self.wander, self.wander_dps, self.breaks = 0.0, 10.0, 0
            for h in self.hypotheses:
                h.weight *= 0.1 if h.knows_bias else 1.0
            self.normalise()
        elif variance < self.noise_var * limit:
            self.stationary_blocks = min(self.stationary_blocks + 1, 20)
            if self.stationary_blocks == 20:
                self.noise_var *= (variance / self.noise_var) ** 0.05
            else:
                self.noise_var += (variance - self.noise_var) / self.stationary_blocks
        else:
            self.noise_var *= 1.0 + 0.001 * b.seconds
        self.before = variance
        if not self.is_walk_measured:
            self.walk = 2.0 * self.noise_var * b.seconds / b.samples
        return bool(variance < self.noise_var * limit)

    def rounding(self, b: ReferenceBlock) -> float:
        """Variance that steps may hide."""
        return min(0.25 * b.resolution_dps**2, 0.015625) if self.has_steps else 0.0009

    def follow(self, b: ReferenceBlock, mean_dps: float) -> None:
        """The segment grows, begins or ends."""
        self.number += 1
        self.means = [*self.means, mean_dps] if self.number > 2 else [mean_dps]
        was, mean_was, seconds_was, odds_was = len(self.segment), self.mean, self.segment_s, self.sensor_odds
        is_stationary = not self.hangs(b) and self.is_stationary(b) and b.said != "moves"
        sets_out = 3 <= was < 5 and was * b.seconds >= 5.0 * self.p.window_s and not is_stationary
        sets_out = sets_out and self.is_from_start(b, self.number - 1, self.means[:-1])
        var, ramp = self.walk / b.seconds, self.p.drift_dps_s * b.seconds
        spread = np.sqrt(var * (1.0 + 1.0 / max(1, min(was, 10))) + ramp**2 + self.flicker)
        agrees = not self.segment or abs(mean_dps - self.mean) < 4.0 * spread
        if is_stationary and self.was_stationary and not (agrees and was >= 5):
            self.wander = 0.98 * self.wander + (np.log(0.8 / 0.98) if agrees else np.log(0.2 / 0.02))
            if not agrees:
                self.breaks += 1
                gain = max(0.1, 1.0 / self.breaks)
                self.wander_dps *= np.exp(np.sign(abs(mean_dps - self.mean) - self.wander_dps) * gain)
        self.was_stationary = is_stationary
        if is_stationary:
            self.extend(b, mean_dps, 2.0 * np.sqrt(var + 4.0 * ramp**2), agrees=agrees)
        else:
            self.segment = []
        self.blocks_ago += 1
        if sets_out:
            self.branch(mean_was, self.walk / (was * b.seconds), self.p.rest_share)
        is_gradual = is_stationary and abs(mean_dps - self.last) < 0.4 * b.seconds
        if sets_out or was >= 5 > len(self.segment):
            self.blocks_ago, self.ended_mean, self.ended_s, self.ended_odds = 1, mean_was, seconds_was, odds_was
            self.is_gradual = is_gradual
            self.hypotheses = [replace(h, is_at_rest=False, was_at_rest=h.is_at_rest) for h in self.hypotheses]
        elif self.blocks_ago == 2 and self.is_gradual and not is_gradual:
            self.is_gradual = False
        elif self.blocks_ago == 2 and self.is_gradual:
            ended = [h for h in self.hypotheses if h.was_at_rest]
            self.weigh(ended, self.ended_s, self.ended_odds, gradual=(0.01, 0.1, 0.9))
            self.hypotheses = [taken_back(h) if h.was_at_rest else h for h in self.hypotheses]
            self.normalise()

    def extend(self, b: ReferenceBlock, mean_dps: float, most_slope_dps: float, *, agrees: bool) -> None:
        """Add a stationary block to the segment, or begin another."""
        if not self.segment or not agrees:
            self.segment, self.mean, self.segment_s = [mean_dps], mean_dps, b.seconds
            return
        self.segment.append(mean_dps)
        self.segment_s += b.seconds
        a = self.segment
        if len(a) == 5 and abs(0.5 * (a[4] + a[3] - a[1] - a[0])) >= most_slope_dps:
            self.segment = []
            return
        scatter = 0.25 * b.samples * float(np.mean(np.diff(a) ** 2))
        self.sensor_odds = sensor_odds_of(max(1e-12, min(self.noise_var, scatter)))

    @staticmethod
    def weigh(
        rests: list[ReferenceHypothesis],
        seconds: float,
        sensor_odds: float,
        gradual: tuple[float, float, float] = (1.0, 1.0, 1.0),
    ) -> None:
        """Set the odds of rests against spins, levels by chance and noisy motions, in place of the odds before.

        `gradual` has the shares of rests, spins and motions with such an end.
        """
        longer = 1.0 / np.sqrt(1.0 + (seconds / 12.0) ** 2)
        for h in rests:
            rest = gradual[0] * h.prior * sensor_odds * longer
            spin = gradual[1] * 0.03 * longer**1.5
            motion = gradual[2] * (h.chance + (1.0 - sensor_odds) * h.noisy) * longer
            odds = float(rest / (spin + motion))
            h.weight *= odds / h.odds
            h.odds = odds

    def turn(self, b: ReferenceBlock, mean_dps: float, *, is_new: bool) -> None:
        """A mean rate of ten seconds outside of segments, or that of a new turn, goes to the last 32."""
        if is_new:
            self.turns += [] if self.is_gradual else [self.mean]
        elif len(self.segment) < 5:
            self.turn_s, self.turn_deg = self.turn_s + b.seconds, self.turn_deg + mean_dps * b.seconds
            if self.turn_s >= 10.0:
                self.turns.append(self.turn_deg / self.turn_s)
                self.turn_s, self.turn_deg = 0.0, 0.0
        self.turns = self.turns[-32:]
        if len(self.turns) < 5:
            return
        middle, half = (len(self.turns) - 1) / 2.0, np.sqrt(len(self.turns)) / 2.0
        ranks = np.arange(len(self.turns))
        low, median, high = np.interp([middle - half, middle, middle + half], ranks, np.sort(self.turns))
        for h in self.hypotheses:
            spread = np.sqrt(h.cov[1, 1] + (high - low) ** 2 + 0.0025)
            density = 0.015 + 0.5 * norm.pdf(median, h.mean[1], spread)
            h.weight *= density / h.turned
            h.turned = density
        self.normalise()

    def predict(self, b: ReferenceBlock) -> None:
        """Every hypothesis, by one block."""
        turns = np.array([[1.0, -b.seconds], [0.0, 1.0]])
        for h in self.hypotheses:
            if not h.is_at_rest:
                h.mean = turns @ h.mean + np.array([b.turned_deg, 0.0])
                h.cov = turns @ h.cov @ turns.T + np.diag([self.walk * b.seconds, 0.0])
                h.moving_s += b.seconds
            h.cov = h.cov + np.diag([0.0, self.p.walk_dps_rts**2 * b.seconds])

    def enter(self) -> None:
        """A segment may begin: what each hypothesis says now is kept."""
        self.hypotheses = [replace(h, checkpoint=(h.mean[0], h.cov.copy(), h.moving_s)) for h in self.hypotheses]

    def normalise(self) -> None:
        """Probabilities add up to 1."""
        total = sum(h.weight for h in self.hypotheses)
        for h in self.hypotheses:
            h.weight /= total

    def zero_velocity_update(self, b: ReferenceBlock, mean_dps: float) -> None:
        """Hypotheses of rest learn."""
        var, ramp = self.walk / b.seconds, self.p.drift_dps_s * b.seconds
        at_rest = [h for h in self.hypotheses if h.is_at_rest]
        resting = sum(h.weight for h in at_rest)
        for h in at_rest:
            h.chance = 0.9 * h.chance
        self.weigh(at_rest, self.segment_s, self.sensor_odds)
        excess = [(mean_dps - h.mean[1]) ** 2 - h.cov[1, 1] - var - self.flicker for h in at_rest]
        pull = sum(h.weight * min(e, 4.0 * (var + self.flicker)) for h, e in zip(at_rest, excess, strict=True))
        self.hypotheses = [
            followed(kalman_update(h, mean_dps, var, ramp**2)[0], b.seconds, self.p.drift_dps_s) if h.is_at_rest else h
            for h in self.hypotheses
        ]
        self.normalise()
        self.learn_noise(b, mean_dps, resting, pull)

    def believes(self, b: ReferenceBlock, mean_dps: float) -> bool:
        """Whether a witness says rest and is believed."""
        bias_dps, sigma_dps = self.bias_dps, self.sigma_dps
        self.since_s = b.seconds if self.resting > 0.5 else self.since_s + b.seconds
        was_said, self.was_said = self.was_said, b.said
        if b.said != "still":
            self.is_believed, self.against = True, []
            return False
        if was_said != "still":
            self.before_dps = bias_dps
        if not self.is_believed:
            return False
        var, ramp = self.loud_var(b), self.p.drift_dps_s * min(self.since_s, 20.0)
        if abs(mean_dps - bias_dps) < 6.0 * np.sqrt(sigma_dps**2 + var + self.flicker + ramp**2):
            self.doubt, self.against = max(0.0, self.doubt - 0.1), []
            return True
        spread = np.sqrt(2.0 * var + (self.p.drift_dps_s * b.seconds) ** 2 + self.flicker)
        agrees = self.against and abs(mean_dps - np.mean(self.against)) < 4.0 * spread
        self.against = [*self.against, mean_dps] if agrees else [mean_dps]
        self.doubt += 1.0
        is_known = sum(h.weight for h in self.hypotheses if h.knows_bias) > 0.5
        away = float(np.mean(self.against)) - (bias_dps if is_known else 0.0)
        if len(self.against) >= (5 if is_known else 2) and abs(away) < (1.0 if is_known else 20.0) * self.p.turn_on_dps:
            self.less_certain(away**2 * is_known)
            self.doubt, self.against = 0.0, []
            return True
        if self.doubt < 5.0:
            return False
        self.less_certain((bias_dps - self.before_dps) ** 2)
        self.is_believed, self.doubt, self.against = False, 4.0, []
        self.refuted += 1
        return False

    def warm(self, b: ReferenceBlock, temp_c: Floats | None) -> None:
        """Average the temperature. It moves the bias along the line and makes it less certain."""
        if temp_c is None:
            return
        before = temp_c[b.end] if np.isnan(self.temp_c) else self.temp_c
        self.temp_c = before + (temp_c[b.end] - before) * min(1.0, b.seconds / 3.0)
        if self.resting > 0.5 or np.isnan(self.rest_c):
            self.rest_c = before
        wider = max(0.0, (self.temp_c - self.rest_c) ** 2 - (before - self.rest_c) ** 2)
        more_var = self.line_cov[1, 1] * wider + 0.015**2 * abs(self.temp_c - before)
        moved = self.line[1] * (self.temp_c - before)
        self.hypotheses = [
            replace(h, mean=h.mean + np.array([0.0, moved]), cov=h.cov + np.diag([0.0, more_var]))
            if h.knows_bias and not h.is_at_rest
            else h
            for h in self.hypotheses
        ]

    def learn_temperature(self, b: ReferenceBlock, t_s: float, *, is_certain: bool) -> None:
        """Ten seconds of a sure rest measure the level of the line."""
        bias_dps, sigma_dps = self.bias_dps, self.sigma_dps
        if self.resting < 0.95:
            self.sure_s, self.is_sure = 0.0, False
            return
        was_s, self.sure_s = self.sure_s, self.sure_s + b.seconds
        if self.sure_s < (1.5 if is_certain else 10.0):
            return
        if not self.is_sure:
            self.sure_rests, self.is_sure = self.sure_rests + 1, True
        if np.isnan(self.temp_c) or self.sure_s // 10.0 == was_s // 10.0:
            return
        if self.line_at is None:
            self.line[0], self.line_cov[0, 0] = bias_dps, sigma_dps**2
        else:
            self.measure(bias_dps, sigma_dps**2, t_s)
        self.line_at = (self.temp_c, t_s)

    def measure(self, bias_dps: float, var: float, t_s: float) -> None:
        """Predict and update level and slope."""
        assert self.line_at is not None
        step_c, step_s = self.temp_c - self.line_at[0], t_s - self.line_at[1]
        move = np.array([[1.0, step_c], [0.0, 1.0]])
        mean, cov = move @ self.line, move @ self.line_cov @ move.T
        cov[0, 0] += 0.015**2 * abs(step_c) + self.p.walk_dps_rts**2 * step_s
        off = bias_dps - mean[0]
        cov[0, 0] += off**2 if off**2 > 9.0 * (cov[0, 0] + var) else 0.0
        gain = cov[:, 0] / (cov[0, 0] + var)
        self.line, self.line_cov = mean + gain * off, cov - np.outer(gain, cov[0])

    def loud_var(self, b: ReferenceBlock) -> float:
        louder = self.before / self.noise_var
        return self.walk / b.seconds * (max(1.0, louder) if self.is_walk_measured else louder)

    def less_certain(self, var: float) -> None:
        self.hypotheses = [replace(h, cov=h.cov + np.diag([0.0, var])) for h in self.hypotheses]

    def stand_still(self, b: ReferenceBlock, mean_dps: float) -> None:
        """The block is a rest in all hypotheses."""
        var, ramp = self.loud_var(b), self.p.drift_dps_s * b.seconds
        if not self.is_walk_measured:
            self.noise_var, self.walk = self.before, var * b.seconds
        at_rest = [h for h in self.hypotheses if h.is_at_rest]
        beyond = sum(h.weight * ((mean_dps - h.mean[1]) ** 2 - h.cov[1, 1] - var - self.flicker) for h in at_rest)
        result, logs = [], []
        for h in self.hypotheses:
            drifted = self.p.drift_dps_s * (b.seconds if h.is_at_rest else min(h.moving_s, 20.0))
            spread = np.sqrt(h.cov[1, 1] + drifted**2 + var + self.flicker)
            logs.append(np.log(h.weight) + norm.logpdf(mean_dps, h.mean[1], spread))
            if h.is_at_rest:
                new = kalman_update(h, mean_dps, var, ramp**2)[0]
            else:
                new = first_kalman_update(h, mean_dps, var, self.p)[0]
            rest = replace(new, is_at_rest=True, moving_s=0.0, prior=1.0, chance=0.0, noisy=0.0, odds=1.0)
            result.append(settled(rest))
        result = [replace(h, weight=np.exp(log - max(logs))) for h, log in zip(result, logs, strict=True)]
        self.hypotheses = result
        if self.was_certain:
            self.learn_noise(b, mean_dps, 1.0, min(beyond, 4.0 * (var + self.flicker)))
        self.hypotheses = merged_and_pruned(self.hypotheses)

    def learn_noise(self, b: ReferenceBlock, mean_dps: float, resting: float, beyond: float) -> None:
        """Flicker and angle random walk, by a block at rest."""
        self.flicker = max(0.0, self.flicker + 0.002 * beyond)
        self.is_walk_measured = self.is_walk_measured or resting > 0.5
        result = min(0.5 * (mean_dps - self.last) ** 2 * b.seconds, 9.0 * self.walk)
        self.walk += 0.05 * resting * (result - self.walk)
        self.walk = max(self.walk, self.rounding(b) / b.samples * b.seconds)

    def confirm(self, b: ReferenceBlock) -> bool:
        """The segment is one: it is the one before, or every hypothesis branches. Whether it is another one."""
        var = self.walk / (5.0 * b.seconds)
        spread = np.sqrt(
            self.walk / b.seconds * 0.3 + (self.p.drift_dps_s * b.seconds * self.blocks_ago) ** 2 + self.flicker
        )
        gate_sigmas = 6.0 if self.ended_s >= 15.0 else 4.0
        if self.blocks_ago <= 15 and abs(self.mean - self.ended_mean) < gate_sigmas * spread:
            self.segment_s += self.ended_s
            resumed = [h.was_at_rest for h in self.hypotheses]
            self.hypotheses = [
                replace(first_kalman_update(self.resumed(h), self.mean, var, self.p)[0], is_at_rest=True)
                if h.was_at_rest
                else h
                for h in self.hypotheses
            ]
            rests = [h for h, is_resumed in zip(self.hypotheses, resumed, strict=True) if is_resumed]
            self.weigh(rests, self.segment_s, self.sensor_odds)
            self.normalise()
            return False
        is_start = self.is_from_start(b, self.number, self.means)
        self.branch(self.mean, var, self.p.still_start if is_start else self.p.rest_share)
        return True

    def resumed(self, h: ReferenceHypothesis) -> ReferenceHypothesis:
        """A rest as it was where the segment that resumes it began."""
        back = gone_back(h)
        return given_back(back) if self.is_gradual else back

    def is_from_start(self, b: ReferenceBlock, blocks: int, means: list[float]) -> bool:
        """Whether nothing has moved in these blocks, and there are few of them."""
        return blocks < 15 and max(means) - min(means) < 6.0 * np.sqrt(self.walk / b.seconds)

    def branch(self, mean_dps: float, var: float, share: float) -> None:
        """Each hypothesis becomes one of a rest and one of a spin."""
        prior = share / (1.0 - share)
        wanders = 1.0 / (1.0 + 9.0 * np.exp(-self.wander))
        everyone = list(self.hypotheses)
        for h in self.hypotheses:
            if h.is_at_rest:
                continue
            back = replace(gone_back(h), was_at_rest=False)
            result, log_likelihood = first_kalman_update(back, mean_dps, var, self.p)
            away_dps, bias_var = mean_dps - h.mean[1], h.cov[1, 1]
            rest = replace(
                result,
                is_at_rest=True,
                place=min(set(range(12)) - {second.place for second in everyone if second.weight > 0.0}),
                weight=h.weight * np.exp(log_likelihood),
                prior=prior,
                chance=float(4.0 * wanders * cauchy.pdf(away_dps, scale=np.sqrt(self.wander_dps**2 + bias_var))),
                noisy=float(max(1.0, prior) * cauchy.pdf(away_dps, scale=np.sqrt(self.noise_var + bias_var))),
                odds=1.0,
            )
            self.weigh([rest], self.segment_s, self.sensor_odds)
            everyone.append(settled(rest))
        self.hypotheses = merged_and_pruned(sorted(everyone, key=lambda h: h.place))


def sensor_odds_of(variance: float) -> float:
    """Likelihood ratio of a scatter as noise of a sensor at rest and as a motion, at most 1."""
    louder = max(0.0, np.log(np.sqrt(variance) / 0.06))
    return float(min(1.0, 0.4 * np.exp(-(louder**2) / 2.0) / 0.11))


def begun(
    p: RestlevelParams, remembered: Sequence[tuple[float, float, float]], yaw_deg: float
) -> list[ReferenceHypothesis]:
    kinds = ((0.25, 1e-4), (0.25, 1e-2), (0.5, 1.0)) if p.turn_on_dps else ((1.0, 1.0),)
    expected = len(remembered)
    unknown = 1.0 - sum(weight for weight, _, _ in remembered)
    result = [
        ReferenceHypothesis(
            k, weight, np.array([yaw_deg, bias]), np.diag([0.0, var + p.walk_dps_rts**2]), knows_bias=True
        )
        for k, (weight, bias, var) in enumerate(remembered)
    ]
    for k, (weight, share) in enumerate(kinds):
        mean, cov = np.array([yaw_deg, 0.0]), np.diag([0.0, share * p.turn_on_dps**2])
        result.append(ReferenceHypothesis(expected + k, unknown * weight, mean, cov, p.turn_on_dps == 0.0))
    return result


def first_measured(blocks: list[ReferenceBlock], rate_dps: Floats) -> int:
    """Number of the block, one of the first two with steps, whose fine steps say that zeros were no rates; else −1."""
    silent = [b for b in blocks if b.resolution_dps == 0.0]
    if not silent or rate_dps[silent[-1].end] != 0.0:
        return -1
    with_steps = range(len(silent), min(len(silent) + 2, len(blocks)))
    return next((number for number in with_steps if blocks[number].resolution_dps <= 0.03), -1)


def measuring_at_last(mute: ReferenceFilter, hypotheses: list[ReferenceHypothesis]) -> ReferenceFilter:
    """A sensor that has said zero alone so far: what others say stays, what was learned of it does not."""
    witness = ("was_said", "is_believed", "refuted", "doubt", "against", "before_dps", "since_s", "was_certain")
    warmth = ("temp_c", "rest_c", "line", "line_cov", "line_at")
    kept = [*witness, *warmth, "last", "travelled"]
    return ReferenceFilter(mute.p, hypotheses, has_steps=True, **{name: getattr(mute, name) for name in kept})


def reference(
    t_s: Floats,
    rate_dps: Floats,
    p: RestlevelParams,
    still: Floats | None = None,
    remembered: Sequence[tuple[float, float, float]] = (),
    temp_c: Floats | None = None,
) -> dict[str, Floats]:
    """Yaw, bias and their standard deviations at the end of each block; `end` has the samples."""
    item = ReferenceFilter(p, begun(p, remembered, 0.0))
    rows = []
    blocks = blocks_of(t_s, rate_dps, p.window_s, still)
    first = first_measured(blocks, rate_dps)
    for number, b in enumerate(blocks):
        if number == first:
            item = measuring_at_last(item, begun(p, remembered, item.yaw_deg))
        mean_dps = b.turned_deg / b.seconds
        item.follow(b, mean_dps)
        if len(item.segment) == 1:
            item.enter()
        item.warm(b, temp_c)
        is_certain = item.believes(b, mean_dps)
        if is_certain:
            item.stand_still(b, mean_dps)
        elif item.was_certain and len(item.segment) < 5:
            item.hypotheses = [replace(h, is_at_rest=False) for h in item.hypotheses]
        item.predict(b)
        if len(item.segment) > 5 and not is_certain:
            item.zero_velocity_update(b, mean_dps)
        if len(item.segment) > 1:
            item.mean += (mean_dps - item.mean) / min(len(item.segment), 10)
        is_new = len(item.segment) == 5 and not is_certain and item.confirm(b)
        item.turn(b, mean_dps, is_new=is_new)
        item.give_output()
        item.was_certain = is_certain
        item.last = mean_dps
        item.learn_temperature(b, float(t_s[b.end]), is_certain=is_certain)
        rows.append((b.end, item.yaw_deg, item.bias_dps, item.yaw_var, item.sigma_dps))
    columns = zip(*rows, strict=True)
    return {
        name: np.array(column) for name, column in zip(("end", "yaw", "bias", "yaw_var", "sigma"), columns, strict=True)
    }


def settled(h: ReferenceHypothesis) -> ReferenceHypothesis:
    now = (float(h.mean[1]), float(h.cov[1, 1]), 0.0)
    return replace(h, recent=now, settled=now, slid_dps=None)


def followed(h: ReferenceHypothesis, seconds: float, drift_dps_s: float) -> ReferenceHypothesis:
    """Every 4 s of a rest: whether it slides, and since when. Nothing is said of that before the first flat step."""
    recent, then = ((bias, var, ago_s + seconds) for bias, var, ago_s in (h.recent, h.settled))
    if recent[2] < 4.0:
        return replace(h, recent=recent, settled=then)
    now = (float(h.mean[1]), float(h.cov[1, 1]), 0.0)
    step = now[0] - recent[0]
    if h.slid_dps is None:
        is_flat = abs(step) <= drift_dps_s + np.sqrt(recent[1])
        return replace(h, recent=now, settled=recent, slid_dps=0.0 if is_flat else None)
    slid = float(np.sign(h.slid_dps + step)) * max(0.0, abs(h.slid_dps + step) - drift_dps_s)
    goes_on = np.sign(slid) * np.sign(h.slid_dps) > 0.0 and then[2] < 40.0
    return replace(h, recent=now, settled=then if goes_on else recent, slid_dps=slid)


def exchanged(h: ReferenceHypothesis) -> ReferenceHypothesis:
    """Bias and settled bias, with their variances."""
    bias, var, ago_s = h.settled
    cov = np.array([[h.cov[0, 0], h.cov[0, 1]], [h.cov[1, 0], var]])
    then = (float(h.mean[1]), float(h.cov[1, 1]), ago_s)
    return replace(h, mean=np.array([h.mean[0], bias]), cov=cov, settled=then)


def taken_back(h: ReferenceHypothesis) -> ReferenceHypothesis:
    """A rest that has ended gradually: it ended with the bias it had settled at, which is as old as that."""
    own, (yaw, cov, moving_s) = exchanged(h), h.checkpoint
    rotated = np.array([(h.mean[1] - own.mean[1]) * h.moving_s, 0.0])
    older = (yaw, cov, moving_s + h.settled[2])
    return replace(own, mean=own.mean + rotated, moving_s=h.moving_s + h.settled[2], checkpoint=older)


def given_back(h: ReferenceHypothesis) -> ReferenceHypothesis:
    own, passed_s = exchanged(h), h.moving_s - h.settled[2]
    rotated = np.array([(h.mean[1] - own.mean[1]) * passed_s, 0.0])
    return replace(own, mean=own.mean + rotated, moving_s=passed_s)


def gone_back(h: ReferenceHypothesis) -> ReferenceHypothesis:
    """The hypothesis with yaw and its covariance as they were where the segment began."""
    yaw, cov, moving_s = h.checkpoint
    cov = np.array([[cov[0, 0], cov[0, 1]], [cov[1, 0], h.cov[1, 1]]])
    return replace(h, mean=np.array([yaw, h.mean[1]]), cov=cov, moving_s=moving_s)


def merged_and_pruned(hypotheses: list[ReferenceHypothesis]) -> list[ReferenceHypothesis]:
    """Merge what is in the gate, keep the six that are most probable, of equal weights the last."""
    total = sum(h.weight for h in hypotheses)
    remaining = [replace(h, weight=h.weight / total) for h in hypotheses if h.weight > 0.0]
    k = 0
    while k < len(remaining):
        j = k + 1
        while j < len(remaining):
            if in_merge_gate(remaining[k], remaining[j]):
                a, b = remaining[k], remaining.pop(j)
                weight = a.weight + b.weight
                shares = np.array([a.weight, b.weight]) / weight
                mean, cov = moment_matched(shares, [a.mean, b.mean], [a.cov, b.cov])
                remaining[k] = replace(
                    a,
                    weight=weight,
                    mean=mean,
                    cov=cov,
                    moving_s=min(a.moving_s, b.moving_s),
                    prior=float(shares @ [a.prior, b.prior]),
                    chance=float(shares @ [a.chance, b.chance]),
                    noisy=float(shares @ [a.noisy, b.noisy]),
                    odds=float(shares @ [a.odds, b.odds]),
                    turned=float(shares @ [a.turned, b.turned]),
                )
            else:
                j += 1
        k += 1
    remaining = [h for h in remaining if h.weight >= 1e-9]
    keep = sorted(remaining, key=lambda h: h.weight)[-6:]
    remaining = [h for h in remaining if any(h is item for item in keep)]
    total = sum(h.weight for h in remaining)
    return [replace(h, weight=h.weight / total) for h in remaining]


def widened(h: ReferenceHypothesis) -> Floats:
    """Covariance of yaw and bias; before the first rest with 16 times the variance of the turn-on bias."""
    carried = h.cov[:, 1]
    return h.cov if h.knows_bias else h.cov + 15.0 * np.outer(carried, carried) / h.cov[1, 1]


def collapsed(hypotheses: list[ReferenceHypothesis]) -> tuple[float, float, float, float]:
    """Yaw and bias as means by cubed weight; their variances about that by weight."""
    weights = np.array([h.weight for h in hypotheses])
    means = np.array([h.mean for h in hypotheses])
    mean = weights**3 @ means / (weights**3).sum()
    kept = np.maximum(weights - 0.045, 0.0)
    kept /= kept.sum()
    cov = sum(w * (widened(h) + np.outer(h.mean - mean, h.mean - mean)) for w, h in zip(kept, hypotheses, strict=True))
    return float(mean[0]), float(mean[1]), float(cov[0, 0]), float(np.sqrt(cov[1, 1]))
