"""Restlevel worked out in another way: a recording is cut into blocks first, accounts are Gaussians with matrices.

Written from the equations of docs/restlevel.md, not from the filter's source: vectors (yaw, bias), covariances of two
by two, and a list of accounts that is made anew at each plateau.
"""

from dataclasses import dataclass, field, replace

import numpy as np
from scipy.stats import norm

from gyrodrift.arrays import Floats
from gyrodrift.filters.restlevel.model import RestlevelParams


@dataclass
class Block:
    """Its last sample, its length in s, the angle turned in deg, its samples, and the variance of its rates."""

    end: int
    seconds: float
    turned_deg: float
    samples: int
    variance: float
    resolution_dps: float


def blocks_of(t_s: Floats, rate_dps: Floats, window_s: float) -> list[Block]:
    """Cut a recording."""
    steps_s = np.diff(t_s, prepend=t_s[0])
    steps_deg = steps_s * (rate_dps + np.r_[rate_dps[0], rate_dps[:-1]]) / 2.0
    apart = np.abs(np.diff(rate_dps, prepend=rate_dps[0]))
    finest = np.minimum.accumulate(np.where(apart > 0.0, apart, np.inf))
    found, first, seconds = [], 0, 0.0
    for n in range(len(t_s)):
        seconds += float(steps_s[n])  # one after the other: where a block ends hangs on the last bit
        if seconds >= window_s and n + 1 - first >= 6:
            inside = rate_dps[first : n + 1]
            found.append(
                Block(
                    n,
                    seconds,
                    float(steps_deg[first : n + 1].sum()),
                    len(inside),
                    float(inside.var()),
                    float(finest[n]) if np.isfinite(finest[n]) else 0.0,
                )
            )
            first, seconds = n + 1, 0.0
    return found


@dataclass
class Account:
    """A Gaussian over (yaw, bias), in one of twelve places: of two that are the same the one in the first is kept."""

    place: int
    weight: float
    mean: Floats
    cov: Floats
    knows: bool = False
    rests: bool = False
    rested: bool = False
    moved_s: float = 0.0
    is_news: bool = False
    entry: tuple[float, Floats, float] = (0.0, np.zeros((2, 2)), 0.0)


def told(h: Account, level: float, var: float, drift_var: float) -> tuple[Account, float]:
    """The account after a level at rest, and the logarithm of how probable the level was."""
    lag = np.array([-h.moved_s / 2.0, 1.0])
    parts = []
    for share, cov in ((0.7, h.cov), (0.3, h.cov + drift_var * np.outer(lag, lag))):
        s = cov[1, 1] + var
        gain = cov[:, 1] / s
        off = level - h.mean[1]
        parts.append(
            (
                np.log(share) + norm.logpdf(off, scale=np.sqrt(s)),
                h.mean + gain * off,
                cov - np.outer(gain, cov[1, :]),
            )
        )
    logs = np.array([part[0] for part in parts])
    total = np.logaddexp(*logs)
    mean, cov = merged(np.exp(logs - total), [part[1] for part in parts], [part[2] for part in parts])
    return replace(h, mean=mean, cov=cov, moved_s=0.0), float(total)


def merged(shares: Floats, means: list[Floats], covs: list[Floats]) -> tuple[Floats, Floats]:
    """Mean and covariance of a mixture."""
    mean = sum(share * each for share, each in zip(shares, means, strict=True))
    cov = sum(share * (each + np.outer(m - mean, m - mean)) for share, m, each in zip(shares, means, covs, strict=True))
    return np.asarray(mean), np.asarray(cov)


def first_told(h: Account, level: float, var: float, p: RestlevelParams) -> tuple[Account, float]:
    """The same for the first blocks of a plateau."""
    off = abs(level - h.mean[1])
    h = replace(h, is_news=not h.knows or off > 3.0 * np.sqrt(h.cov[1, 1] + var))
    if h.knows:
        return told(h, level, var, (p.drift_dps_s * min(h.moved_s, 20.0)) ** 2)
    narrow = norm.logpdf(level, scale=np.sqrt(p.turn_on_dps**2 + var)) + np.log(0.97)
    wide = norm.logpdf(level, scale=np.sqrt(16.0 * p.turn_on_dps**2 + var)) + np.log(0.03)
    far = max(1.0, level**2 / (9.0 * h.cov[1, 1]))
    cov = h.cov * np.array([[1.0, far], [far, far]])
    found, _ = told(replace(h, cov=cov), level, var, 0.0)
    return replace(found, knows=True), float(np.logaddexp(narrow, wide))


def same(a: Account, b: Account) -> bool:
    """Whether two accounts may be one."""
    off = np.abs(a.mean - b.mean)
    return (
        a.rests == b.rests
        and a.knows == b.knows
        and off[1] ** 2 < min(a.cov[1, 1], b.cov[1, 1])
        and off[0] ** 2 < 1e-4 + min(a.cov[0, 0], b.cov[0, 0])
    )


