"""Calibration of a gyro: its values, and the corrected rate.

    rate = sign · scale · (measured − bias(T))        scale of the present direction of turning
    bias(T) = bias_dps + bias_dps_per_c · (T − temp_c)

A session keeps the raw rate, and the calibration that was in use. Analyses apply that calibration once; the service
applies the calibration of its config.
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from datetime import UTC, datetime
from math import isnan, nan
from pathlib import Path
from typing import Annotated, Any, Literal

from annotated_types import Ge, Gt, Le, MaxLen

from gyrodrift.sample import Sample, upside_down

OLD_DAYS = 365.0
"""Age from which a calibration is reported as old; it is still applied.

Scale factors of MEMS gyros age by up to some tenths of a percent a year.
"""

BY_ID = "/dev/serial/by-id"

Scale = Annotated[float, Ge(0.5), Le(2.0)]
Spread = Annotated[float, Ge(0.0), Le(1.0)]
BiasDps = Annotated[float, Ge(-100.0), Le(100.0)]
TempC = Annotated[float, Ge(-100.0), Le(200.0)]


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

    @property
    def scale_sigma(self) -> float | None:
        """Larger standard error of the two scales, as a fraction; None if not measured."""
        return max((se for se in (self.scale_ccw_se, self.scale_cw_se) if se is not None), default=None)

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
        """Sample with its true rate, also about the z axis of a device with three axes."""
        rate_dps = self.rate_dps(measured.rate_dps, measured.temp_c)
        if measured.inertial is None:
            return measured._replace(rate_dps=rate_dps)
        inertial = measured.inertial if self.sign > 0 else upside_down(measured.inertial)
        return measured._replace(rate_dps=rate_dps, inertial=inertial._replace(gyro_z_dps=rate_dps))

    def measured_dps(self, rate_dps: float, temp_c: float = nan) -> float:
        """Measured rate for a true rate, deg/s."""
        return self.bias_at_dps(temp_c) + self.sign * rate_dps / (self.scale_ccw if rate_dps >= 0.0 else self.scale_cw)

    def following(self, old: "Calibration", bias_dps: float, temp_c: float = nan) -> "Calibration":
        """Copy with a bias that keeps the estimate of a filter valid that ran with an old calibration.

        `bias_dps` is the estimate of the filter, deg/s, at `temp_c`, °C.
        """
        rest_dps = old.measured_dps(bias_dps, temp_c)
        return replace(self, bias_dps=self.bias_dps + rest_dps - self.measured_dps(bias_dps, temp_c))

    def age_days(self, now: datetime) -> float:
        """Age, days."""
        return (now - moment(self.date)).total_seconds() / 86400.0

    def is_for(self, device_id: str) -> bool:
        """Whether it applies to a device: the ids are equal, or one of them is empty."""
        return not (self.device_id and device_id) or self.device_id == device_id

    def table(self) -> dict[str, str]:
        """Metadata of a session."""
        named = {field.name: getattr(self, field.name) for field in fields(self)}
        return {name: str(value) for name, value in named.items() if value is not None}


NO_CALIBRATION = Calibration(date="")
"""Calibration that changes nothing."""


def calibration_of_table(table: Mapping[str, str]) -> Calibration:
    """Calibration from the metadata of a session; unknown names are ignored.

    Raises
    ------
    ValueError
        A value is not a number.
    """
    names = {field.name for field in fields(Calibration)}
    texts, whole = {"date", "device_id"}, {"sign", "turns", "repeats"}
    given: dict[str, Any] = {}
    for name in names & table.keys():
        text = table[name]
        given[name] = text if name in texts else int(text) if name in whole else float(text)
    return replace(NO_CALIBRATION, **given)


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
