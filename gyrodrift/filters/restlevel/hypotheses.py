"""What may have happened: accounts of which plateaus were rests, each with the yaw and the bias that follow from it.

A bias is a level that the rate comes back to; a spin is one that it does not. At every plateau each account splits
into one in which the device stood still and one in which it turned at a constant rate, and the levels that follow
decide between them. Within an account yaw and bias are a Kalman filter of two states: a level at rest is a measurement
of the bias, which takes back what a wrong bias has made of yaw since the rest before.
"""

from math import exp, log, pi, sqrt

from gyrodrift.filters.restlevel.blocks import CONFIRMED, RESUMED
from gyrodrift.filters.restlevel.model import MOST, Account, RestlevelCoefficients, RestlevelState

LEAST_WEIGHT = 1e-9

DRIFT_SHARE = 0.3
"""How often the bias has drifted fast since the rest before, rather than walked."""

DOUBT = 0.002
"""What is left of the probability of a short rest at a new level that was left gently: a curve, even for once."""

SHORT_S = 8.0
"""A rest of this length is no longer short."""

LONGEST_DRIFT_S = 20.0
"""A fast drift does not last longer than this."""

WIDE_SHARE = 0.03
WIDE_FACTOR = 16.0
"""Of parts whose bias at power-on is far out, and how much larger its variance is."""

DENSITY_GAIN = 0.05
SURPRISE = 9.0
"""A squared step between two blocks at rest counts up to this many times what is expected."""

FLICKER_GAIN = 0.002
FLICKER_SURPRISE = 4.0
"""The same for flicker, which is learned over minutes: in seconds the slide of a gentle curve looks like it."""


def begin(c: RestlevelCoefficients, s: RestlevelState) -> None:
    """The one account that there is before anything is known."""
    first = s.accounts[0]
    first.weight = 1.0
    first.yaw_deg = s.yaw_deg
    first.bias_var = c.turn_on_var
    summarise(s)


def enter_plateau(s: RestlevelState) -> None:
    """Keep what each account says now, where a plateau may begin."""
    for h in s.accounts:
        h.entry_yaw_deg = h.yaw_deg
        h.entry_covariance = h.covariance
        h.entry_yaw_var = h.yaw_var
        h.entry_moved_s = h.moved_s


def leave_plateau(s: RestlevelState) -> None:
    """Nothing stands still any more."""
    for h in s.accounts:
        if h.rests and _is_doubtful(s, h):
            h.weight *= DOUBT
        h.rested = h.rests
        h.rests = False
    _normalise(s)


def turn(c: RestlevelCoefficients, s: RestlevelState, turned_deg: float, seconds: float) -> None:
    """A block passes: yaw turns where the device is not at rest, and the bias may have walked."""
    for h in s.accounts:
        if h.weight == 0.0:
            continue
        if not h.rests:
            h.yaw_deg += turned_deg - h.bias_dps * seconds
            h.yaw_var += seconds * (h.bias_var * seconds - 2.0 * h.covariance + s.density_var)
            h.covariance -= h.bias_var * seconds
            h.moved_s += seconds
        h.bias_var += c.walk_var_per_s * seconds


def split(c: RestlevelCoefficients, s: RestlevelState, seconds: float) -> None:
    """A plateau is confirmed: each account goes on as one with a spin and as one with a rest.

    The rest begins where the plateau began; what was gained since is taken back.
    """
    level_dps, level_var = s.plateau_level_dps, s.density_var / (seconds * CONFIRMED)
    is_from_start = s.blocks < RESUMED + CONFIRMED  # it began within the first RESUMED
    odds_dps = c.start_odds_dps if is_from_start else c.rest_odds_dps
    free = 0
    for k in range(len(s.accounts)):
        h = s.accounts[k]
        if h.weight == 0.0 or h.rests:
            continue
        while s.accounts[free].weight > 0.0:
            free += 1
        rest = s.accounts[free]
        _go_back(h, rest)
        rest.bias_dps = h.bias_dps
        rest.bias_var = h.bias_var
        rest.knows_bias = h.knows_bias
        rest.rests, rest.rested = True, False
        rest.weight = h.weight * odds_dps * exp(_learn_first(c, rest, level_dps, level_var))
    _tidy(s)


def resume(c: RestlevelCoefficients, s: RestlevelState, seconds: float) -> None:
    """The plateau that ended a moment ago goes on: a block was out of line by chance, and that is no evidence."""
    for h in s.accounts:
        if h.weight > 0.0 and h.rested:
            was_news = h.is_news
            _go_back(h, h)
            _learn_first(c, h, s.plateau_level_dps, s.density_var / (seconds * CONFIRMED))
            h.rests, h.is_news = True, was_news
            if _is_doubtful(s, h):
                h.weight /= DOUBT
    _normalise(s)


