"""Second sources of a filter: what they measure becomes evidence about yaw, about the bias, and about rest.

A source has unknowns of its own: a heading has an offset, wheels have a track and a ratio of their radii. They are
states of a Kalman filter together with yaw and bias of the filter; their covariances with both are kept here. So a
source that was calibrated by the gyro does not confirm the gyro. A source that contradicts the filter too often is left
out and told, until it agrees again while the device turns.
"""

from bisect import bisect_left
from collections.abc import Callable, Sequence
from copy import deepcopy
from dataclasses import dataclass, field
from math import atan2, degrees, hypot, inf, isfinite, isnan, log, nan, sqrt
from statistics import median
from typing import Any

from gyrodrift.filters.aid_reading import WRONG_SHARE, AidedFilter, AidMoments, AidReading, normal_pdf
from gyrodrift.values.aid import Aid, AidStatus

HISTORY_S = 10.0
"""Oldest measurement that is used, s before the last sample. Chosen: positioning receivers answer within seconds."""

MOST_WAITING = 1000
"""Largest number of measurements that wait for the samples of their time."""

MOST_CORRELATED = 0.9999
"""Largest correlation of an error of a source with the filter: rounding may not reach 1."""

EVERY_S = 1.0
"""Shortest time between two measurements of a source that count as independent, s. Chosen: receivers and compasses
smooth over about a second."""

HEADING_SIGMA_DEG, RATE_SIGMA_DPS = 5.0, 0.5
"""Standard deviations of sources that state none. Chosen: a compass in a building; wheels over a second."""

LATE_S = 0.05
"""Error of the time of a measurement, s. Chosen: half a period at 10 Hz."""

COURSE_MPS = 0.1
"""Standard deviation of each component of a velocity that a course comes from, m/s: data sheets of u-blox receivers
state 0.05 m/s at 50 %."""

OFFSET_SIGMAS = 3.0
"""Distance of a first heading from yaw, in standard deviations, within which both have the same zero."""

SCALE_SIGMA, RATIO_SIGMA, RATIO_WALK = 0.05, 0.001, 0.0001
"""Standard deviations of the scale of a turn rate and of the ratio of two wheels, as shares, and random walk of both,
1/√s. Measured: tracks are 2.5 % off, and ratios move by 0.1 %, on robots with a motion capture."""

TRACK_DPS = 1e4
"""Standard deviation of the turn rate for a difference of 1 of two wheels whose track is unknown, deg/s."""

CROSS_AXIS = 0.002
"""Scale error that changes from turn to turn, as a share: misalignment in the data sheets of common parts."""

SLIP = 0.05
"""Standard deviation of a turn rate that changes from turn to turn, as a share. Measured: as above."""

TURNING_DPS = 5.0
"""Rate from which on the device turns, deg/s: a wrong scale or sign shows in turns alone."""

MEMORY = 0.1
"""Weight of a measurement in the share of those that agree: about ten count."""

SURE_WRONG, SURE_RIGHT = -5.0, 10.0
"""Logarithm of the odds that a source measures against chance values, below which it is left out, and the largest that
is remembered. Chosen: 1 : 150 against it; a source that was right needs seven wrong values in a row."""

REMEMBERED = 5
"""Differences that are kept to tell how a source contradicts."""

RENEWED_S = 60.0
"""Shortest time between two renewals of the state without sources, s. Chosen: a copy costs as much as 1000 samples."""

AGREEING_READINGS, AGREEING_DEG = 20, 30.0
"""Measurements in a row that bring a source back, and turn within them, deg: a source that is stuck agrees with a
device that does not turn."""

TRAP_MPS, MOVING_MPS = 0.3, 0.3
"""Least speed beside 0 from which on a 0 does not mean rest, and speed that is motion, m/s: a car that rolls at 0.3 m/s
around a bend of 6 m turns at 3 deg/s, which a rest sensor may not hide."""

TRAP_SHARE, MOVING_SHARE = 0.2, 0.1
"""The same for wheels without a unit, as shares of the largest speed so far."""

HELD_PERIODS = 3.0
"""Time for which a report of rest holds, in the longest periods of its source so far."""


