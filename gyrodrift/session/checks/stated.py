"""Columns, units and sign that the user states for recordings, regardless of their header."""

from dataclasses import dataclass, replace
from pathlib import Path

from gyrodrift.columns.spec import ACCELERATION, CLOCK, COUNTED_US, RATE, Column, scale_of
from gyrodrift.columns.times import StatedClock
from gyrodrift.session.files import load_session
from gyrodrift.session.session import Session
from gyrodrift.session.tables.clocks import paced
from gyrodrift.values.errors import UsageError

COUNTER, HOST_TIMES, TEMPERATURE = "counter", "host times", "temperature"
"""Columns that a reader may leave out."""

TIME_UNITS = ("s", "ms", "us", "ns", "days")
"""Units of device times that a recording may be in by mistake."""


@dataclass(frozen=True, slots=True)
class ReadingOptions:
    """Statements of the user; empty values leave it to the recording.

    columns
        Meaning of the columns of tables; None leaves it to their headers.
    rate_unit
        A unit of RATE_DPS, or lsb/N.
    time_unit
        One of CLOCK_UNITS_US, or lsb/N for N ticks per second.
    sample_rate_hz
        Rate of the samples, in place of the clock; a counter shows lost ones. 0 leaves it to the clock.
    accel_unit
        A unit of ACCELERATION_MPS2, or lsb/N.
    is_flipped
        Whether the sign of the rates is reversed.
    reference
        Topic of a bag or .mcap file with the reference angle; empty for none.
    without
        Columns that are left out: COUNTER, HOST_TIMES or TEMPERATURE.
    """

    columns: tuple[Column, ...] | None = None
    rate_unit: str = ""
    time_unit: str = ""
    is_flipped: bool = False
    accel_unit: str = ""
    reference: str = ""
    without: frozenset[str] = frozenset()
    sample_rate_hz: float = 0.0

    @property
    def states_rate(self) -> bool:
        """Whether the user states unit or sign of the rates."""
        return bool(self.rate_unit) or self.is_flipped

    def applied(self, session: Session) -> Session:
        """The session in deg/s and s, with the stated units."""
        rate_scale, time_unit = session.rate_scale, session.time_unit
        if self.rate_unit:
            rate_scale = scale_of(RATE, self.rate_unit) or 1.0
            session = session.scaled(rate_scale / session.rate_scale)
        if self.accel_unit and session.accel_mps2 is not None:
            accel_scale = scale_of(ACCELERATION, self.accel_unit) or 1.0
            accel_mps2 = session.accel_mps2 * (accel_scale / session.accel_scale)
            session = replace(session, accel_mps2=accel_mps2, accel_scale=accel_scale)
        if self.is_flipped:
            session = session.upside_down()
        t_s = session.t_device_s
        if self.sample_rate_hz:
            t_s = paced(len(t_s), session.seq, self.sample_rate_hz)
        elif self.time_unit and self.time_unit != time_unit:
            t_s, time_unit = t_s * time_factor(time_unit, self.time_unit), self.time_unit
        session = replace(session.timed(t_s), rate_scale=rate_scale, time_unit=time_unit)
        return self._without(session) if self.without else session

    def _without(self, session: Session) -> Session:
        return replace(
            session,
            seq=None if COUNTER in self.without else session.seq,
            t_host_s=None if HOST_TIMES in self.without else session.t_host_s,
            temp_c=None if TEMPERATURE in self.without else session.temp_c,
        )


def time_factor(read_as: str, unit: str) -> float:
    """Factor of times that were read in one unit and are in another.

    Raises
    ------
    UsageError
        The unit is one of texts, and these times are numbers.
    """
    if unit == "hms" or unit in COUNTED_US:
        raise UsageError(f"--time-unit {unit}: is for tables of other programs; these times are numbers")
    return (scale_of(CLOCK, unit) or 1.0) / (scale_of(CLOCK, read_as) or 1.0)


def session_as_stated(path: Path, reading: "ReadingOptions", *, allow_damage: bool = True) -> Session:
    """Load a session with the columns, units and reference that the user states.

    Raises
    ------
    DamagedError, DataError
        As `load_session`.
    """
    clock = StatedClock(reading.time_unit, reading.sample_rate_hz)
    session = load_session(path, reading.columns, reference=reading.reference, allow_damage=allow_damage, clock=clock)
    return reading.applied(session)


AS_WRITTEN = ReadingOptions()
