"""Bias against temperature as a straight line, for a sensor that sends its temperature. Sure rests measure the line.

A Kalman filter has the level and the slope as its state. The slope of a new sensor is 0 with the standard deviation of
common parts. So the uncertainty of the bias grows with the distance from the temperature of the last rest. Every ten
seconds of a sure rest measure the level. Between the measurements, hysteresis adds a variance with the temperature, and
the random walk of the bias adds a variance with time. A jump of the bias hardly changes the slope.
"""

from math import floor

from gyrodrift.filters.restlevel.bias_state import SureRest, TempLine
from gyrodrift.filters.restlevel.model import UNKNOWN_C, RestlevelCoefficients, RestlevelState
from gyrodrift.filters.restlevel.recall import note_sure_rest

HYSTERESIS_VAR_C, LOOP_VAR_C = 0.015**2, 0.03**2
"""Variance of the bias about the line per °C of change, (deg/s)²/°C: within a minute, and within ten. Measured: a real
temperature sweep."""

POINT_S = 10.0
"""Time of a sure rest between two measurements of the level, s. Chosen."""

SMOOTH_S = 3.0
"""Averaging time of the temperature, s. Chosen: thermometers are noisy."""

JUMP_SIGMAS = 3.0
"""Distance from the line, in sigmas, beyond which the bias has jumped. Chosen."""


def follow_temperature(s: RestlevelState, seconds: float) -> None:
    """Move the bias of hypotheses in motion along the line; `seconds` is the length of the block, s."""
    if s.temp_c == UNKNOWN_C:
        return
    step_dps, more_var = follow_line(s.line, s.temp_c, s.rest_probability, seconds)
    for h in s.hypotheses:
        if h.weight > 0.0 and h.knows_bias and not h.is_at_rest:
            h.bias_dps += step_dps
            h.bias_var += more_var


def follow_line(line: TempLine, temp_c: float, rest_probability: float, seconds: float) -> tuple[float, float]:
    """Follow the temperature over a block.

    Parameters
    ----------
    line
        Bias against temperature, which is changed.
    temp_c
        Temperature at the end of the block, °C.
    rest_probability, seconds
        Probability of rest at its beginning, and its length, s.

    Returns
    -------
    tuple of float
        Change of a bias in motion, deg/s, and the variance that it gains, (deg/s)².
    """
    before_c = temp_c if line.temp_c == UNKNOWN_C else line.temp_c
    line.temp_c = before_c + (temp_c - before_c) * min(1.0, seconds / SMOOTH_S)
    if rest_probability > 0.5 or line.rest_c == UNKNOWN_C:
        line.rest_c = before_c
    step_c, away_c, was_away_c = line.temp_c - before_c, line.temp_c - line.rest_c, before_c - line.rest_c
    more_var = line.slope_var * max(0.0, away_c * away_c - was_away_c * was_away_c) + HYSTERESIS_VAR_C * abs(step_c)
    return line.slope_dps_c * step_c, more_var


def learn_when_sure(c: RestlevelCoefficients, s: RestlevelState, seconds: float, is_certain: bool) -> None:  # noqa: FBT001 - compiled code takes none by name
    """Learn from a sure rest; `is_certain` states that a rest sensor confirms the rest."""
    bias_var, sure = s.moments.bias_var, s.sure
    if note_sure_rest(sure, s.rest_probability, s.bias_dps, bias_var, s.temp_c, s.lived_s, seconds, is_certain):
        sure.period_s = seconds / s.block.samples
        learn_level(s.line, sure, seconds, c.rate_walk_var)


def learn_level(line: TempLine, sure: SureRest, seconds: float, rate_walk_var: float) -> None:
    """Measure the level every ten seconds of a sure rest; `seconds` is the length of its last block, s."""
    if line.temp_c == UNKNOWN_C:
        return
    if floor(sure.seconds / POINT_S) > floor((sure.seconds - seconds) / POINT_S):
        measure_level(line, sure.bias_dps, sure.bias_var, sure.t_s, rate_walk_var)


def measure_level(line: TempLine, bias_dps: float, bias_var: float, t_s: float, rate_walk_var: float) -> None:
    """Update level and slope by the bias of a sure rest.

    Parameters
    ----------
    line
        Bias against temperature, which is changed.
    bias_dps, bias_var
        Bias and its variance, deg/s and (deg/s)².
    t_s
        Time, s.
    rate_walk_var
        Growth of the variance of the bias by its random walk, (deg/s)² per s.
    """
    line.points += 1
    if line.points == 1:
        line.level_dps, line.level_var, line.covariance = bias_dps, bias_var, 0.0
    else:
        _predict(line, line.temp_c - line.level_c, rate_walk_var * (t_s - line.level_s))
        _update(line, bias_dps - line.level_dps, bias_var)
    line.level_c, line.level_s = line.temp_c, t_s


def _predict(line: TempLine, step_c: float, walk_var: float) -> None:
    """Predict the level after a change of temperature, °C, and a random walk with a variance, (deg/s)²."""
    line.level_dps += line.slope_dps_c * step_c
    line.level_var += step_c * (2.0 * line.covariance + step_c * line.slope_var)
    line.level_var += HYSTERESIS_VAR_C * abs(step_c) + walk_var
    line.covariance += step_c * line.slope_var


def _update(line: TempLine, innovation_dps: float, bias_var: float) -> None:
    """Update level and slope by a measured level; after a jump, the level is uncertain by the innovation."""
    square = innovation_dps * innovation_dps
    if square > JUMP_SIGMAS * JUMP_SIGMAS * (line.level_var + bias_var):
        line.level_var += square
    gain = line.level_var / (line.level_var + bias_var)
    slope_gain = line.covariance / (line.level_var + bias_var)
    line.level_dps += gain * innovation_dps
    line.slope_dps_c += slope_gain * innovation_dps
    line.slope_var -= slope_gain * line.covariance
    line.level_var *= 1.0 - gain
    line.covariance *= 1.0 - gain