@dataclass(slots=True)
class OwnErrors:
    """Errors of a source's own, with their covariance matrix and covariances with bias and yaw of the filter."""

    mean: list[float]
    cov: list[list[float]]
    with_bias: list[float]
    with_yaw: list[float]
    bias_var: float = inf
    yaw_var: float = inf

    def follow(self, m: AidMoments, seconds: float, walk_var: float) -> None:
        """Go over time since the last measurement: yaw turned by the error of the bias, or was measured meanwhile."""
        kept_bias = min(1.0, m.bias_var / self.bias_var) if self.bias_var > 0.0 else 0.0
        kept_yaw = min(1.0, m.yaw_var / self.yaw_var) if self.yaw_var > 0.0 else 0.0
        for i, row in enumerate(self.cov):
            row[i] += walk_var * seconds
            yaw, bias = kept_yaw * (self.with_yaw[i] - self.with_bias[i] * seconds), kept_bias * self.with_bias[i]
            self.with_yaw[i] = _correlation(yaw, row[i] * m.yaw_var) * sqrt(row[i] * m.yaw_var)
            self.with_bias[i] = _correlation(bias, row[i] * m.bias_var) * sqrt(row[i] * m.bias_var)

    def reading(
        self, shape: Sequence[float], value: float, variance: float, period_deg: float, m: AidMoments
    ) -> AidReading:
        """A measurement without the mean of its errors, which come with the factors `shape`."""
        own_var = max(0.0, _dot(shape, [_dot(row, shape) for row in self.cov]))
        return AidReading(
            period_deg > 0.0,
            value - _dot(shape, self.mean),
            variance,
            own_var,
            _correlation(_dot(shape, self.with_bias), own_var * m.bias_var),
            _correlation(_dot(shape, self.with_yaw), own_var * m.yaw_var),
            period_deg,
        )

    def update(self, shape: Sequence[float], reading: AidReading, m: AidMoments, right: float) -> None:
        """Learn from a measurement that is right with this probability; `m` are the moments before it."""
        innovation, variance = innovation_of(reading, m)
        with_measured = self.with_yaw if reading.is_heading else self.with_bias
        gain = [(w + _dot(row, shape)) / variance for w, row in zip(with_measured, self.cov, strict=True)]
        bias_gain, yaw_gain = gains_of(reading, m)
        spread = right * (variance - (1.0 - right) * innovation * innovation)
        for i, g in enumerate(gain):
            self.mean[i] += right * g * innovation
            self.with_bias[i] -= spread * g * bias_gain
            self.with_yaw[i] -= spread * g * yaw_gain
            for j, other in enumerate(gain):
                self.cov[i][j] -= spread * g * other
            self.cov[i][i] = max(self.cov[i][i], 0.0)


def _dot(a: Sequence[float], b: Sequence[float]) -> float:
    return sum(x * y for x, y in zip(a, b, strict=True))


def _correlation(covariance: float, variances: float) -> float:
    """Correlation of two errors, with a margin to 1."""
    return max(-MOST_CORRELATED, min(covariance / sqrt(variances), MOST_CORRELATED)) if variances > 0.0 else 0.0


def innovation_of(reading: AidReading, m: AidMoments) -> tuple[float, float]:
    """Difference between a measurement and the filter, and its variance."""
    variance = reading.own_var + reading.variance
    if reading.is_heading:
        return reading.difference(m.yaw_deg), m.yaw_var + 2.0 * reading.with_yaw(m.yaw_var) + variance
    return reading.difference(m.bias_dps), m.bias_var + 2.0 * reading.with_bias(m.bias_var) + variance


def gains_of(reading: AidReading, m: AidMoments) -> tuple[float, float]:
    """Gains of a measurement for bias and yaw of the filter."""
    _, variance = innovation_of(reading, m)
    bias = m.covariance if reading.is_heading else m.bias_var
    yaw = m.yaw_var if reading.is_heading else m.covariance
    return (bias + reading.with_bias(m.bias_var)) / variance, (yaw + reading.with_yaw(m.yaw_var)) / variance


def right_odds(reading: AidReading, m: AidMoments) -> float:
    """Density of a measurement of a source that is right most times, over that of chance values."""
    return (1.0 - WRONG_SHARE) * normal_pdf(*innovation_of(reading, m)) * reading.range + WRONG_SHARE


