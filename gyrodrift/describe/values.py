"""The description of a session, as values."""

from dataclasses import dataclass
from enum import Enum

from gyrodrift.arrays import Floats


class RestSource(Enum):
    """What tells that the device was stationary; the rate alone cannot tell rest from a constant spin."""

    ENCODER = "encoder"
    RATE = "rate"


@dataclass(frozen=True, slots=True)
class Gaps:
    """Steps of device time of more than 1.5 periods: how many, the longest in s (0 without any).

    `missing` samples are counted by `seq` where there is one, else by time.
    """

    count: int
    missing: int
    longest_s: float


@dataclass(frozen=True, slots=True)
class HostClock:
    """The device clock against the host's.

    drift_ppm, drift_sd_ppm
        How fast the device clock runs against the host's, parts per million, and the standard error of that; None
        where the session is too short to say.
    delay_p95_s
        95 of 100 samples arrived within this time of the soonest possible, s.
    """

    drift_ppm: float | None
    drift_sd_ppm: float | None
    delay_p95_s: float


@dataclass(frozen=True, slots=True)
class Temperatures:
    """Temperature of the sensor, °C."""

    min_c: float
    max_c: float
    first_c: float
    last_c: float


@dataclass(frozen=True, slots=True)
class Rates:
    """Measured rate, deg/s, over the finite ones."""

    min_dps: float
    max_dps: float
    mean_dps: float


@dataclass(frozen=True, slots=True)
class Encoder:
    """Reference angle, degrees; the smallest step seen is its resolution at best, None where it never moves."""

    min_deg: float
    max_deg: float
    smallest_step_deg: float | None


@dataclass(frozen=True, slots=True)
class Stretch:
    """A time without motion: s after the first sample, mean rate (the bias there) and its scatter, deg/s."""

    start_s: float
    end_s: float
    mean_dps: float
    std_dps: float


@dataclass(frozen=True, slots=True)
class Allan:
    """Noise over one still stretch.

    taus_s, deviations_dps
        Overlapping Allan deviation, shape (k,), averaging times in octaves.
    angle_random_walk_deg_rts
        N, deg/√s: the line of slope −1/2 at 1 s; None where there is no such slope.
    bias_instability_dps, bias_instability_tau_s
        B, deg/s: the minimum over 0.664, and where it lies; None where the stretch is too short to show one.
    """

    stretch: Stretch
    taus_s: Floats
    deviations_dps: Floats
    angle_random_walk_deg_rts: float | None
    bias_instability_dps: float | None
    bias_instability_tau_s: float | None


@dataclass(frozen=True, slots=True)
class SessionDescription:
    """What a session holds; None where it has no such column, or not enough of it.

    duration_s
        Device time that passed, s.
    rate_hz, jitter_s
        Median sample rate, and robust standard deviation of the time steps.
    steps_not_forward, rates_not_finite
        Samples that the filter passes by: time stands still, goes back or is no number; the rate is no number.
    still_by, stretches
        Where the device was stationary, in order of time, and what tells so.
    allan
        Over the longest stretch, if that has 30 s.
    """

    samples: int
    duration_s: float
    rate_hz: float | None
    jitter_s: float | None
    gaps: Gaps
    steps_not_forward: int
    rates_not_finite: int
    host: HostClock | None
    temperature: Temperatures | None
    rate: Rates | None
    encoder: Encoder | None
    still_by: RestSource
    stretches: tuple[Stretch, ...]
    allan: Allan | None
