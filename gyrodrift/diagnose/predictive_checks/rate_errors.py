"""Rate errors of sessions, recorded and simulated: second by second, by what they may depend on, and as spectra."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from gyrodrift.diagnose.features.block_means import block_means
from gyrodrift.diagnose.features.block_residuals import block_residual_dps
from gyrodrift.diagnose.features.motion_terms import TURN_DPS
from gyrodrift.diagnose.features.spectral_line import WINDOW, WINDOW_POWER, power_spectra, windows_within
from gyrodrift.diagnose.inference.verdict import NamedCause
from gyrodrift.diagnose.recording.outliers import Cleaned
from gyrodrift.diagnose.simulate.recalibration import recalibrated_with
from gyrodrift.diagnose.simulate.twin import Subject
from gyrodrift.values.arrays import Floats
from gyrodrift.values.constants import NORMAL_MAD

MAX_SESSIONS = 6
"""Most sessions that a report draws. Chosen: more would only make the page longer."""

LEAST, BINS = 5, 24
"""Least points in a bin, and bins. Chosen: enough bins to show a curve; the median of fewer points is chance."""

MEDIAN_ERROR = 1.2533
"""Standard error of a median of normal values, in that of their mean. Derived: √(π/2)."""


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


def _acceleration(subject: Subject) -> Floats:
    """(seconds,) acceleration, deg/s²."""
    design = subject.design
    return block_means(np.gradient(design.regimes.speed_dps, design.period_s), design.block)


def _direction(subject: Subject) -> Floats:
    """(seconds,) direction of the last turn, 1 or −1; NaN in motion and before the first turn."""
    rate_dps = subject.design.regimes.block_rate_dps
    last = np.maximum.accumulate(np.where(np.abs(rate_dps) > TURN_DPS, np.arange(len(rate_dps)), -1))
    is_defined = subject.design.regimes.block_at_rest & (last >= 0)
    return np.where(is_defined, np.sign(rate_dps[last]), np.nan)


def minutes_of(subject: Subject) -> Floats:
    """(seconds,) time from the start of the session to the middle of each second, min."""
    design = subject.design
    blocks: Floats = np.arange(0.5, len(design.regimes.block_rate_dps))
    return blocks * (design.block * design.period_s / 60.0)


RATE = "rate"
"""Regressor of the figure at the top of the page."""

REGRESSORS: Mapping[str, tuple[str, Callable[[Subject], Floats]]] = MappingProxyType(
    {
        RATE: ("deg/s", lambda subject: subject.design.regimes.block_rate_dps),
        "acceleration": ("deg/s²", _acceleration),
        "angle within the turn": ("deg", _angle),
        "temperature": ("°C", _temperature),
        "time since the session began": ("min", minutes_of),
        "direction it came from, at rest": ("−1 clockwise, 1 counter-clockwise", _direction),
    }
)
"""Quantities that the rate error is drawn against: name, unit, and (seconds,) values, NaN in seconds without one."""


@dataclass(frozen=True, slots=True, eq=False)
class Trend:
    """(bins,) medians of x and of y, the standard error of the median of y, and the points in a bin."""

    x: Floats
    y: Floats
    error: Floats
    count: Floats

    @property
    def rms(self) -> float:
        """RMS of the part of y that follows x, without the part that chance adds to medians."""
        if len(self.y) < 2:
            return 0.0
        squares = np.square(self.y - np.average(self.y, weights=self.count)) - np.square(self.error)
        return float(np.sqrt(max(0.0, float(np.average(squares, weights=self.count)))))


def trend_of(x: Floats, y: Floats) -> Trend:
    """Medians of y in bins of x with about equal numbers of points; equal values share a bin. x is sorted."""
    quantiles = np.quantile(x, np.linspace(0.0, 1.0, BINS + 1)[:-1]) if len(x) else np.zeros(0)
    edges = np.searchsorted(x, np.unique(quantiles))
    rows = []
    for own_x, own_y in zip(np.split(x, edges), np.split(y, edges), strict=True):
        if len(own_x) >= LEAST:
            middle = float(np.median(own_y))
            error = MEDIAN_ERROR * NORMAL_MAD * float(np.median(np.abs(own_y - middle))) / np.sqrt(len(own_y))
            rows.append((float(np.median(own_x)), middle, error, float(len(own_y))))
    return Trend(*np.array(rows).reshape(-1, 4).T)


class Compared(NamedTuple):
    """Rate errors of the recording, of the simulator without and with the causes, and the unexplained part, deg/s.

    The unexplained part is that of the recording minus that of the simulator with those causes that are not random.
    """

    real: Floats
    before: Floats
    after: Floats
    unexplained: Floats


class Spectra(NamedTuple):
    """(frequencies,) two-sided amplitude spectral densities of rates, deg/s/√Hz; white noise has its own density."""

    hz: Floats
    real: Floats
    before: Floats
    after: Floats


@dataclass(frozen=True, slots=True, eq=False)
class ResidualSeries:
    """Mean rate errors of a session in each second, without their median, which is the bias.

    number
        Number of the session, from 1.
    minutes
        (seconds,) time from the start of the session to the middle of each second, min.
    windows
        (3, windows, WINDOW) rates at rest: recorded, simulated without and with the causes.
    """

    number: int
    name: str
    minutes: Floats
    errors: Compared
    windows: Floats
    period_s: float


@dataclass(frozen=True, slots=True, eq=False)
class Dependence:
    """Rate errors of all drawn sessions against a regressor, in the seconds in which it has a value.

    x, errors
        (seconds,) the regressor, rising, and the rate errors.
    trends
        Trends of the four columns of `errors`.
    before_dps
        RMS of the part of the error without the causes that follows the regressor.
    """

    name: str
    unit: str
    x: Floats
    errors: Compared
    trends: tuple[Trend, Trend, Trend, Trend]
    before_dps: float

    @property
    def after_dps(self) -> float:
        """RMS of the part of the unexplained error that follows the regressor."""
        return self.trends[3].rms


@dataclass(frozen=True, slots=True, eq=False)
class RateErrors:
    """Rate errors of some sessions, recorded and simulated; `spectra` is None without enough rest."""

    sessions: tuple[ResidualSeries, ...]
    dependences: tuple[Dependence, ...]
    spectra: Spectra | None


def rate_errors_of(subjects: Sequence[Subject], causes: tuple[NamedCause, ...]) -> RateErrors:
    """Rate errors of at most MAX_SESSIONS sessions, evenly chosen."""
    count = min(len(subjects), MAX_SESSIONS)
    chosen = np.unique(np.linspace(0, len(subjects) - 1, count).round().astype(int)).tolist()
    sessions = tuple(series_of(subjects[index], causes, index + 1) for index in chosen)
    return RateErrors(sessions, dependences_of(sessions, [subjects[index] for index in chosen]), spectra_of(sessions))


def series_of(subject: Subject, causes: tuple[NamedCause, ...], number: int) -> ResidualSeries:
    """Replay a session without and with the causes; its number is the seed."""
    design = subject.design

    def replayed(every: tuple[NamedCause, ...]) -> Cleaned:
        effects = tuple(cause.in_session(number - 1, subject.rig.effects) for cause in every)
        return recalibrated_with(subject, effects).replayed(effects, number)

    deterministic = tuple(cause for cause in causes if not cause.cause.is_random)
    before = replayed(())
    after = replayed(causes) if causes else before
    explaining = after if len(deterministic) == len(causes) else replayed(deterministic)
    real_dps, before_dps, after_dps, explained_dps = (
        block_residual_dps(item, design) for item in (subject.cleaned, before, after, explaining)
    )
    columns = (real_dps, before_dps, after_dps, real_dps - explained_dps)
    errors = Compared(*(values - np.median(values) for values in columns))
    rates = (item.rate_dps for item in (subject.cleaned, before, after))
    windows = np.array([windows_within(rate_dps, design.regimes.at_rest) for rate_dps in rates])
    return ResidualSeries(number, subject.cleaned.recording.name, minutes_of(subject), errors, windows, design.period_s)


def dependences_of(sessions: Sequence[ResidualSeries], subjects: Sequence[Subject]) -> tuple[Dependence, ...]:
    """Dependence on each regressor that has more than one value in some sessions.

    subjects
        The same sessions, from which the regressors are computed.
    """
    columns = [np.concatenate(column) for column in zip(*(series.errors for series in sessions), strict=True)]
    dependences = []
    for name, (unit, values_of) in REGRESSORS.items():
        x = np.concatenate([values_of(subject) for subject in subjects])
        order = np.argsort(x, kind="stable")[: int(np.count_nonzero(np.isfinite(x)))]  # NaN come last
        if len(order) >= 2 * LEAST and x[order[-1]] > x[order[0]]:
            x, errors = x[order], Compared(*(column[order] for column in columns))
            real, before, after, unexplained = (trend_of(x, column) for column in errors)
            without = trend_of(x, errors.real - errors.before).rms
            dependences.append(Dependence(name, unit, x, errors, (real, before, after, unexplained), without))
    return tuple(dependences)


def spectra_of(sessions: Sequence[ResidualSeries]) -> Spectra | None:
    """Mean spectra at rest over the sessions with the sample rate of the first; None without a window of rest."""
    period_s = sessions[0].period_s
    windows = [series.windows for series in sessions if abs(series.period_s / period_s - 1.0) < 0.01]
    every = np.concatenate(windows, axis=1)
    if not every.shape[1]:
        return None
    density = [power_spectra(rows).mean(axis=0) * period_s / WINDOW_POWER for rows in every]
    hz: Floats = np.fft.rfftfreq(WINDOW, period_s).astype(np.float64)
    return Spectra(hz[2:-1], *(np.sqrt(values[2:-1]) for values in density))
