"""The bias against temperature, of a sensor that says how warm it is: points from sure rests, and a line through them.

Assumed is that over some tens of degrees the bias follows its temperature on a line, with hysteresis of the size of the
fit, and that what is old has drifted as the bias walks. The contract, after the head of Android's `over_temp_cal.h`:

- a point comes from a sure rest, one every ten seconds of it; those of two degrees are one, newer ones count more;
- a line is fitted with weights by the variance and the age of the points, and far ones count less (Huber);
- it is accepted with five points over five degrees or more, a scatter of 0.05 deg/s and a slope of 0.1 deg/s per °C at
  most; without it nothing is done;
- a rest that lies far from an accepted line is refused as an outlier, three in a row at most; with the fourth the
  points are of the past, and it begins anew;
- an accepted line moves the bias that is expected while the device moves, and what is remembered of it at a start.
"""

from math import floor, sqrt

from gyrodrift.filters.restlevel.bias_state import TempCurve
from gyrodrift.filters.restlevel.model import UNKNOWN_C, RestlevelCoefficients, RestlevelState
from gyrodrift.filters.restlevel.recall import note_sure_rest

POINT_S = 10.0
COLDEST_BIN_C, BIN_C = -40.0, 2.0

NEWEST_SHARE = 0.2
"""The least share that a new value has in its point."""

POINT_VAR = 0.005**2
STALE_S = 90.0 * 86_400.0
"""What a point is uncertain by at least, (deg/s)², and when it is forgotten."""

LEAST_POINTS, LEAST_SPAN_C = 5, 5.0
MOST_FIT_DPS, MOST_SLOPE_DPS_C = 0.05, 0.1
HUBER_SIGMAS, HUBER_ROUNDS = 1.5, 5

OUTLIER_SIGMAS = 4.0
START_VAR_SHARE = 0.01
"""What a new start may move the whole curve by: a share of the variance of the turn-on bias."""

MOST_REFUSED = 3
SMOOTH_S = 3.0
"""Thermometers are noisy: over so long their reading is averaged."""

SLOPE_DOUBT = 0.3
"""By so much, relative, the slope may be another in the place where the sensor is."""


def follow_temperature(s: RestlevelState, seconds: float) -> None:
    """A block has ended: the bias of hypotheses that are in motion goes along the line with the temperature."""
    curve = s.curve
    if s.temp_c == UNKNOWN_C:
        return
    before_c = s.temp_c if curve.temp_c == UNKNOWN_C else curve.temp_c
    curve.temp_c = before_c + (s.temp_c - before_c) * min(1.0, seconds / SMOOTH_S)
    if not curve.is_accepted:
        return
    moved_dps = curve.slope_dps_c * (curve.temp_c - before_c)
    for h in s.hypotheses:
        if h.weight > 0.0 and h.knows_bias and not h.is_at_rest:
            h.bias_dps += moved_dps
            h.bias_var += SLOPE_DOUBT * SLOPE_DOUBT * moved_dps * moved_dps


def learn_when_sure(c: RestlevelCoefficients, s: RestlevelState, seconds: float, is_certain: bool) -> None:  # noqa: FBT001 - compiled code takes none by name
    """A block has ended: every ten seconds of a sure rest give a point; `is_certain`: by a witness."""
    if note_sure_rest(s, seconds, is_certain):
        _learn(c, s, seconds)


def _learn(c: RestlevelCoefficients, s: RestlevelState, seconds: float) -> None:
    curve, sure = s.curve, s.sure
    place = floor((curve.temp_c - COLDEST_BIN_C) / BIN_C)
    if curve.temp_c == UNKNOWN_C or not 0 <= place < len(curve.points):
        return
    if floor(sure.seconds / POINT_S) == floor((sure.seconds - seconds) / POINT_S):
        return
    if sure.rests != curve.rests:
        curve.rests = sure.rests
        _judge_rest(c, s)
    if curve.is_refusing:
        return
    point = curve.points[place]
    point.count += 1
    share = max(NEWEST_SHARE, 1.0 / point.count)
    away_dps = s.bias_dps - point.bias_dps
    point.bias_dps += share * away_dps
    point.temp_c += share * (curve.temp_c - point.temp_c)
    spread_var = share * (1.0 - share) * away_dps * away_dps
    point.bias_var = (1.0 - share) * point.bias_var + share * (s.moments.bias_var + POINT_VAR) + spread_var
    point.t_s = s.lived_s
    fit_line(curve, c.rate_walk_var, s.lived_s)


