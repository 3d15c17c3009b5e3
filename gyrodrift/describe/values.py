"""The description of a session, as values."""

from dataclasses import dataclass
from enum import Enum

from gyrodrift.values.arrays import Floats


class RestSource(Enum):
    """Evidence of rest; the rate alone cannot distinguish rest from a constant spin."""

    ENCODER = "encoder"
    RATE = "rate"


@dataclass(frozen=True, slots=True)
class Gaps:
    """Steps of device time of more than 1.5 periods: their number, and the longest in s (0 for none).

    `missing` samples are counted by `seq` if the session has it, else by time.
    """

    count: int
    missing: int
    longest_s: float


@dataclass(frozen=True, slots=True)
class HostClock:
    """The device clock against the host's.

    drift_ppm, drift_sd_ppm
        Rate of the device clock against the host clock, parts per million, and its standard error; None if the session
        is too short.
    delay_p95_s
        95 % of the samples arrived within this time of the minimum delay, s.
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
class Stretch:
    """A rest: start and end in s after the first sample, mean rate (the bias) and standard deviation in deg/s."""

    start_s: float
    end_s: float
    mean_dps: float
    std_dps: float


@dataclass(frozen=True, slots=True)
class Allan:
    """Noise over one rest.

    taus_s, deviations_dps
        Overlapping Allan deviation, shape (k,), averaging times in octaves.
    angle_random_walk_deg_rts
        N, deg/√s: the line of slope −1/2 at 1 s; None without this slope.
    bias_instability_dps, bias_instability_tau_s
        B, deg/s: the minimum over 0.664, and its averaging time, s; None if the rest is too short.
    """

    stretch: Stretch
    taus_s: Floats
    deviations_dps: Floats
    angle_random_walk_deg_rts: float | None
    bias_instability_dps: float | None
    bias_instability_tau_s: float | None


@dataclass(frozen=True, slots=True)
class SessionDescription:
    """Description of a session; None for values that it does not have.

    duration_s
        Elapsed device time, s.
    rate_hz, jitter_s
        Median sample rate, and robust standard deviation of the time steps.
    steps_not_forward, rates_not_finite
        Samples that the filter skips: their time does not advance, or their rate is not finite.
    still_by, stretches
        Rests in order of time, and the evidence for them.
    allan
        Noise over the longest rest, if it has 30 s.
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
