"""Calibration of a gyro: its values, and the corrected rate.

    rate = sign · scale · (measured − bias(T))        scale of the present direction of turning
    bias(T) = bias_dps + bias_dps_per_c · (T − temp_c)

With three axes the rates pass a matrix before sign and scale, and the acceleration has an offset and a scale:

    rates = gyro_matrix · (measured − bias)           bias of x and y: gyro_bias_xy_dps, of z: bias(T)
    acceleration = accel_scale · (measured − accel_offset_mps2)

A session keeps the raw rate, and the calibration that was in use. Analyses apply that calibration once; the service
applies the calibration of its config.
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from datetime import UTC, datetime
from math import isnan, nan
from pathlib import Path
from typing import Annotated, Any, Literal

from annotated_types import Ge, Gt, Le, MaxLen

from gyrodrift.values.sample import DeviceYaw, Inertial, Sample, upside_down
from gyrodrift.values.vectors import Vector, numbers_in, product, solution

OLD_DAYS = 365.0
"""Age from which a calibration is reported as old; it is still applied.

Scale factors of MEMS gyros age by up to some tenths of a percent a year.
"""

BY_ID = "/dev/serial/by-id"

Scale = Annotated[float, Ge(0.5), Le(2.0)]
Spread = Annotated[float, Ge(0.0), Le(1.0)]
BiasDps = Annotated[float, Ge(-100.0), Le(100.0)]
TempC = Annotated[float, Ge(-100.0), Le(200.0)]
OffsetMps2 = Annotated[float, Ge(-20.0), Le(20.0)]
Share = Annotated[float, Ge(-2.0), Le(2.0)]
Row = tuple[Share, Share, Share]
SpreadRow = tuple[Spread, Spread, Spread]

AXES_SHAPES: dict[str, tuple[int, ...]] = {
    "accel_offset_mps2": (3,),
    "accel_offset_se_mps2": (3,),
    "accel_scale": (3,),
    "accel_scale_se": (3,),
    "gyro_bias_xy_dps": (2,),
    "gyro_bias_xy_se_dps": (2,),
    "gyro_matrix": (3, 3),
    "gyro_matrix_se": (3, 3),
}
"""Shapes of the values of three axes; all are None in the calibration of one axis."""


@dataclass(frozen=True, slots=True)
class Calibration:
    """Calibration as in a config; values that were not measured are None.

    date
        Time of the calibration, ISO 8601 in UTC.
    device_id
        Name that the device sends, or name of its adapter; empty without both.
    sign
        −1 for a device that counts clockwise turns as positive.
    scale_ccw, scale_cw
        True rate over measured rate, counter-clockwise and clockwise.
    scale_ccw_se, scale_cw_se
        Standard errors of both, from the scatter of the turns, including the stops at the mark.
    bias_dps, bias_se_dps
        Measured rate at rest, deg/s, in the sign of the device, and its standard error.
    temp_c
        Temperature of `bias_dps`, °C.
    bias_dps_per_c, bias_dps_per_c_se
        Slope of the bias, deg/s per °C, and its standard error; 0 without a temperature run.
    temp_low_c, temp_high_c
        Range of the temperature run, °C; outside, the bias of the nearer end applies.
    noise_dps_rthz
        White noise at rest, deg/s/√Hz.
    dps_per_lsb
        Smallest step of the rate, deg/s.
    turns, repeats
        Whole turns at a time, and repeats per direction.
    mark_deg
        Standard deviation of a stop at the mark, degrees.
    accel_offset_mps2, accel_offset_se_mps2
        Measured acceleration of x, y and z without any force, m/s², and its standard errors.
    accel_scale, accel_scale_se
        True acceleration over measured acceleration without offset, of x, y and z, and its standard errors.
    gyro_bias_xy_dps, gyro_bias_xy_se_dps
        Measured rates about x and y at rest, deg/s, and their standard errors; the bias about z is `bias_dps`.
    gyro_matrix, gyro_matrix_se
        Rates in the frame of the accelerometer from measured rates without bias, rows x, y and z, and its standard
        errors.
    """

    date: Annotated[str, MaxLen(40)]
    device_id: Annotated[str, MaxLen(200)] = ""
    sign: Literal[1, -1] = 1
    scale_ccw: Scale = 1.0
    scale_ccw_se: Spread | None = None
    scale_cw: Scale = 1.0
    scale_cw_se: Spread | None = None
    bias_dps: BiasDps = 0.0
    bias_se_dps: Annotated[float, Ge(0.0), Le(10.0)] | None = None
    temp_c: TempC | None = None
    bias_dps_per_c: Annotated[float, Ge(-10.0), Le(10.0)] = 0.0
    bias_dps_per_c_se: Annotated[float, Ge(0.0), Le(10.0)] | None = None
    temp_low_c: TempC | None = None
    temp_high_c: TempC | None = None
    noise_dps_rthz: Annotated[float, Ge(0.0), Le(100.0)] | None = None
    dps_per_lsb: Annotated[float, Gt(0.0), Le(100.0)] | None = None
    turns: Annotated[int, Ge(1), Le(1000)] | None = None
    repeats: Annotated[int, Ge(1), Le(1000)] | None = None
    mark_deg: Annotated[float, Ge(0.0), Le(360.0)] | None = None
    accel_offset_mps2: tuple[OffsetMps2, OffsetMps2, OffsetMps2] | None = None
    accel_offset_se_mps2: SpreadRow | None = None
    accel_scale: tuple[Scale, Scale, Scale] | None = None
    accel_scale_se: SpreadRow | None = None
    gyro_bias_xy_dps: tuple[BiasDps, BiasDps] | None = None
    gyro_bias_xy_se_dps: tuple[Spread, Spread] | None = None
    gyro_matrix: tuple[Row, Row, Row] | None = None
    gyro_matrix_se: tuple[SpreadRow, SpreadRow, SpreadRow] | None = None

    @property
    def scale_sigma(self) -> float | None:
        """Larger standard error of the two scales, as a fraction; None if not measured."""
        return max((se for se in (self.scale_ccw_se, self.scale_cw_se) if se is not None), default=None)

    @property
    def axes_scale_sigma(self) -> float | None:
        """Largest standard error of the scale of an axis, as a fraction; None without a matrix of the gyro."""
        return None if self.gyro_matrix_se is None else max(self.gyro_matrix_se[axis][axis] for axis in range(3))

    def rate_dps(self, measured_dps: float, temp_c: float = nan) -> float:
        """True rate for a measured rate, deg/s; without a temperature, with the bias at `temp_c`."""
        return self.of_rest_dps(measured_dps - self.bias_at_dps(temp_c))

    def of_rest_dps(self, measured_dps: float) -> float:
        """True rate for a measured rate without bias, deg/s."""
        signed_dps = self.sign * measured_dps
        return signed_dps * (self.scale_ccw if signed_dps >= 0.0 else self.scale_cw)

    def bias_at_dps(self, temp_c: float) -> float:
        """Bias at a temperature, deg/s; outside the temperature run, the bias of its nearer end."""
        if not self.bias_dps_per_c or self.temp_c is None or isnan(temp_c):
            return self.bias_dps
        low_c = temp_c if self.temp_low_c is None else max(temp_c, self.temp_low_c)
        inside_c = low_c if self.temp_high_c is None else min(low_c, self.temp_high_c)
        return self.bias_dps + self.bias_dps_per_c * (inside_c - self.temp_c)

    def sample(self, measured: Sample) -> Sample:
        """Sample with its true rate, and with the true rates and accelerations of all axes that it has.

        The device's own yaw only gets the sign: its filter has not this calibration.
        """
        if measured.device_yaw is not None and self.sign < 0:
            yaw_deg, sigma_deg, bias_dps = measured.device_yaw
            measured = measured._replace(device_yaw=DeviceYaw(-yaw_deg, sigma_deg, -bias_dps))
        if measured.inertial is None:
            return measured._replace(rate_dps=self.rate_dps(measured.rate_dps, measured.temp_c))
        inertial = self.inertial(measured.inertial, measured.temp_c)
        return measured._replace(rate_dps=inertial.gyro_z_dps, inertial=inertial)

    def inertial(self, measured: Inertial, temp_c: float = nan) -> Inertial:
        """True rates and accelerations; a device with `sign` −1 is upside down."""
        x_dps, y_dps, z_dps, x_mps2, y_mps2, z_mps2 = measured
        z_dps -= self.bias_at_dps(temp_c)
        if self.gyro_bias_xy_dps is not None:
            x_dps, y_dps = x_dps - self.gyro_bias_xy_dps[0], y_dps - self.gyro_bias_xy_dps[1]
        if self.gyro_matrix is not None:
            x_dps, y_dps, z_dps = product(self.gyro_matrix, x_dps, y_dps, z_dps)
        if self.accel_offset_mps2 is not None:
            x0_mps2, y0_mps2, z0_mps2 = self.accel_offset_mps2
            x_mps2, y_mps2, z_mps2 = x_mps2 - x0_mps2, y_mps2 - y0_mps2, z_mps2 - z0_mps2
        if self.accel_scale is not None:
            x_scale, y_scale, z_scale = self.accel_scale
            x_mps2, y_mps2, z_mps2 = x_mps2 * x_scale, y_mps2 * y_scale, z_mps2 * z_scale
        corrected = Inertial(x_dps, y_dps, z_dps, x_mps2, y_mps2, z_mps2)
        upright = corrected if self.sign > 0 else upside_down(corrected)
        return upright._replace(gyro_z_dps=self.of_rest_dps(z_dps))

    def measured_dps(self, rate_dps: float, temp_c: float = nan) -> float:
        """Measured rate about z for a true rate of a device with one axis, deg/s."""
        return self.bias_at_dps(temp_c) + self.sign * rate_dps / self._scale_of(rate_dps)

    def measured_xyz_dps(self, rates_dps: Vector, temp_c: float = nan) -> Vector:
        """Measured rates about x, y and z for true rates, deg/s."""
        x_dps, y_dps, z_dps = rates_dps
        sensor_dps = (x_dps, self.sign * y_dps, self.sign * z_dps / self._scale_of(z_dps))
        rest_dps = sensor_dps if self.gyro_matrix is None else solution(self.gyro_matrix, sensor_dps)
        x_bias_dps, y_bias_dps = self.gyro_bias_xy_dps or (0.0, 0.0)
        return rest_dps[0] + x_bias_dps, rest_dps[1] + y_bias_dps, rest_dps[2] + self.bias_at_dps(temp_c)

    def _scale_of(self, rate_dps: float) -> float:
        return self.scale_ccw if rate_dps >= 0.0 else self.scale_cw

    def following(self, old: "Calibration", bias_dps: float | Vector, temp_c: float = nan) -> "Calibration":
        """Copy with a bias that keeps the estimate of a filter valid that ran with an old calibration.

        `bias_dps` is the estimate of the filter, deg/s, at `temp_c`, °C: of one axis, or about x, y and z.
        """
        if isinstance(bias_dps, tuple):
            before, after = (c.measured_xyz_dps(bias_dps, temp_c) for c in (old, self))
            x_dps, y_dps = self.gyro_bias_xy_dps or (0.0, 0.0)
            shifted = x_dps + before[0] - after[0], y_dps + before[1] - after[1]
            return replace(self, bias_dps=self.bias_dps + before[2] - after[2], gyro_bias_xy_dps=shifted)
        rest_dps = old.measured_dps(bias_dps, temp_c)
        return replace(self, bias_dps=self.bias_dps + rest_dps - self.measured_dps(bias_dps, temp_c))

    def keeping_axes(self, old: "Calibration | None") -> "Calibration":
        """Copy of a calibration of one axis with the accelerometer and the level axes of an old one of the device.

        `gyro_matrix` contains the scale of z, so the new scale replaces it.
        """
        if old is None or not old.is_for(self.device_id):
            return self
        kept = {name: getattr(old, name) for name in AXES_SHAPES if not name.startswith("gyro_matrix")}
        return replace(self, **kept)

    @property
    def has_axes(self) -> bool:
        """Whether a value of three axes was measured."""
        return any(getattr(self, name) is not None for name in AXES_SHAPES)

    def age_days(self, now: datetime) -> float:
        """Age, days."""
        return (now - moment(self.date)).total_seconds() / 86400.0

    def is_for(self, device_id: str) -> bool:
        """Whether it applies to a device: the ids are equal, or one of them is empty."""
        return not (self.device_id and device_id) or self.device_id == device_id

    def table(self) -> dict[str, str]:
        """Metadata of a session."""
        return {
            name: json.dumps(value) if name in AXES_SHAPES else str(value)
            for name, value in self.values().items()
            if value is not None
        }

    def values(self) -> dict[str, Any]:
        """All values by name; those of three axes only if they were measured."""
        named = {field.name: getattr(self, field.name) for field in fields(self)}
        return {name: value for name, value in named.items() if name not in AXES_SHAPES or value is not None}


NO_CALIBRATION = Calibration(date="")
"""Calibration that changes nothing."""


def calibration_of_table(table: Mapping[str, str]) -> Calibration:
    """Calibration from the metadata of a session; unknown names are ignored.

    Raises
    ------
    ValueError
        A value is not a number, or does not have the shape of its name.
    """
    names = {field.name for field in fields(Calibration)}
    return replace(NO_CALIBRATION, **{name: _value_of(name, table[name]) for name in names & table.keys()})


def _value_of(name: str, text: str) -> Any:
    if name in ("date", "device_id"):
        return text
    if name in AXES_SHAPES:
        return numbers_in(text, AXES_SHAPES[name], name)
    return int(text) if name in ("sign", "turns", "repeats") else float(text)


def moment(date: str) -> datetime:
    """Moment of a date in ISO 8601, in UTC without a time zone.

    Raises
    ------
    ValueError
        It is not a date.
    """
    when = datetime.fromisoformat(date)
    return when if when.tzinfo else when.replace(tzinfo=UTC)


def of_this_device(given: Calibration | None, device_id: str | None, port: str) -> Calibration | None:
    """The calibration if it applies to the device at a port, else None."""
    return given if given is not None and given.is_for(device_identity(device_id, port)) else None


def device_identity(device_id: str | None, port: str) -> str:
    """Id of a device: the name it sends, else the name of its adapter; empty without both."""
    return device_id or (Path(port).name if port.startswith(BY_ID) else "")
