"""Values that pass between packages: a decoded reading, a sample with its time, a corrected sample."""

from math import isnan, nan
from typing import NamedTuple

from gyrodrift.values.aid import Aid, AidStatus


class Inertial(NamedTuple):
    """Rates and specific forces about the three axes of a sensor.

    The sensor frame is right-handed, with z up if the board lies flat: z then measures +9.81 m/s² at rest.

    gyro_x_dps, gyro_y_dps, gyro_z_dps
        Rates, deg/s, by the right-hand rule.
    accel_x_mps2, accel_y_mps2, accel_z_mps2
        Specific forces, m/s²; NaN if the device does not send them.
    """

    gyro_x_dps: float
    gyro_y_dps: float
    gyro_z_dps: float
    accel_x_mps2: float = nan
    accel_y_mps2: float = nan
    accel_z_mps2: float = nan


NO_AXES = Inertial(*(nan,) * len(Inertial._fields))
"""Axes of a sample without them."""


def upside_down(inertial: Inertial) -> Inertial:
    """Axes in a frame that is turned by 180° about x, as FRD from FLU: y and z change their sign."""
    x_dps, y_dps, z_dps, x_mps2, y_mps2, z_mps2 = inertial
    if isnan(y_mps2) and isnan(z_mps2):
        return Inertial(x_dps, -y_dps, -z_dps, x_mps2)
    return Inertial(x_dps, -y_dps, -z_dps, x_mps2, -y_mps2, -z_mps2)


class DeviceYaw(NamedTuple):
    """Result of a filter that the device runs itself, after the same sample.

    yaw_deg
        Yaw, deg, counter-clockwise positive; its zero is that of the device.
    yaw_sigma_deg
        Standard deviation of the yaw, deg; NaN if the filter has none.
    bias_dps
        Estimated drift of the yaw rate, deg/s.
    """

    yaw_deg: float
    yaw_sigma_deg: float
    bias_dps: float


NO_YAW = DeviceYaw(nan, nan, nan)
"""Result of the device's own filter where a sample has none."""


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
    inertial
        All axes; None if the device does not send three rates. `rate_dps` is its `gyro_z_dps`.
    device_yaw
        Result of the device's own filter; None if the device sends none for this measurement.
    delta_deg
        Angle since the previous measurement of a device that sends no rate, deg; else NaN. `rate_dps` is NaN, and the
        clock makes it.
    aids
        Measurements of second sources that came with it; their times count from it, s, negative for earlier ones.
    """

    t_us: int | None
    seq: int | None
    rate_dps: float
    encoder_deg: float = nan
    temp_c: float = nan
    still: float = nan
    yaw_deg: float = nan
    inertial: Inertial | None = None
    device_yaw: DeviceYaw | None = None
    delta_deg: float = nan
    aids: tuple[Aid, ...] = ()


class Sample(NamedTuple):
    """One measurement on the unwrapped device clock.

    seq
        Unwrapped counter; lost samples leave a gap.
    t_device_s
        Device clock, s, unwrapped.
    t_host_s
        Arrival, Unix time in s on a clock that never steps.
    rate_dps, encoder_deg, temp_c, still, inertial, device_yaw
        As in `Reading`.
    aids
        Measurements of second sources that came with it or since the sample before.
    """

    seq: int
    t_device_s: float
    t_host_s: float
    rate_dps: float
    encoder_deg: float = nan
    temp_c: float = nan
    still: float = nan
    inertial: Inertial | None = None
    device_yaw: DeviceYaw | None = None
    aids: tuple[Aid, ...] = ()


class Attitude(NamedTuple):
    """Attitude of a sensor with three axes.

    q_w, q_x, q_y, q_z
        Unit quaternion that rotates from the sensor to the earth frame: z up, heading as `yaw_deg`.
    tilt_deg, tilt_sigma_deg
        Angle between the z axis of the sensor and the vertical, and its standard deviation, deg.
    roll_deg, pitch_deg
        Of the device, through its `mount`, deg.
    bias_x_dps, bias_y_dps, bias_z_dps
        Estimated drift about the axes of the sensor, deg/s.
    """

    q_w: float
    q_x: float
    q_y: float
    q_z: float
    tilt_deg: float
    roll_deg: float
    pitch_deg: float
    tilt_sigma_deg: float
    bias_x_dps: float
    bias_y_dps: float
    bias_z_dps: float


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
    attitude
        Attitude; None for a device with one axis.
    device_difference_deg
        `yaw_deg` minus the device's own yaw at its last result, −180 to 180 deg, 0 where the two were aligned; NaN
        before the first result.
    correction_deg, corrections
        Step of yaw in this sample that is no motion, deg: a change of the estimate, 0 else. Number of those over 1 deg.
    smooth_yaw_deg
        `yaw_deg` that takes corrections in slowly; NaN without `slew_dps` in the config.
    aids
        How each second source agrees, by its name; None without any.
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
    attitude: Attitude | None = None
    device_difference_deg: float = nan
    correction_deg: float = 0.0
    corrections: float = 0.0
    smooth_yaw_deg: float = nan
    aids: dict[str, AidStatus] | None = None
