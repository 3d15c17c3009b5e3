"""Rate errors of sessions, second by second: against all that they may depend on, over time and as spectra."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from gyrodrift.arrays import Floats, Mask
from gyrodrift.diagnose.features.block_means import block_means
from gyrodrift.diagnose.features.motion_terms import TURN_DPS
from gyrodrift.diagnose.features.regimes import SLOW_DPS
from gyrodrift.diagnose.inference.verdict import NamedCause
from gyrodrift.diagnose.predictive_checks.binned_medians import Medians, medians, shape_dps
from gyrodrift.diagnose.predictive_checks.residual_series import (
    ResidualSeries,
    Spectra,
    minutes_of,
    pooled,
    residual_series_of,
)
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


def _acceleration(subject: Subject) -> Floats:
    """Acceleration at each sample, deg/s/s."""
    return np.gradient(subject.design.regimes.speed_dps, subject.design.period_s)


def _angle(subject: Subject) -> Floats:
    design = subject.design
    angle_deg: Floats = np.mod(design.motion.angle_deg[design.block // 2 :: design.block], 360.0)
    return angle_deg[: len(design.regimes.block_rate_dps)]


def _temperature(subject: Subject) -> Floats:
    if subject.cleaned.recording.temp_c is None:
        return np.full(len(subject.design.regimes.block_rate_dps), np.nan)
    return block_means(subject.design.motion.sensor_c, subject.design.block)


def _rest(subject: Subject) -> Floats:
    last, known = _last(subject, np.abs(subject.design.regimes.block_rate_dps) > SLOW_DPS)
    return np.where(known, (np.arange(len(last)) - last) * (subject.design.block * subject.design.period_s), np.nan)


def _direction(subject: Subject) -> Floats:
    rate_dps = subject.design.regimes.block_rate_dps
    last, known = _last(subject, np.abs(rate_dps) > TURN_DPS)
    return np.where(known, np.sign(rate_dps[last]), np.nan)


def _last(subject: Subject, is_such: Mask) -> tuple[Floats, Mask]:
    """Of each second, which before it was such; and whether there was one, and it rests."""
    last = np.maximum.accumulate(np.where(is_such, np.arange(len(is_such)), -1))
    return last, subject.design.regimes.block_at_rest & (last >= 0)


REGRESSORS = (
    ResidualRegressor("rate", "deg/s", lambda one: one.design.regimes.block_rate_dps),
    ResidualRegressor("acceleration", "deg/s²", lambda one: block_means(_acceleration(one), one.design.block), SLACK_S),
    ResidualRegressor(
        "acceleration, either way",
        "deg/s²",
        lambda one: block_means(np.abs(_acceleration(one)), one.design.block),
        SLACK_S,
    ),
    ResidualRegressor("angle within the turn", "deg", _angle),
    ResidualRegressor("temperature", "°C", _temperature),
    ResidualRegressor("time since the session began", "min", minutes_of),
    ResidualRegressor("time since it last moved, at rest", "s", _rest),
    ResidualRegressor("direction it came from, at rest", "−1 clockwise, 1 counter-clockwise", _direction),
)


LEAST_SECONDS = 20


@dataclass(frozen=True, slots=True, eq=False)
class Dependence:
    """Rate errors against one regressor, in the seconds of all drawn sessions in which it is known, in order of x.

    slack
        What the comparison itself may leave, deg/s for each unit: motion is not known to the microsecond.
    x, real_dps, left_dps
        (seconds,) the regressor, the recordings' rate errors, and what the certain causes leave unexplained of them.
    real, before, after, left
        Binned medians of these, and of the simulator without the causes and with them.
    follows_before_dps, follows_dps
        RMS of the part of what is unexplained that follows the regressor, without and with the causes.
    """

    name: str
    unit: str
    slack: float
    x: Floats
    real_dps: Floats
    left_dps: Floats
    real: Medians
    before: Medians
    after: Medians
    left: Medians
    follows_before_dps: float
    follows_dps: float


def dependences_of(sessions: Sequence[ResidualSeries], subjects: Sequence[Subject]) -> tuple[Dependence, ...]:
    """On every regressor that takes more than one value in these sessions, whose subjects are given as well."""
    found = []
    for regressor in REGRESSORS:
        x = np.concatenate([regressor.of(subject) for subject in subjects])
        order = np.argsort(x, kind="stable")[: int(np.count_nonzero(np.isfinite(x)))]  # NaN come last
        if len(order) >= LEAST_SECONDS and x[order[-1]] > x[order[0]]:
            found.append(
                _dependence(regressor, x[order], [np.concatenate(column)[order] for column in _columns(sessions)])
            )
    return tuple(found)


def _columns(sessions: Sequence[ResidualSeries]) -> list[list[Floats]]:
    """Of all sessions: real, before, after, left."""
    rows = [(one.real_dps, one.before_dps, one.after_dps, one.left_dps) for one in sessions]
    return [list(column) for column in zip(*rows, strict=True)]


def _dependence(regressor: ResidualRegressor, x: Floats, columns: Sequence[Floats]) -> Dependence:
    real_dps, before_dps, after_dps, left_dps = columns
    return Dependence(
        name=regressor.name,
        unit=regressor.unit,
        slack=regressor.slack,
        x=x,
        real_dps=real_dps,
        left_dps=left_dps,
        real=medians(x, real_dps),
        before=medians(x, before_dps),
        after=medians(x, after_dps),
        left=medians(x, left_dps),
        follows_before_dps=shape_dps(x, real_dps - before_dps),
        follows_dps=shape_dps(x, left_dps),
    )


MAX_SESSIONS = 6
"""With more of them the page would be long and say no more."""


@dataclass(frozen=True, slots=True, eq=False)
class ResidualChecks:
    """Rate errors of some sessions, real and simulated.

    spectra
        Of all of them in one, below and above half a hertz, where there are any.
    """

    sessions: tuple[ResidualSeries, ...]
    dependences: tuple[Dependence, ...]
    spectra: tuple[Spectra, ...]


def residual_checks_of(subjects: Sequence[Subject], causes: tuple[NamedCause, ...]) -> ResidualChecks:
    """Of at most MAX_SESSIONS, evenly chosen."""
    count = min(len(subjects), MAX_SESSIONS)
    chosen = np.unique(np.linspace(0, len(subjects) - 1, count).round().astype(int)).tolist()
    sessions = tuple(residual_series_of(subjects[at], causes, at + 1) for at in chosen)
    both = pooled([one.slow for one in sessions]), pooled([one.quick for one in sessions])
    return ResidualChecks(
        sessions=sessions,
        dependences=dependences_of(sessions, [subjects[at] for at in chosen]),
        spectra=tuple(one for one in both if len(one.hz)),
    )