@dataclass(slots=True)
class Source:
    """A second source.

    t_s, period_s
        Time of its last measurement, and longest time between two, s.
    used_s
        Time of the last measurement that counted.
    errors
        Its own errors; None before the first measurement.
    weight, log_odds
        Share of the last measurements that agree, and logarithm of the odds that the source measures at all.
    differences
        Last differences to the filter.
    differs
        How it contradicts the filter, while it is left out.
    agreed, from_deg
        Measurements in a row that agree again, and yaw where they began.
    value, speed
        Last value, and speed beside it.
    least, most
        Least speed beside 0, and largest, so far.
    area, since_s, last
        Integral of the turn rates of this second and of their speeds, its beginning, and the last rate and speed.
    """

    t_s: float = -inf
    period_s: float = 0.0
    used_s: float = -inf
    errors: OwnErrors | None = None
    weight: float = 1.0
    log_odds: float = 0.0
    differences: list[float] = field(default_factory=list)
    differs: str = ""
    agreed: int = 0
    from_deg: float = 0.0
    value: float = nan
    speed: float = nan
    least: float = inf
    most: float = 0.0
    area: tuple[float, float] = (0.0, 0.0)
    since_s: float = nan
    last: tuple[float, float] = (nan, nan)

    @property
    def is_sure(self) -> bool:
        """Whether it does not speak of yaw, is left out, or has been right for long."""
        return self.errors is None or self.differs != "" or self.log_odds >= SURE_RIGHT

    def judge(self, odds: float, difference: float) -> bool:
        """Count a measurement; whether the source has to be left out."""
        self.weight += MEMORY * (1.0 - WRONG_SHARE / odds - self.weight)
        self.log_odds = min(SURE_RIGHT, self.log_odds + log(odds))
        self.differences = [*self.differences[1 - REMEMBERED :], difference]
        return self.log_odds < SURE_WRONG


@dataclass(slots=True)
class GyroScale:
    """Scale error of a gyro of one axis, which headings show: mean, variance, covariance with yaw, and yaw so far."""

    mean: float = 0.0
    variance: float = nan
    with_yaw: float = 0.0
    yaw_deg: float = 0.0

    @property
    def sigma(self) -> float:
        """Standard deviation, with the part that changes from turn to turn."""
        return sqrt(self.variance + CROSS_AXIS * CROSS_AXIS)

    def turn(self, turn_deg: float) -> float:
        """Follow a turn since the last heading; variance of yaw beside that of the scale alone, deg²."""
        beside_var = 2.0 * self.with_yaw * turn_deg
        self.with_yaw += self.variance * turn_deg
        return beside_var

    def update(self, reading: AidReading, m: AidMoments, right: float) -> None:
        """Learn from a heading that is right with this probability; `m` are the moments before it."""
        innovation, variance = innovation_of(reading, m)
        with_yaw = _correlation(self.with_yaw, self.variance * m.yaw_var) * sqrt(self.variance * m.yaw_var)
        gain = with_yaw / variance
        spread = right * (variance - (1.0 - right) * innovation * innovation)
        self.mean += right * gain * innovation
        self.variance = max(0.0, self.variance - spread * gain * gain)
        self.with_yaw = with_yaw - spread * gain * gains_of(reading, m)[1]