def rest_on(c: RestlevelCoefficients, s: RestlevelState, level_dps: float, step_dps: float, seconds: float) -> None:
    """A confirmed plateau goes on: accounts of rest learn."""
    level_var = s.density_var / seconds
    drift_var = c.drift_dps_s * c.drift_dps_s * seconds * seconds
    resting = flicker_var = 0.0
    for h in s.accounts:
        if h.weight == 0.0 or not h.rests:
            continue
        resting += h.weight
        if s.plateau_blocks * seconds >= SHORT_S:
            h.is_news = False
        off_dps = level_dps - h.bias_dps
        beyond_var = off_dps * off_dps - h.bias_var - level_var - s.flicker_var
        flicker_var += h.weight * min(beyond_var, FLICKER_SURPRISE * (level_var + s.flicker_var))
        _learn(h, level_dps, level_var, drift_var)
        h.moved_s = 0.0
    s.flicker_var = max(0.0, s.flicker_var + FLICKER_GAIN * flicker_var)
    s.knows_density = s.knows_density or resting > 0.5
    found = min(0.5 * step_dps * step_dps * seconds, SURPRISE * s.density_var)
    s.density_var += DENSITY_GAIN * resting * (found - s.density_var)


def summarise(s: RestlevelState) -> None:
    """Take the accounts together: yaw and bias are their mean, in which doubtful ones count by their square."""
    total = yaw_deg = bias_dps = resting = top = 0.0
    for h in s.accounts:
        if h.weight == 0.0:
            continue
        share = h.weight * h.weight
        total += share
        yaw_deg += share * h.yaw_deg
        bias_dps += share * h.bias_dps
        top = max(top, h.weight)
        if h.rests:
            resting += h.weight
    yaw_deg /= total
    bias_dps /= total
    yaw_var = covariance = bias_var = 0.0
    for h in s.accounts:
        if h.weight == 0.0:
            continue
        off_deg, off_dps = h.yaw_deg - yaw_deg, h.bias_dps - bias_dps
        yaw_var += h.weight * (h.yaw_var + off_deg * off_deg)
        covariance += h.weight * (h.covariance + off_deg * off_dps)
        bias_var += h.weight * (h.bias_var + off_dps * off_dps)
    s.base_yaw_deg = yaw_deg
    s.base_yaw_var = yaw_var
    s.base_covariance = covariance
    s.base_bias_var = bias_var
    s.bias_dps = bias_dps
    s.bias_sigma_dps = sqrt(max(0.0, bias_var))
    s.confidence = top
    s.rest_probability = resting


def _is_doubtful(s: RestlevelState, h: Account) -> bool:
    """Whether the last plateau may have been a curve rather than a rest, for an account that takes it for a rest."""
    return h.is_news and s.left_gently


def _go_back(h: Account, to: Account) -> None:
    """Put yaw and its certainty into `to` as they were in `h` where the plateau began."""
    to.yaw_deg = h.entry_yaw_deg
    to.covariance = h.entry_covariance
    to.yaw_var = h.entry_yaw_var
    to.moved_s = h.entry_moved_s


def _learn_first(c: RestlevelCoefficients, h: Account, level_dps: float, level_var: float) -> float:
    """Learn from the first blocks of a rest; the logarithm of how probable their level was."""
    off_dps = level_dps - h.bias_dps
    h.is_news = not h.knows_bias or off_dps * off_dps > 9.0 * (h.bias_var + level_var)
    if h.knows_bias:
        drift_dps = c.drift_dps_s * min(h.moved_s, LONGEST_DRIFT_S)
        found = _learn(h, level_dps, level_var, drift_dps * drift_dps)
    else:
        usual = _log_density(level_dps, c.turn_on_var + level_var)
        wide = _log_density(level_dps, WIDE_FACTOR * c.turn_on_var + level_var)
        found = wide + log(WIDE_SHARE + (1.0 - WIDE_SHARE) * exp(min(usual - wide, 700.0)))
        far = level_dps * level_dps / (9.0 * h.bias_var)
        if far > 1.0:
            h.bias_var *= far
            h.covariance *= far
        _learn(h, level_dps, level_var, 0.0)
        h.knows_bias = True
    h.moved_s = 0.0
    return found