def line_dps(curve: TempCurve, temp_c: float) -> float:
    """The bias on the line, deg/s."""
    return curve.level_dps + curve.slope_dps_c * (temp_c - curve.middle_c)


def _judge_rest(c: RestlevelCoefficients, s: RestlevelState) -> None:
    """A sure rest has begun, which may be an outlier."""
    curve = s.curve
    curve.is_refusing = False
    if not curve.is_accepted:
        return
    away_dps = s.bias_dps - line_dps(curve, curve.temp_c)
    expected_var = curve.fit_var + s.moments.bias_var + POINT_VAR + START_VAR_SHARE * c.turn_on_var
    if away_dps * away_dps < OUTLIER_SIGMAS * OUTLIER_SIGMAS * expected_var:
        curve.refused = 0
    elif curve.refused < MOST_REFUSED:
        curve.refused += 1
        curve.is_refusing = True
    else:
        curve.refused = 0
        curve.is_accepted = False
        for point in curve.points:
            point.count = 0
            point.temp_c = point.bias_dps = point.bias_var = 0.0


def fit_line(curve: TempCurve, rate_walk_var: float, t_s: float) -> None:
    """Fit the line and judge it; `t_s` is now, `rate_walk_var` what age adds to the variance of a point per s."""
    least_c, most_c, known = 1000.0, UNKNOWN_C, 0
    for point in curve.points:
        if point.count > 0 and t_s - point.t_s < STALE_S:
            known += 1
            least_c, most_c = min(least_c, point.temp_c), max(most_c, point.temp_c)
        else:
            point.count = 0
    curve.is_accepted = False
    curve.known, curve.least_c, curve.most_c = known, least_c, most_c
    if known < LEAST_POINTS or most_c - least_c < LEAST_SPAN_C:
        return
    clip_dps = 1e9
    for _ in range(HUBER_ROUNDS):
        _fit_once(curve, rate_walk_var, t_s, clip_dps)
        clip_dps = HUBER_SIGMAS * sqrt(curve.fit_var) + 1e-9
    is_gentle = abs(curve.slope_dps_c) < MOST_SLOPE_DPS_C
    curve.is_accepted = is_gentle and curve.fit_var < MOST_FIT_DPS * MOST_FIT_DPS


def _fit_once(curve: TempCurve, rate_walk_var: float, t_s: float, clip_dps: float) -> None:
    """Weighted least squares, in which what lies further than `clip_dps` from the line so far counts less."""
    total = sum_c = sum_dps = 0.0
    for point in curve.points:
        if point.count > 0:
            off_dps = abs(point.bias_dps - line_dps(curve, point.temp_c))
            point.weight = min(1.0, clip_dps / (off_dps + 1e-12)) / (point.bias_var + rate_walk_var * (t_s - point.t_s))
            total += point.weight
            sum_c += point.weight * point.temp_c
            sum_dps += point.weight * point.bias_dps
    middle_c, level_dps = sum_c / total, sum_dps / total
    sum_cc = sum_cd = 0.0
    for point in curve.points:
        if point.count > 0:
            away_c = point.temp_c - middle_c
            sum_cc += point.weight * away_c * away_c
            sum_cd += point.weight * away_c * (point.bias_dps - level_dps)
    curve.middle_c, curve.level_dps, curve.slope_dps_c = middle_c, level_dps, sum_cd / sum_cc
    squares = 0.0
    for point in curve.points:
        if point.count > 0:
            off_dps = point.bias_dps - line_dps(curve, point.temp_c)
            squares += off_dps * off_dps
    curve.fit_var = squares / curve.known
