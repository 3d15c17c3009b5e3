"""What is known of one gyro from its calibration, and its rate put right by that.

    rate = sign · scale · (measured − bias(T))        scale is that of the direction in which the device turns
    bias(T) = bias_dps + bias_dps_per_c · (T − temp_c)

A session keeps the rate as the device sent it, and beside it the table of the calibration under which it was taken.
Whoever filters or judges a session applies that table once; the service applies the one of its config.
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from datetime import UTC, datetime
from math import isnan, nan
from pathlib import Path
from typing import Annotated, Any, Literal

from annotated_types import Ge, Gt, Le, MaxLen

from gyrodrift.sample import Sample

OLD_DAYS = 365.0
"""Scale factors of MEMS gyros age by up to some tenths of a percent a year; an older calibration is still the best
there is, and is warned of."""

BY_ID = "/dev/serial/by-id"

Scale = Annotated[float, Ge(0.5), Le(2.0)]
Spread = Annotated[float, Ge(0.0), Le(1.0)]
BiasDps = Annotated[float, Ge(-100.0), Le(100.0)]
TempC = Annotated[float, Ge(-100.0), Le(200.0)]


@dataclass(frozen=True, slots=True)
class Calibration:
    """A calibration as it stands in a config; what was not measured is None.

    date
        When it was made, ISO 8601 in UTC.
    device_id
        Of which device, by the name it sends or by that of its adapter; empty where it has neither.
    sign
        −1 for a device that counts clockwise turns as positive.
    scale_ccw, scale_cw
        True rate over measured rate, counter-clockwise and clockwise.
    scale_ccw_se, scale_cw_se
        Standard errors of both, from how the turns repeat: the stop at the mark is part of them.
    bias_dps, bias_se_dps
        Measured rate at rest, deg/s, in the device's own sign, and its standard error.
    temp_c
        Temperature that the bias belongs to, °C.
    bias_dps_per_c, bias_dps_per_c_se
        Slope of the bias, deg/s per °C, and its standard error; 0 without a temperature run.
    temp_low_c, temp_high_c
        Range of the temperature run, °C; outside of it the bias is that of the nearer end.
    noise_dps_rthz
        White noise at rest, deg/s/√Hz.
    dps_per_lsb
        Smallest step of the rate, deg/s.
    turns, repeats
        Whole turns at a time, and how often each direction was turned.
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
        """Larger standard error of the two scales, as a share; None where none was measured."""
        return max((se for se in (self.scale_ccw_se, self.scale_cw_se) if se is not None), default=None)

    def rate_dps(self, measured_dps: float, temp_c: float = nan) -> float:
        """True rate of a measured one, deg/s; without a temperature the bias is that at `temp_c`."""
        return self.of_rest_dps(measured_dps - self.bias_at_dps(temp_c))

    def of_rest_dps(self, measured_dps: float) -> float:
        """True rate of a measured one that is without bias already, deg/s."""
        turned_dps = self.sign * measured_dps
        return turned_dps * (self.scale_ccw if turned_dps >= 0.0 else self.scale_cw)

    def bias_at_dps(self, temp_c: float) -> float:
        """Bias at a temperature, deg/s; at the nearer end of the temperature run outside of it."""
        if not self.bias_dps_per_c or self.temp_c is None or isnan(temp_c):
            return self.bias_dps
        low_c = temp_c if self.temp_low_c is None else max(temp_c, self.temp_low_c)
        inside_c = low_c if self.temp_high_c is None else min(low_c, self.temp_high_c)
        return self.bias_dps + self.bias_dps_per_c * (inside_c - self.temp_c)

    def sample(self, measured: Sample) -> Sample:
        """A sample with its true rate."""
        return measured._replace(rate_dps=self.rate_dps(measured.rate_dps, measured.temp_c))

    def measured_dps(self, rate_dps: float, temp_c: float = nan) -> float:
        """What the device measures at a true rate, deg/s."""
        return self.bias_at_dps(temp_c) + self.sign * rate_dps / (self.scale_ccw if rate_dps >= 0.0 else self.scale_cw)

    def following(self, old: "Calibration", bias_dps: float, temp_c: float = nan) -> "Calibration":
        """The same for a filter that has run under an old one: with the bias at which its own estimate stays right.

        `bias_dps` is what the filter has found, deg/s, at a temperature in °C.
        """
        found_dps = old.measured_dps(bias_dps, temp_c)
        return replace(self, bias_dps=self.bias_dps + found_dps - self.measured_dps(bias_dps, temp_c))

    def age_days(self, now: datetime) -> float:
        """How old it is, days."""
        return (now - moment(self.date)).total_seconds() / 86400.0

    def is_for(self, device_id: str) -> bool:
        """Whether it may be applied to a device: one of the same id, or where either has none."""
        return not (self.device_id and device_id) or self.device_id == device_id

    def table(self) -> dict[str, str]:
        """As a session keeps it."""
        named = {each.name: getattr(self, each.name) for each in fields(self)}
        return {name: str(value) for name, value in named.items() if value is not None}


NO_CALIBRATION = Calibration(date="")
"""Every rate as it was measured."""


def calibration_of_table(table: Mapping[str, str]) -> Calibration:
    """What a session keeps; names that this version does not know are passed over.

    Raises
    ------
    ValueError
        Where a number is none.
    """
    known = {each.name for each in fields(Calibration)}
    texts, whole = {"date", "device_id"}, {"sign", "turns", "repeats"}
    given: dict[str, Any] = {}
    for name in known & table.keys():
        text = table[name]
        given[name] = text if name in texts else int(text) if name in whole else float(text)
    return replace(NO_CALIBRATION, **given)


def moment(date: str) -> datetime:
    """A date in ISO 8601 as a moment, in UTC where it does not say.

    Raises
    ------
    ValueError
        Where it is none.
    """
    found = datetime.fromisoformat(date)
    return found if found.tzinfo else found.replace(tzinfo=UTC)


def of_this_device(given: Calibration | None, device_id: str | None, port: str) -> Calibration | None:
    """The calibration, where it is that of the device at a port; None where it is another one's, or there is none."""
    return given if given is not None and given.is_for(device_identity(device_id, port)) else None


def device_identity(device_id: str | None, port: str) -> str:
    """What a device is known by: the name it sends, or else that of its adapter; empty where it has neither."""
    return device_id or (Path(port).name if port.startswith(BY_ID) else "")