@dataclass
class Reading:
    """What is known after some blocks."""

    p: RestlevelParams
    accounts: list[Account]
    noise: float = -1.0
    before: float = -1.0
    density: float = -1.0
    quiet: int = 0
    is_measured: bool = False
    flicker: float = 0.0
    plateau: list[float] = field(default_factory=list)
    level: float = 0.0
    last: float = 0.0
    at_start: bool = False
    left: int = 10**9
    left_level: float = 0.0
    is_gentle: bool = False
    was_long: bool = False

    def is_quiet(self, b: Block) -> bool:
        """And the noise follows."""
        variance = max(b.variance, 0.25 * b.resolution_dps**2, 1e-12)
        error = np.sqrt(2.0 / b.samples)
        if self.noise < 0.0:
            self.noise = variance
        limit = 1.0 + self.p.quiet * error * np.sqrt(1.0 + 1.0 / max(self.quiet, 1))
        if max(variance, self.before) < self.noise * np.exp(-4.5 * error):
            self.noise = max(variance, self.before)
        elif variance < self.noise * limit:
            self.quiet = min(self.quiet + 1, 20)
            if self.quiet == 20:
                self.noise *= (variance / self.noise) ** 0.05
            else:
                self.noise += (variance - self.noise) / self.quiet
        else:
            self.noise *= 1.0 + 0.001 * b.seconds
        self.before = variance
        if not self.is_measured:
            self.density = 2.0 * self.noise * b.seconds / b.samples
        return bool(variance < self.noise * limit)

    def follow(self, b: Block, mean_dps: float, *, is_first: bool) -> None:
        """The plateau grows, begins or ends."""
        was, level_was, is_quiet = len(self.plateau), self.level, self.is_quiet(b)
        var, drift = self.density / b.seconds, self.p.drift_dps_s * b.seconds
        spread = np.sqrt(var * (1.0 + 1.0 / max(1, min(was, 10))) + drift**2 + self.flicker)
        if not is_quiet:
            self.plateau = []
        elif not self.plateau or abs(mean_dps - self.level) >= 4.0 * spread:
            self.plateau, self.level, self.at_start = [mean_dps], mean_dps, is_first
        else:
            self.plateau.append(mean_dps)
            a = self.plateau
            if len(a) == 5 and abs(0.5 * (a[4] + a[3] - a[1] - a[0])) >= 2.0 * np.sqrt(var + 4.0 * drift**2):
                self.plateau = []
        self.left += 1
        if was >= 5 > len(self.plateau):
            self.left, self.left_level, self.was_long = 1, level_was, was * b.seconds >= 15.0
            self.is_gentle = is_quiet and abs(mean_dps - self.last) < 0.4 * b.seconds
            for h in self.accounts:
                h.weight *= 0.002 if self.is_gentle and h.rests and h.is_news else 1.0
            self.normalise()

    def pass_through(self, b: Block) -> None:
        """Every account, by one block."""
        if self.left == 1:
            self.accounts = [replace(h, rests=False, rested=h.rests) for h in self.accounts]
        if len(self.plateau) == 1:
            self.accounts = [replace(h, entry=(h.mean[0], h.cov.copy(), h.moved_s)) for h in self.accounts]
        turns = np.array([[1.0, -b.seconds], [0.0, 1.0]])
        for h in self.accounts:
            if not h.rests:
                h.mean = turns @ h.mean + np.array([b.turned_deg, 0.0])
                h.cov = turns @ h.cov @ turns.T + np.diag([self.density * b.seconds, 0.0])
                h.moved_s += b.seconds
            h.cov = h.cov + np.diag([0.0, self.p.walk_dps_rts**2 * b.seconds])

    def normalise(self) -> None:
        """Probabilities add up to 1."""
        total = sum(h.weight for h in self.accounts)
        for h in self.accounts:
            h.weight /= total

    def rest_on(self, b: Block, mean_dps: float) -> None:
        """Accounts of rest learn."""
        var, drift = self.density / b.seconds, self.p.drift_dps_s * b.seconds
        resting = sum(h.weight for h in self.accounts if h.rests)
        resters = [h for h in self.accounts if h.rests]
        beyond = [(mean_dps - h.mean[1]) ** 2 - h.cov[1, 1] - var - self.flicker for h in resters]
        pull = sum(h.weight * min(b, 4.0 * (var + self.flicker)) for h, b in zip(resters, beyond, strict=True))
        self.flicker = max(0.0, self.flicker + 0.002 * pull)
        for k, h in enumerate(self.accounts):
            if h.rests:
                is_news = h.is_news and len(self.plateau) * b.seconds < 8.0
                self.accounts[k], _ = told(replace(h, is_news=is_news), mean_dps, var, drift**2)
        self.is_measured = self.is_measured or resting > 0.5
        found = min(0.5 * (mean_dps - self.last) ** 2 * b.seconds, 9.0 * self.density)
        self.density += 0.05 * resting * (found - self.density)

    def confirm(self, b: Block) -> None:
        """The plateau is one: it is the one before, or every account has two sequels."""
        var = self.density / (5.0 * b.seconds)
        spread = np.sqrt(
            self.density / b.seconds * 0.3 + (self.p.drift_dps_s * b.seconds * self.left) ** 2 + self.flicker
        )
        if self.left <= 15 and abs(self.level - self.left_level) < (6.0 if self.was_long else 4.0) * spread:
            self.accounts = [
                replace(first_told(entered(h), self.level, var, self.p)[0], rests=True, is_news=h.is_news)
                if h.rested
                else h
                for h in self.accounts
            ]
            for h in self.accounts:
                h.weight /= 0.002 if self.is_gentle and h.rests and h.is_news else 1.0
            self.normalise()
            return
        share = self.p.still_start if self.at_start else self.p.rest_share
        odds = share / (1.0 - share) / 0.03
        everyone = list(self.accounts)
        for h in self.accounts:
            back = replace(entered(h), rested=False)
            found, likely = first_told(back, self.level, var, self.p)
            place = min(set(range(12)) - {other.place for other in everyone})
            everyone.append(replace(found, rests=True, place=place, weight=h.weight * odds * np.exp(likely)))
        self.accounts = tidied(sorted(everyone, key=lambda h: h.place))


