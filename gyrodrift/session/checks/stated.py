"""What a person states of how recordings are to be read, whatever their header says: columns, units and sign."""

from dataclasses import dataclass, replace

from gyrodrift.columns.spec import RATE, Column, scale_of
from gyrodrift.session.session import Session

TIME_UNITS = ("s", "ms", "us", "ns")
"""A factor of a thousand apart."""


@dataclass(frozen=True, slots=True)
class ReadingOptions:
    """What was stated; empty where a recording is taken as it says.

    columns
        What the columns of tables are; None where their headers say it.
    rate_unit
        A unit of RATE_DPS, or lsb/N.
    time_unit
        One of TIME_UNITS.
    is_flipped
        Whether the rates have the other sign.
    """

    columns: tuple[Column, ...] | None = None
    rate_unit: str = ""
    time_unit: str = ""
    is_flipped: bool = False

    @property
    def states_rate(self) -> bool:
        """Whether a person vouches for the rates."""
        return bool(self.rate_unit) or self.is_flipped

    def applied(self, session: Session) -> Session:
        """The session in deg/s and seconds by what was stated of its units."""
        rate_scale, time_unit = session.rate_scale, session.time_unit
        factor = -1.0 if self.is_flipped else 1.0
        if self.rate_unit:
            rate_scale = scale_of(RATE, self.rate_unit) or 1.0
            factor *= rate_scale / session.rate_scale
        t_s = session.t_device_s
        if self.time_unit and self.time_unit != time_unit:
            t_s = t_s * 1e-3 ** (TIME_UNITS.index(self.time_unit) - TIME_UNITS.index(time_unit))
            time_unit = self.time_unit
        rate_dps = session.rate_dps if factor == 1.0 else session.rate_dps * factor
        return replace(session, t_device_s=t_s, rate_dps=rate_dps, rate_scale=rate_scale, time_unit=time_unit)


AS_WRITTEN = ReadingOptions()