class Aids:
    """Second sources of one filter, and the last seconds of its motion, for measurements that come late.

    scale
        Scale error of the gyro that the filter is fed without.
    plain, plain_scale
        State of the filter without the sources since a time at which all were right, and scale error in it.
    is_contradicted
        A source has been left out that may have misled the filter: it has to go on from `plain`.
    """

    def __init__(self) -> None:
        self._sources: dict[str, Source] = {}
        self._waiting: list[Aid] = []
        self._times: list[float] = []
        self._motions: list[tuple[float, float]] = []
        self._rate_dps, self._yaw_deg, self._now_s = nan, nan, nan
        self._broken_s = -inf
        self.scale = GyroScale()
        self.plain: Any = None
        self.plain_scale = 0.0
        self.is_contradicted = False
        self._renewed_s = -inf

    @property
    def status(self) -> dict[str, AidStatus]:
        """How each source agrees, by its name."""
        now_s = self._now_s
        return {
            name: AidStatus(max(0.0, now_s - it.t_s), 0.0 if it.differs else it.weight, it.differs)
            for name, it in self._sources.items()
        }

    def take(self, aid: Aid) -> None:
        """Add a measurement; it is used once the samples have reached its time."""
        if not isfinite(aid.value):
            return
        if isnan(aid.t_s):
            aid = aid._replace(t_s=self._now_s)
        if isnan(aid.t_s):  # before the first sample
            aid = aid._replace(t_s=-inf)
        source = self._sources.setdefault(aid.name, Source())
        if aid.kind in ("standing", "speed", "wheels"):
            _hear(source, aid)
        if isfinite(source.t_s):
            source.period_s = max(source.period_s, min(aid.t_s - source.t_s, HISTORY_S))
        source.t_s = max(source.t_s, aid.t_s)
        if aid.kind not in ("standing", "speed"):
            self._waiting = [*self._waiting[1 - MOST_WAITING :], aid]

    def still(self, t_s: float) -> float:
        """Report of rest at a time: 1, 0 in motion, NaN if unknown."""
        reports = [_report(source, t_s) for source in self._sources.values()]
        return 0.0 if 0.0 in reports else 1.0 if 1.0 in reports else nan

    def follow(self, aided: AidedFilter | None, c: Any, s: Any, t_s: float) -> None:
        """Follow the filter after a sample, and let it take the measurements whose time has come."""
        step_s, self._now_s = t_s - self._now_s, t_s
        if aided is None:
            self._waiting = []
            return
        if step_s <= 0.0:  # the clock has restarted
            self._times, self._motions, self._broken_s, self.scale.yaw_deg = [], [], t_s, 0.0
            self._waiting = [aid._replace(t_s=t_s) for aid in self._waiting]
        rate_dps = aided.rate_dps(s)
        motion_deg, angle_deg = self._motions[-1] if self._motions else (0.0, 0.0)
        if step_s > 0.0:
            motion_deg += s.yaw_deg - self._yaw_deg - s.correction_deg
            angle_deg += 0.5 * (rate_dps + self._rate_dps) * step_s
        if step_s > s.watch.longest_step_s:
            self._broken_s = t_s
        self._rate_dps, self._yaw_deg = rate_dps, s.yaw_deg
        self._times.append(t_s)
        self._motions.append((motion_deg, angle_deg))
        if self._times[-1] - self._times[0] > 2.0 * HISTORY_S:
            first = bisect_left(self._times, t_s - HISTORY_S)
            del self._times[:first], self._motions[:first]
        if self._waiting and aided.has_block_ended(s):
            due = [aid for aid in self._waiting if aid.t_s <= t_s]
            self._waiting = [aid for aid in self._waiting if aid.t_s > t_s]
            if self.plain is None:
                self.plain, self.plain_scale, self._renewed_s = deepcopy(s), self.scale.mean, t_s
            for aid in due:
                if aid.t_s >= self._times[0] or aid.t_s == -inf:
                    self._measure(aided, c, s, aid._replace(t_s=max(aid.t_s, self._times[0])))
            self._yaw_deg = s.yaw_deg
            if t_s - self._renewed_s > RENEWED_S and all(it.is_sure for it in self._sources.values()):
                self.plain = None

    def forget(self) -> None:
        """Forget what sources have learned of a filter that they may have misled; it goes on from `plain`."""
        self.is_contradicted, self._yaw_deg = False, self.plain.yaw_deg
        self.plain, self.scale = None, GyroScale(self.plain_scale, yaw_deg=self._motions[-1][0])
        for source in self._sources.values():
            if source.errors is not None and source.errors.cov[0][0] > 0.0:
                source.errors = None

    def _measure(self, aided: AidedFilter, c: Any, s: Any, aid: Aid) -> None:
        source = self._sources[aid.name]
        if aid.kind == "heading":
            self._measure_heading(aided, c, s, aid, source)
        else:
            self._measure_rate(aided, c, s, aid, source)

    def _measure_heading(self, aided: AidedFilter, c: Any, s: Any, aid: Aid, source: Source) -> None:
        if aid.t_s - source.used_s < EVERY_S:
            return
        sigma = HEADING_SIGMA_DEG if isnan(aid.sigma) else aid.sigma
        if isfinite(aid.speed):
            sigma = hypot(sigma if isfinite(aid.sigma) else 0.0, degrees(atan2(COURSE_MPS, abs(aid.speed))))
        variance = sigma * sigma + (LATE_S * (self._rate_dps - s.bias_dps)) ** 2
        value = aid.value + self._motions[-1][0] - self._motion_at(aid.t_s)[0]
        if aided.settle_scale is not None:
            self._settle_scale(aided.settle_scale, c, s)
        m = aided.moments(s)
        if source.errors is None:
            source.errors = _first_offset(AidReading(True, value, variance, 0.0, 0.0, 0.0, aid.period_deg), m)
        seconds, source.used_s = max(0.0, aid.t_s - source.used_s), aid.t_s
        if isfinite(seconds):
            source.errors.follow(m, seconds, 0.0)
        reading = source.errors.reading((1.0,), value, variance, aid.period_deg, m)
        if self._is_believed(source, reading, m, s.yaw_deg):
            right = self._learn(aided, c, s, source, (1.0,), reading, m)
            if aided.settle_scale is not None:
                self.scale.update(reading, m, right)
        elif source.agreed == 0:  # its offset may be another one now
            source.errors = _offset(reading._replace(value=value), m)

    def _settle_scale(self, settle: Callable[[Any, Any, float], None], c: Any, s: Any) -> None:
        """Keep the error of the scale factor since the last heading in yaw."""
        scale, motion_deg = self.scale, self._motions[-1][0]
        if isnan(scale.variance):
            scale.variance = c.scale_sigma * c.scale_sigma
        settle(c, s, scale.turn(motion_deg - scale.yaw_deg))
        scale.yaw_deg = motion_deg

    def _measure_rate(self, aided: AidedFilter, c: Any, s: Any, aid: Aid, source: Source) -> None:
        speed = 0.0 if isnan(aid.speed) else aid.speed
        seconds, before, source.last = aid.t_s - source.used_s, source.last, (aid.value, speed)
        source.used_s = aid.t_s
        if not 0.0 < seconds <= EVERY_S or isnan(before[0]):
            source.since_s, source.area = aid.t_s, (0.0, 0.0)
            return
        source.area = (
            source.area[0] + 0.5 * (before[0] + aid.value) * seconds,
            source.area[1] + 0.5 * (before[1] + speed) * seconds,
        )
        length_s = aid.t_s - source.since_s
        if length_s < EVERY_S:
            return
        rate, mean_speed = source.area[0] / length_s, source.area[1] / length_s
        from_s, source.since_s, source.area = source.since_s, aid.t_s, (0.0, 0.0)
        if from_s < max(self._broken_s, self._times[0]):
            return
        measured_dps = (self._motion_at(aid.t_s)[1] - self._motion_at(from_s)[1]) / length_s
        is_wheels = aid.kind == "wheels"
        if source.errors is None:
            source.errors = _rate_errors(is_wheels=is_wheels)
        m, errors = aided.moments(s), source.errors
        errors.follow(m, length_s, RATIO_WALK * RATIO_WALK * (errors.mean[0] ** 2 if is_wheels else 1.0))
        scale = errors.mean[0] if is_wheels else 1.0
        shape = (rate, scale * mean_speed)
        stated_dps = (1.0 if not is_wheels else scale) * (RATE_SIGMA_DPS if isnan(aid.sigma) else aid.sigma)
        sigma_dps = RATE_SIGMA_DPS if is_wheels and isnan(aid.sigma) else abs(stated_dps)
        rate_dps = scale * rate
        late_dps = LATE_S * scale * (aid.value - before[0]) / seconds
        variance = sigma_dps**2 + (SLIP * rate_dps) ** 2 + late_dps**2
        value = measured_dps if is_wheels else measured_dps - rate
        reading = errors.reading(shape, value, variance, 0.0, m)
        is_turning = max(abs(rate_dps), abs(measured_dps - s.bias_dps)) > TURNING_DPS
        if self._is_believed(source, reading, m, s.yaw_deg, is_telling=is_turning, is_rate=True):
            self._learn(aided, c, s, source, shape, reading, m)

    def _is_believed(
        self,
        source: Source,
        reading: AidReading,
        m: AidMoments,
        yaw_deg: float,
        *,
        is_telling: bool = True,
        is_rate: bool = False,
    ) -> bool:
        """Whether a measurement counts; sources that contradict are left out, and come back."""
        odds, (difference, _) = right_odds(reading, m), innovation_of(reading, m)
        is_backwards = is_rate and source.errors is not None and _is_backwards(source.errors)
        if source.differs == "":
            if (is_telling and source.judge(odds, difference)) or is_backwards:
                unit = "deg/s" if is_rate else "deg"
                source.differs = f"it differs by {median(source.differences or [difference]):.3g} {unit}"
                if is_backwards:
                    source.differs = "it turns the other way: left and right are swapped"
                source.agreed, self.is_contradicted = 0, True
            return source.differs == ""
        if odds < 1.0 or is_backwards:
            source.agreed = 0
        elif is_telling:
            source.from_deg = yaw_deg if source.agreed == 0 else source.from_deg
            source.agreed += 1
        if source.agreed >= AGREEING_READINGS and (is_rate or abs(yaw_deg - source.from_deg) > AGREEING_DEG):
            source.differs, source.weight, source.log_odds, source.differences = "", 1.0, 0.0, []
        return source.differs == ""

    def _learn(
        self,
        aided: AidedFilter,
        c: Any,
        s: Any,
        source: Source,
        shape: Sequence[float],
        reading: AidReading,
        m: AidMoments,
    ) -> float:
        """Let the filter take a measurement, and learn the source's own errors; probability that it is right."""
        right = aided.take(c, s, reading)
        if source.errors is not None:
            source.errors.update(shape, reading, m, right)
            after = aided.moments(s)
            source.errors.bias_var, source.errors.yaw_var = after.bias_var, after.yaw_var
        return right

    def _motion_at(self, t_s: float) -> tuple[float, float]:
        """Turn of the filter and measured angle at a time, deg, between the samples next to it."""
        i = min(max(1, bisect_left(self._times, t_s)), len(self._times) - 1)
        if i == 0:
            return self._motions[0]
        begin_s, end_s = self._times[i - 1], self._times[i]
        share = min(max((t_s - begin_s) / (end_s - begin_s), 0.0), 1.0)
        (motion, angle), (next_motion, next_angle) = self._motions[i - 1], self._motions[i]
        return motion + share * (next_motion - motion), angle + share * (next_angle - angle)