def _learn(h: Account, level_dps: float, level_var: float, drift_var: float) -> float:
    """Take a level for a measurement of the bias, which has walked, or else has drifted evenly since the last rest.

    Both are worked out and mixed by how well the level fits to them. Returned is the logarithm of its density.
    """
    half_s = 0.5 * h.moved_s
    off_dps = level_dps - h.bias_dps
    bias_var, covariance = h.bias_var + drift_var, h.covariance - drift_var * half_s
    yaw_var = h.yaw_var + drift_var * half_s * half_s
    walked, drifted = _log_density(off_dps, h.bias_var + level_var), _log_density(off_dps, bias_var + level_var)
    odds = exp(max(-700.0, min(walked - drifted, 700.0)))
    both = DRIFT_SHARE + (1.0 - DRIFT_SHARE) * odds
    share = DRIFT_SHARE / both
    a_gain, a_yaw_gain_s = _gains(h.bias_var, h.covariance, level_var)
    b_gain, b_yaw_gain_s = _gains(bias_var, covariance, level_var)
    a_bias_dps, a_yaw_deg = a_gain * off_dps, a_yaw_gain_s * off_dps
    b_bias_dps, b_yaw_deg = b_gain * off_dps, b_yaw_gain_s * off_dps
    a_bias_var, a_covariance = h.bias_var * (1.0 - a_gain), h.covariance * (1.0 - a_gain)
    b_bias_var, b_covariance = bias_var * (1.0 - b_gain), covariance * (1.0 - b_gain)
    a_yaw_var, b_yaw_var = h.yaw_var - a_yaw_gain_s * h.covariance, yaw_var - b_yaw_gain_s * covariance
    apart_dps, apart_deg = b_bias_dps - a_bias_dps, b_yaw_deg - a_yaw_deg
    h.bias_dps += a_bias_dps + share * apart_dps
    h.yaw_deg += a_yaw_deg + share * apart_deg
    mixed = share * (1.0 - share)
    h.bias_var = a_bias_var + share * (b_bias_var - a_bias_var) + mixed * apart_dps * apart_dps
    h.covariance = a_covariance + share * (b_covariance - a_covariance) + mixed * apart_dps * apart_deg
    h.yaw_var = a_yaw_var + share * (b_yaw_var - a_yaw_var) + mixed * apart_deg * apart_deg
    return drifted + log(both)


def _gains(bias_var: float, covariance: float, level_var: float) -> tuple[float, float]:
    """How much of an innovation goes to the bias, and how much of it, in s, to yaw."""
    return bias_var / (bias_var + level_var), covariance / (bias_var + level_var)


def _tidy(s: RestlevelState) -> None:
    """Join accounts that say the same, and forget those that are believed least."""
    _normalise(s)
    slots = len(s.accounts)
    for k in range(slots):
        for j in range(k + 1, slots):
            if _are_same(s.accounts[k], s.accounts[j]):
                _join(s.accounts[k], s.accounts[j])
    alive = 0
    for h in s.accounts:
        if h.weight < LEAST_WEIGHT:
            h.weight = 0.0
        if h.weight > 0.0:
            alive += 1
    while alive > MOST:
        least = -1
        for k in range(slots):
            weight = s.accounts[k].weight
            if weight > 0.0 and (least < 0 or weight < s.accounts[least].weight):
                least = k
        s.accounts[least].weight = 0.0
        alive -= 1
    _normalise(s)


def _are_same(h: Account, other: Account) -> bool:
    if h.weight == 0.0 or other.weight == 0.0 or h.rests != other.rests or h.knows_bias != other.knows_bias:
        return False
    off_dps, off_deg = h.bias_dps - other.bias_dps, h.yaw_deg - other.yaw_deg
    return off_dps * off_dps < min(h.bias_var, other.bias_var) and off_deg * off_deg < 1e-4 + min(
        h.yaw_var, other.yaw_var
    )


def _join(h: Account, other: Account) -> None:
    """Into the first: the Gaussian with the mean and the variances of both together."""
    share = other.weight / (h.weight + other.weight)
    off_dps, off_deg = other.bias_dps - h.bias_dps, other.yaw_deg - h.yaw_deg
    mixed = share * (1.0 - share)
    h.bias_var += share * (other.bias_var - h.bias_var) + mixed * off_dps * off_dps
    h.covariance += share * (other.covariance - h.covariance) + mixed * off_dps * off_deg
    h.yaw_var += share * (other.yaw_var - h.yaw_var) + mixed * off_deg * off_deg
    h.bias_dps += share * off_dps
    h.yaw_deg += share * off_deg
    h.moved_s = min(h.moved_s, other.moved_s)
    h.weight += other.weight
    other.weight = 0.0


def _normalise(s: RestlevelState) -> None:
    total = 0.0
    for h in s.accounts:
        total += h.weight
    for h in s.accounts:
        h.weight /= total


def _log_density(off: float, variance: float) -> float:
    """Of a normal distribution."""
    return -0.5 * (off * off / variance + log(2.0 * pi * variance))
