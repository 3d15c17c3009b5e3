"""Rate errors of sessions: against the quantities that they may depend on, over time, and as spectra."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from gyrodrift.diagnose.features.block_means import block_means
from gyrodrift.diagnose.features.motion_terms import TURN_DPS
from gyrodrift.diagnose.features.regimes import SLOW_DPS
from gyrodrift.diagnose.inference.verdict import NamedCause
from gyrodrift.diagnose.predictive_checks.binned_medians import Medians, medians, trend_rms_dps
from gyrodrift.diagnose.predictive_checks.residual_series import (
    ResidualSeries,
    Spectra,
    minutes_of,
    pooled,
    residual_series_of,
)
from gyrodrift.diagnose.simulate.twin import Subject
from gyrodrift.values.arrays import Floats, Mask

SLACK_S = 1e-4
"""Error of the time of a motion that is rebuilt from an encoder. Times an acceleration it is an error of the rate.
Chosen: a hundredth of a sample period at 100 Hz."""


class ResidualRegressor(NamedTuple):
    """A quantity that the rate error may depend on.

    of
        Function from a session to the (seconds,) values of the quantity; NaN in seconds without a value.
    slack
        Residual that an error of the rebuilt motion may leave, deg/s for each unit of the quantity.
    """

    name: str
    unit: str
    of: Callable[[Subject], Floats]
    slack: float = 0.0


def _acceleration(subject: Subject) -> Floats:
    """(samples,) acceleration, deg/s²."""
    return np.gradient(subject.design.regimes.speed_dps, subject.design.period_s)


def _angle(subject: Subject) -> Floats:
    """(seconds,) angle of the encoder within the turn, deg."""
    design = subject.design
    angle_deg: Floats = np.mod(design.motion.angle_deg[design.block // 2 :: design.block], 360.0)
    return angle_deg[: len(design.regimes.block_rate_dps)]


def _temperature(subject: Subject) -> Floats:
    """(seconds,) temperature of the sensor, °C; NaN if it was not recorded."""
    if subject.cleaned.recording.temp_c is None:
        return np.full(len(subject.design.regimes.block_rate_dps), np.nan)
    return block_means(subject.design.motion.sensor_c, subject.design.block)


def _rest(subject: Subject) -> Floats:
    """(seconds,) time since the last motion, s; NaN in motion and before the first motion."""
    last, is_defined = _last(subject, np.abs(subject.design.regimes.block_rate_dps) > SLOW_DPS)
    block_s = subject.design.block * subject.design.period_s
    return np.where(is_defined, (np.arange(len(last)) - last) * block_s, np.nan)


def _direction(subject: Subject) -> Floats:
    """(seconds,) direction of the last turn, 1 or −1; NaN in motion and before the first turn."""
    rate_dps = subject.design.regimes.block_rate_dps
    last, is_defined = _last(subject, np.abs(rate_dps) > TURN_DPS)
    return np.where(is_defined, np.sign(rate_dps[last]), np.nan)


def _last(subject: Subject, is_moving: Mask) -> tuple[Floats, Mask]:
    """(seconds,) index of the last second in motion, and whether the device rests after such a second."""
    last = np.maximum.accumulate(np.where(is_moving, np.arange(len(is_moving)), -1))
    return last, subject.design.regimes.block_at_rest & (last >= 0)


REGRESSORS = (
    ResidualRegressor("rate", "deg/s", lambda subject: subject.design.regimes.block_rate_dps),
    ResidualRegressor(
        "acceleration",
        "deg/s²",
        lambda subject: block_means(_acceleration(subject), subject.design.block),
        SLACK_S,
    ),
    ResidualRegressor(
        "acceleration, either way",
        "deg/s²",
        lambda subject: block_means(np.abs(_acceleration(subject)), subject.design.block),
        SLACK_S,
    ),
    ResidualRegressor("angle within the turn", "deg", _angle),
    ResidualRegressor("temperature", "°C", _temperature),
    ResidualRegressor("time since the session began", "min", minutes_of),
    ResidualRegressor("time since it last moved, at rest", "s", _rest),
    ResidualRegressor("direction it came from, at rest", "−1 clockwise, 1 counter-clockwise", _direction),
)
"""Quantities that the report draws the rate error against. The names are titles of figures."""

LEAST_SECONDS = 20
"""Least number of seconds with a value for a figure. Chosen: four bins of the least number of points."""


@dataclass(frozen=True, slots=True, eq=False)
class Dependence:
    """Rate errors of all drawn sessions against a regressor, in the seconds in which it has a value.

    slack
        Residual that an error of the rebuilt motion may leave, deg/s for each unit of the regressor.
    x
        (seconds,) the regressor, rising.
    real_dps, unexplained_dps
        (seconds,) rate errors of the recordings, and their part that the causes do not explain.
    real, before, after, unexplained
        Medians in bins: of the recordings, of the simulator without and with the causes, and of the unexplained part.
    trend_before_dps, trend_dps
        RMS of the part of the residual that follows the regressor, without and with the causes.
    """

    name: str
    unit: str
    slack: float
    x: Floats
    real_dps: Floats
    unexplained_dps: Floats
    real: Medians
    before: Medians
    after: Medians
    unexplained: Medians
    trend_before_dps: float
    trend_dps: float


def dependences_of(sessions: Sequence[ResidualSeries], subjects: Sequence[Subject]) -> tuple[Dependence, ...]:
    """Dependence on each regressor that has more than one value in some sessions.

    subjects
        The same sessions, from which the regressors are computed.
    """
    dependences = []
    for regressor in REGRESSORS:
        x = np.concatenate([regressor.of(subject) for subject in subjects])
        order = np.argsort(x, kind="stable")[: int(np.count_nonzero(np.isfinite(x)))]  # NaN come last
        if len(order) >= LEAST_SECONDS and x[order[-1]] > x[order[0]]:
            dependences.append(
                _dependence(regressor, x[order], [np.concatenate(column)[order] for column in _columns(sessions)])
            )
    return tuple(dependences)


def _columns(sessions: Sequence[ResidualSeries]) -> list[list[Floats]]:
    """Rate errors of all sessions in four columns: real, before, after, unexplained."""
    rows = [(series.real_dps, series.before_dps, series.after_dps, series.unexplained_dps) for series in sessions]
    return [list(column) for column in zip(*rows, strict=True)]


def _dependence(regressor: ResidualRegressor, x: Floats, columns: Sequence[Floats]) -> Dependence:
    real_dps, before_dps, after_dps, unexplained_dps = columns
    return Dependence(
        name=regressor.name,
        unit=regressor.unit,
        slack=regressor.slack,
        x=x,
        real_dps=real_dps,
        unexplained_dps=unexplained_dps,
        real=medians(x, real_dps),
        before=medians(x, before_dps),
        after=medians(x, after_dps),
        unexplained=medians(x, unexplained_dps),
        trend_before_dps=trend_rms_dps(x, real_dps - before_dps),
        trend_dps=trend_rms_dps(x, unexplained_dps),
    )


MAX_SESSIONS = 6
"""Most sessions that a report draws. Chosen: more would only make the page longer."""


@dataclass(frozen=True, slots=True, eq=False)
class ResidualChecks:
    """Rate errors of some sessions, recorded and simulated.

    spectra
        Spectra over all these sessions below and above half a hertz; an empty spectrum is left out.
    """

    sessions: tuple[ResidualSeries, ...]
    dependences: tuple[Dependence, ...]
    spectra: tuple[Spectra, ...]


def residual_checks_of(subjects: Sequence[Subject], causes: tuple[NamedCause, ...]) -> ResidualChecks:
    """Rate errors of at most MAX_SESSIONS sessions, evenly chosen."""
    count = min(len(subjects), MAX_SESSIONS)
    chosen = np.unique(np.linspace(0, len(subjects) - 1, count).round().astype(int)).tolist()
    sessions = tuple(residual_series_of(subjects[index], causes, index + 1) for index in chosen)
    slow, quick = pooled([series.slow for series in sessions]), pooled([series.quick for series in sessions])
    return ResidualChecks(
        sessions=sessions,
        dependences=dependences_of(sessions, [subjects[index] for index in chosen]),
        spectra=tuple(spectra for spectra in (slow, quick) if len(spectra.hz)),
    )
