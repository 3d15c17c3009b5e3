"""What a rate error may depend on, second by second: motion, angle, temperature, time, rest, last direction."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from gyrodrift.arrays import Floats, Mask
from gyrodrift.diagnose.features.block_means import block_means
from gyrodrift.diagnose.features.motion_terms import TURN_DPS
from gyrodrift.diagnose.features.regimes import SLOW_DPS
from gyrodrift.diagnose.predictive_checks.residual_series import minutes_of
from gyrodrift.diagnose.simulate.twin import Subject

SLACK_S = 1e-4
"""A motion rebuilt from an encoder is not known better."""


class ResidualRegressor(NamedTuple):
    """What it is for each second of a session; NaN where a second does not have it.

    slack
        What the comparison itself may leave, deg/s for each unit: motion is not known to the microsecond.
    """

    name: str
    unit: str
    of: Callable[[Subject], Floats]
    slack: float = 0.0


def _rate(subject: Subject) -> Floats:
    return subject.design.regimes.block_rate_dps


def _acceleration(subject: Subject) -> Floats:
    return block_means(np.gradient(subject.design.regimes.speed_dps, subject.design.period_s), subject.design.block)


def _any_acceleration(subject: Subject) -> Floats:
    change = np.abs(np.gradient(subject.design.regimes.speed_dps, subject.design.period_s))
    return block_means(change, subject.design.block)


def _angle(subject: Subject) -> Floats:
    design = subject.design
    angle_deg: Floats = np.mod(design.motion.angle_deg[design.block // 2 :: design.block], 360.0)
    return angle_deg[: len(design.regimes.block_rate_dps)]


def _temperature(subject: Subject) -> Floats:
    if subject.seen.recording.temp_c is None:
        return np.full(len(subject.design.regimes.block_rate_dps), np.nan)
    return block_means(subject.design.motion.sensor_c, subject.design.block)


def _rest(subject: Subject) -> Floats:
    last, known = _last(subject, np.abs(subject.design.regimes.block_rate_dps) > SLOW_DPS)
    return np.where(known, (np.arange(len(last)) - last) * _second_s(subject), np.nan)


def _direction(subject: Subject) -> Floats:
    rate_dps = subject.design.regimes.block_rate_dps
    last, known = _last(subject, np.abs(rate_dps) > TURN_DPS)
    return np.where(known, np.sign(rate_dps[last]), np.nan)


def _last(subject: Subject, is_such: Mask) -> tuple[Floats, Mask]:
    """Of each second, which before it was such; and whether there was one, and it rests."""
    last = np.maximum.accumulate(np.where(is_such, np.arange(len(is_such)), -1))
    return last, subject.design.regimes.block_at_rest & (last >= 0)


def _second_s(subject: Subject) -> float:
    return subject.design.block * subject.design.period_s


REGRESSORS = (
    ResidualRegressor("rate", "deg/s", _rate),
    ResidualRegressor("acceleration", "deg/s²", _acceleration, SLACK_S),
    ResidualRegressor("acceleration, either way", "deg/s²", _any_acceleration, SLACK_S),
    ResidualRegressor("angle within the turn", "deg", _angle),
    ResidualRegressor("temperature", "°C", _temperature),
    ResidualRegressor("time since the session began", "min", minutes_of),
    ResidualRegressor("time since it last moved, at rest", "s", _rest),
    ResidualRegressor("direction it came from, at rest", "−1 clockwise, 1 counter-clockwise", _direction),
)
