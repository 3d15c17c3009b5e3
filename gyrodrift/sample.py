"""Values that pass between packages: a decoded reading, a sample with its time, a corrected sample."""

from math import nan
from typing import NamedTuple


class Reading(NamedTuple):
    """One measurement decoded from the wire, before it has a host time.

    t_us
        Device clock in µs, 32 bits, wraps; None if the device has no clock.
    seq
        Device counter, 16 bits, wraps; None if the device has no counter.
    rate_dps
        Yaw rate, deg/s, counter-clockwise positive.
    encoder_deg, temp_c
        Reference angle in deg and temperature in °C; NaN if the device does not send it.
    still
        1 if another source than the rate says that the device is at rest, 0 if it moves, NaN if unknown.
    yaw_deg
        Yaw angle of a device that sends no rate, deg, counter-clockwise positive; else NaN.
    """

    t_us: int | None
    seq: int | None
    rate_dps: float
    encoder_deg: float = nan
    temp_c: float = nan
    still: float = nan
    yaw_deg: float = nan


class Sample(NamedTuple):
    """One measurement on the unwrapped device clock.

    seq
        Unwrapped counter; lost samples leave a gap.
    t_device_s
        Device clock, s, unwrapped.
    t_host_s
        Arrival, Unix time in s on a clock that never steps.
    rate_dps, encoder_deg, temp_c, still
        As in `Reading`.
    """

    seq: int
    t_device_s: float
    t_host_s: float
    rate_dps: float
    encoder_deg: float = nan
    temp_c: float = nan
    still: float = nan


class Corrected(NamedTuple):
    """A sample with the results of the filter; every output gets this.

    corrected_dps
        Measured rate minus the estimated drift, deg/s.
    yaw_deg
        Unwrapped yaw, deg, 0 at the first sample.
    bias_dps
        Estimated drift, deg/s.
    yaw_sigma_deg, confidence
        Standard deviation of yaw, deg, and probability of the most probable hypothesis; NaN if the filter has none.
    bias_sigma_dps, rest_probability
        Standard deviation of the estimated drift, deg/s, and probability of rest; NaN if the filter has none.
    raw_yaw_deg
        Integral of the measured rate, unwrapped, deg, 0 where `yaw_deg` is 0.
    heading_deg
        Compass heading, deg, clockwise from north, 0 to 360; NaN without a reference.
    reference_deg
        Angle of the encoder, unwrapped, from where `yaw_deg` is 0, in degrees; NaN without an encoder.
    """

    sample: Sample
    corrected_dps: float
    yaw_deg: float
    bias_dps: float
    yaw_sigma_deg: float = nan
    confidence: float = nan
    bias_sigma_dps: float = nan
    rest_probability: float = nan
    raw_yaw_deg: float = nan
    heading_deg: float = nan
    reference_deg: float = nan