def _first_offset(reading: AidReading, m: AidMoments) -> OwnErrors:
    """Offset of a source by its first heading: none if it is near yaw, else unknown before it."""
    difference, variance = innovation_of(reading, m)
    if abs(difference) < OFFSET_SIGMAS * sqrt(variance):
        return OwnErrors([0.0], [[0.0]], [0.0], [0.0])
    return _offset(reading, m)


def _offset(reading: AidReading, m: AidMoments) -> OwnErrors:
    """Offset of a source by a single heading, whose errors are those of the heading and of yaw."""
    difference = reading.difference(m.yaw_deg)
    return OwnErrors(
        [difference], [[m.yaw_var + reading.variance]], [-m.covariance], [-m.yaw_var], m.bias_var, m.yaw_var
    )


def _rate_errors(*, is_wheels: bool) -> OwnErrors:
    """Scale and ratio of a turn rate before the first measurement."""
    scale_var = TRACK_DPS**2 if is_wheels else SCALE_SIGMA**2
    return OwnErrors([0.0, 0.0], [[scale_var, 0.0], [0.0, RATIO_SIGMA**2]], [0.0, 0.0], [0.0, 0.0])


def _is_backwards(errors: OwnErrors) -> bool:
    """Whether the difference of two wheels turns the other way: their scale is far below 0."""
    return errors.cov[0][0] < TRACK_DPS and errors.mean[0] < -OFFSET_SIGMAS * sqrt(errors.cov[0][0])


def _hear(source: Source, aid: Aid) -> None:
    """Remember a report of rest or a speed."""
    size = abs(aid.value)
    if aid.kind == "wheels":
        size = max(size, 0.0 if isnan(aid.speed) else abs(aid.speed))
    source.value, source.speed = aid.value, nan
    if aid.kind == "standing":
        return
    source.speed = size
    source.most = max(source.most, size)
    is_zero = size <= 2.0 * aid.sigma if isfinite(aid.sigma) and aid.kind == "speed" else size == 0.0
    if not is_zero:
        source.least = min(source.least, size)
    trap, moving = TRAP_MPS, MOVING_MPS
    if aid.kind == "wheels":
        trap, moving = TRAP_SHARE * source.most, MOVING_SHARE * source.most
    if is_zero:
        source.value = 1.0 if source.least == inf or source.least < trap else nan
    else:
        source.value = 0.0 if size > moving else nan


def _report(source: Source, t_s: float) -> float:
    """Report of rest of a source, as long as it holds."""
    if source.period_s > 0.0 and t_s - source.t_s > HELD_PERIODS * source.period_s:
        return nan
    return source.value
