"""Facts of a session: one record, each part computed when it is first read."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from math import inf, sqrt
from typing import Any, TypeVar

import numpy as np

from gyrodrift.columns.accel_axes import Agreement
from gyrodrift.facts.allan import Allan, allan_of
from gyrodrift.facts.arrays import only, robust_sigma, smallest_step
from gyrodrift.facts.gravity import GravitySummary, SessionAxes, axes_agreement, axes_of, gravity_summary
from gyrodrift.facts.host import HostClock, host_clock
from gyrodrift.facts.readings import JudgedReadings, judged_readings
from gyrodrift.facts.reference import EncoderComparison, compared_to_encoder
from gyrodrift.facts.rests import RestRates, RestSource, Stretch, rests_of
from gyrodrift.facts.spectrum import RestSpectrum, spectrum_of
from gyrodrift.session.session import Session
from gyrodrift.values.arrays import Floats, Mask

GAP_PERIODS = 1.5
MOST_MISSING = 1e15

PUBLISHED = (
    "samples duration_s rate_hz jitter_s gaps steps_not_forward rates_not_finite host temperature rate encoder "
    "still_by stretches allan"
)
"""Facts in `info --json`, in this order."""

COMPANIONS = ("accel_x_mps2", "accel_y_mps2", "accel_z_mps2", "temp_c")
"""Numbers of the sensor that freeze with its rates."""

Part = TypeVar("Part")


@dataclass(frozen=True, slots=True)
class Gaps:
    """Steps of device time of more than 1.5 periods: their number, and the longest in s (0 for none).

    `missing` samples are counted by `seq` if the session has it, else by time.
    """

    count: int
    missing: int
    longest_s: float


NEAR_STEPS, NEAR_SHARE, SAME_PACE = 8, 0.75, 0.2
"""Long steps before or after a step of which this share is as long, within SAME_PACE, are a lower sample rate."""


def is_gap(steps_s: Floats, period_s: float) -> Mask:
    """Mask of forward steps that have lost samples, shape (n,): longer than usual, and than those near them.

    A device may change its sample rate.
    """
    mask: Mask = steps_s > GAP_PERIODS * period_s
    indices = np.flatnonzero(mask)
    shares = np.zeros((2, len(indices)))
    padded_s = np.pad(steps_s, NEAR_STEPS, constant_values=np.nan)
    for side, shifts in enumerate((np.arange(NEAR_STEPS), np.arange(NEAR_STEPS + 1, 2 * NEAR_STEPS + 1))):
        near = padded_s[indices[:, None] + shifts]
        shares[side] = np.mean(
            np.abs(near - steps_s[indices][:, None]) <= SAME_PACE * steps_s[indices][:, None], axis=1
        )
    mask[indices] = shares.max(axis=0) < NEAR_SHARE
    return mask


@dataclass(frozen=True, slots=True)
class Temperatures:
    """Temperature of the sensor, °C."""

    min_c: float
    max_c: float
    first_c: float
    last_c: float


@dataclass(frozen=True, slots=True)
class Rates:
    """Range and mean of the finite rates, deg/s."""

    min_dps: float
    max_dps: float
    mean_dps: float


@dataclass(frozen=True, slots=True)
class Encoder:
    """Range of the reference angle, and its smallest step, deg; the step is None if it never moves."""

    min_deg: float
    max_deg: float
    smallest_step_deg: float | None


@dataclass(frozen=True, slots=True)
class StillRate:
    """Rate at the longest rest.

    t_s, rate_dps
        Times after the first sample and rates, shape (n,).
    seconds
        Length of the rest, s.
    bias_dps, bias_sigma_dps
        Mean rate, and its standard deviation by white noise.
    noise_dps_rthz
        Angle random walk N, deg/s/√Hz (= deg/√s), from the Allan deviation; from the scatter below 30 s of rest.
    std_dps
        Standard deviation of single samples.
    instability_dps
        Bias instability B (IEEE Std 952); None if the rest is too short.
    """

    t_s: Floats
    rate_dps: Floats
    seconds: float
    bias_dps: float
    bias_sigma_dps: float
    noise_dps_rthz: float
    std_dps: float
    instability_dps: float | None


def fact(compute: Callable[["SessionFacts"], Part]) -> cached_property[Part]:
    """Part of the facts; a file may hold numbers of any size, so numpy does not warn of them."""
    return cached_property(np.errstate(over="ignore", invalid="ignore")(compute))


class SessionFacts:
    """Facts of a session, whatever its values are; the time is linear in its length. Parts that it lacks are None."""

    def __init__(self, session: Session) -> None:
        self.session = session

    def measurements(self) -> "SessionFacts":
        """Facts without the rates of readings that are no measurement; their verdicts are kept."""
        readings = self.readings
        if not readings.is_missing.any():
            return self
        facts = SessionFacts(self.session.without_rates(readings.is_missing))
        facts.readings = readings
        return facts

    def published(self) -> Mapping[str, Any]:
        """Facts that programs read, by name."""
        return {name: getattr(self, name) for name in PUBLISHED.split()}

    @property
    def samples(self) -> int:
        """Number of samples."""
        return len(self.session.t_device_s)

    @fact
    def _times_s(self) -> Floats:
        return only(self.session.t_device_s, np.isfinite(self.session.t_device_s))

    @fact
    def _forward_s(self) -> Floats:
        """Time steps that go forward, s."""
        steps_s = np.diff(self._times_s)
        return only(steps_s, (steps_s > 0.0) & (steps_s < inf))

    @fact
    def duration_s(self) -> float:
        """Elapsed device time, s."""
        return float(self._forward_s.sum())

    @fact
    def period_s(self) -> float | None:
        """Median time step, s."""
        return float(np.median(self._forward_s)) if len(self._forward_s) else None

    @property
    def rate_hz(self) -> float | None:
        """Median sample rate, Hz."""
        return None if self.period_s is None else 1.0 / self.period_s

    @fact
    def jitter_s(self) -> float | None:
        """Robust standard deviation of the time steps, s."""
        return None if self.period_s is None else robust_sigma(self._forward_s)

    @fact
    def gaps(self) -> Gaps:
        """Gaps in device time, and missing samples."""
        if self.period_s is None:
            return Gaps(0, 0, 0.0)
        steps_s = self._forward_s[is_gap(self._forward_s, self.period_s)]
        if self.session.seq is None:
            missing = int((np.minimum(np.rint(steps_s / self.period_s), MOST_MISSING) - 1.0).sum())
        else:
            missing = int(np.maximum(np.diff(self.session.seq[self.session.seq >= 0]) - 1, 0).sum())
        return Gaps(len(steps_s), missing, float(steps_s.max(initial=0.0)))

    @property
    def steps_not_forward(self) -> int:
        """Samples that the filter skips because their time does not advance."""
        return self.samples - max(len(self._times_s), 1) + max(len(self._times_s) - 1, 0) - len(self._forward_s)

    @fact
    def _rates_dps(self) -> Floats:
        return only(self.session.rate_dps, np.isfinite(self.session.rate_dps))

    @property
    def rates_not_finite(self) -> int:
        """Samples that the filter skips because their rate is not finite."""
        return self.samples - len(self._rates_dps)

    @fact
    def readings(self) -> JudgedReadings:
        """Verdicts on the readings: impossible ones, a sensor that does not answer, the end of its range."""
        session = self.session
        rates = session.rate_dps[:, None]
        if session.gyro_dps is not None:
            rates = np.column_stack([session.gyro_dps[:, :2], rates])
        columns = [column for name in COMPANIONS if (column := session.column(name)) is not None]
        companions = [column for column in columns if np.isfinite(column).all()]
        return judged_readings(session.t_device_s, rates, np.column_stack(companions) if companions else rates[:, :0])

    @fact
    def host(self) -> HostClock | None:
        """Clock of the device against the clock of the host."""
        return host_clock(self.session, self.period_s)

    @fact
    def temperature(self) -> Temperatures | None:
        """Temperature of the sensor."""
        temp_c = _finite(self.session.temp_c)
        return Temperatures(*map(float, (temp_c.min(), temp_c.max(), temp_c[0], temp_c[-1]))) if len(temp_c) else None

    @fact
    def rate(self) -> Rates | None:
        """Range and mean of the finite rates."""
        rates_dps = self._rates_dps
        return Rates(*map(float, (rates_dps.min(), rates_dps.max(), rates_dps.mean()))) if len(rates_dps) else None

    @fact
    def step_dps(self) -> float | None:
        """Smallest step of the rate, deg/s."""
        return smallest_step(self.session.rate_dps)

    @fact
    def encoder(self) -> Encoder | None:
        """Range and step of the reference angle."""
        angle_deg = _finite(self.session.encoder_deg)
        return (
            Encoder(float(angle_deg.min()), float(angle_deg.max()), smallest_step(angle_deg))
            if len(angle_deg)
            else None
        )

    @property
    def still_by(self) -> RestSource:
        """Evidence for the rests."""
        return RestSource.RATE if self.session.encoder_deg is None else RestSource.ENCODER

    @fact
    def _rests(self) -> list[RestRates]:
        return [] if self.period_s is None else rests_of(self.session, self.period_s)

    @fact
    def stretches(self) -> tuple[Stretch, ...]:
        """Rests in order of time."""
        return tuple(rest.stretch for rest in self._rests)

    @property
    def _longest(self) -> RestRates | None:
        return max(self._rests, key=lambda rest: rest.stretch.seconds, default=None)

    @property
    def rest(self) -> Stretch | None:
        """Longest rest."""
        return None if self._longest is None else self._longest.stretch

    @fact
    def allan(self) -> Allan | None:
        """Noise over the longest rest, if it has 30 s."""
        return None if self._longest is None else allan_of(*self._longest)

    @fact
    def at_rest(self) -> StillRate | None:
        """Bias and noise of the longest rest."""
        rest, session, allan = self.rest, self.session, self.allan
        if rest is None or self.rate_hz is None:
            return None
        t_s = session.t_device_s - self._times_s[0]
        is_inside = (t_s >= rest.start_s) & (t_s <= rest.end_s) & np.isfinite(session.rate_dps)
        walk = None if allan is None else allan.angle_random_walk_deg_rts
        noise_dps_rthz = rest.std_dps / sqrt(self.rate_hz) if walk is None else walk
        return StillRate(
            t_s=t_s[is_inside],
            rate_dps=session.rate_dps[is_inside],
            seconds=rest.seconds,
            bias_dps=rest.mean_dps,
            bias_sigma_dps=noise_dps_rthz / sqrt(rest.seconds),
            noise_dps_rthz=noise_dps_rthz,
            std_dps=rest.std_dps,
            instability_dps=None if allan is None else allan.bias_instability_dps,
        )

    @fact
    def spectrum(self) -> RestSpectrum | None:
        """Spectrum of the rate at the longest rest."""
        at_rest, rate_hz = self.at_rest, self.rate_hz
        return None if at_rest is None or rate_hz is None else spectrum_of(at_rest.rate_dps, rate_hz)

    @fact
    def axes(self) -> SessionAxes | None:
        """Ranges of three axes."""
        return axes_of(self.session)

    @fact
    def gravity(self) -> GravitySummary | None:
        """Size, direction and noise of gravity."""
        return gravity_summary(self.session)

    @fact
    def axes_agreement(self) -> Agreement | None:
        """Whether gravity turns as the gyro says."""
        return axes_agreement(self.session)

    @fact
    def reference(self) -> EncoderComparison | None:
        """Rates against the reference angle: factor, correlation and lag."""
        return compared_to_encoder(self.session)


def _finite(values: Floats | None) -> Floats:
    return np.empty(0) if values is None else values[np.isfinite(values)]
