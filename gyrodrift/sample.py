"""The values everything passes on: a reading as the device spoke it, a sample with its time, a corrected sample."""

from math import nan
from typing import NamedTuple


class Reading(NamedTuple):
    """One measurement as decoded from the wire, before it has a time.

    t_us
        Device clock in µs, 32 bits, wrapping; None where the device has no clock.
    seq
        Device counter, 16 bits, wrapping; None where the device has none.
    rate_dps
        Yaw rate, deg/s, counter-clockwise positive.
    encoder_deg, temp_c
        Reference angle in degrees and temperature in °C; NaN where the device sends none.
    still
        1 where something else than the rate knows that the device stands still, 0 that it moves; NaN where nobody says.
    yaw_deg
        Angle about the vertical of a device that sends no rate, counter-clockwise positive; NaN for all others. The
        clock makes a rate of it.
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
        Counter, unwrapped; samples that were lost leave a hole in it.
    t_device_s
        The sensor's own clock in s, unwrapped.
    t_host_s
        When it arrived, Unix time in s on a clock that never steps.
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
    """A sample with what the filter made of it; what every output is handed.

    corrected_dps
        Measured rate less the drift estimate, deg/s.
    yaw_deg
        Unwrapped yaw in degrees, 0 at the first sample.
    bias_dps
        The drift estimate, deg/s.
    yaw_sigma_deg, confidence
        Standard deviation of yaw in degrees, and how probable what the filter believes is; NaN where it does not say.
    bias_sigma_dps, rest_probability
        Standard deviation of the drift estimate in deg/s, and how probable it is that the device is at rest; likewise.
    raw_yaw_deg
        The measured rate integrated as it is, unwrapped, in degrees, 0 where `yaw_deg` is.
    heading_deg
        Compass heading, clockwise from north, 0 to 360; NaN until a reference was given.
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