def reference(t_s: Floats, rate_dps: Floats, p: RestlevelParams) -> dict[str, Floats]:
    """Yaw, bias and their standard deviations at the end of each block; `end` has the samples."""
    reading = Reading(p, [Account(0, 1.0, np.zeros(2), np.diag([0.0, p.turn_on_dps**2]))])
    rows = []
    for number, b in enumerate(blocks_of(t_s, rate_dps, p.window_s)):
        mean_dps = b.turned_deg / b.seconds
        reading.follow(b, mean_dps, is_first=number < 10)
        reading.pass_through(b)
        if len(reading.plateau) > 5:
            reading.rest_on(b, mean_dps)
        if len(reading.plateau) > 1:
            reading.level += (mean_dps - reading.level) / min(len(reading.plateau), 10)
        if len(reading.plateau) == 5:
            reading.confirm(b)
        reading.last = mean_dps
        rows.append((b.end, *summary(reading.accounts)))
    columns = zip(*rows, strict=True)
    return {
        name: np.array(column) for name, column in zip(("end", "yaw", "bias", "yaw_var", "sigma"), columns, strict=True)
    }


def entered(h: Account) -> Account:
    """The account with yaw and its certainty as they were where the plateau began."""
    yaw, cov, moved_s = h.entry
    cov = np.array([[cov[0, 0], cov[0, 1]], [cov[1, 0], h.cov[1, 1]]])
    return replace(h, mean=np.array([yaw, h.mean[1]]), cov=cov, moved_s=moved_s)


def tidied(accounts: list[Account]) -> list[Account]:
    """Join what is the same, keep the six that are believed most."""
    total = sum(h.weight for h in accounts)
    left = [replace(h, weight=h.weight / total) for h in accounts if h.weight > 0.0]
    k = 0
    while k < len(left):
        j = k + 1
        while j < len(left):
            if same(left[k], left[j]):
                a, b = left[k], left.pop(j)
                weight = a.weight + b.weight
                shares = np.array([a.weight, b.weight]) / weight
                mean, cov = merged(shares, [a.mean, b.mean], [a.cov, b.cov])
                left[k] = replace(a, weight=weight, mean=mean, cov=cov, moved_s=min(a.moved_s, b.moved_s))
            else:
                j += 1
        k += 1
    left = [h for h in left if h.weight >= 1e-9]
    keep = sorted(left, key=lambda h: -h.weight)[:6]
    left = [h for h in left if any(h is one for one in keep)]
    total = sum(h.weight for h in left)
    return [replace(h, weight=h.weight / total) for h in left]


def summary(accounts: list[Account]) -> tuple[float, float, float, float]:
    """Yaw and bias as means by squared weight; their variances about that by weight."""
    weights = np.array([h.weight for h in accounts])
    means = np.array([h.mean for h in accounts])
    mean = weights**2 @ means / (weights**2).sum()
    cov = sum(w * (h.cov + np.outer(h.mean - mean, h.mean - mean)) for w, h in zip(weights, accounts, strict=True))
    return float(mean[0]), float(mean[1]), float(cov[0, 0]), float(np.sqrt(cov[1, 1]))
