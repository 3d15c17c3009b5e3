"""Time unit of a recording: milliseconds, microseconds or nanoseconds mistaken for seconds."""

from collections.abc import Sequence

import numpy as np

from gyrodrift.session.checks.finding import SessionFinding
from gyrodrift.session.checks.stated import TIME_UNITS
from gyrodrift.session.session import Session
from gyrodrift.values.arrays import Floats

NAMES = {"s": "seconds", "ms": "milliseconds", "us": "microseconds", "ns": "nanoseconds"}

SLOWEST_HZ, FASTEST_HZ = 1.0, 20_000.0
"""Sample rates of gyros, from a logger with a sample per second to more than the 8 kHz of an ICM-42688."""

WITHIN = 0.1
"""Share by which a sample rate may exceed these limits."""

USUAL_HZ = 100.0

PACE_ERROR = 0.2
"""A larger relative difference between two clocks is no clock drift."""

PACE_LEAST_S = 2.0
LEAST_STEPS = 20
"""Least number of time steps for a check."""

SAME_PACE = 3.0


def clock_unit_findings(session: Session, *, is_stated: bool) -> tuple[SessionFinding, ...]:
    """Finding about the unit of the times; empty if it is plausible.

    is_stated
        Whether the user states the unit: then the finding is no error.
    """
    t_s, read_as = session.t_device_s, session.time_unit
    steps_s = np.diff(t_s)
    forward_s = steps_s[(steps_s > 0.0) & np.isfinite(steps_s)]
    if len(forward_s) < LEAST_STEPS:
        return ()
    rates_hz = 1.0 / float(np.median(forward_s)), len(steps_s) / float(forward_s.sum())
    least_hz = SLOWEST_HZ * (1.0 + WITHIN if _is_whole(t_s) else 1.0 - WITHIN)
    if least_hz <= max(rates_hz) and min(rates_hz) <= FASTEST_HZ * (1.0 + WITHIN):
        return _host_pace(session)
    pace, hz = _pace(session), rates_hz[0]
    if pace is not None and _is_near(pace):  # the host clock confirms it
        return ()
    says = f"its times make {hz:.3g} Hz, if they are {NAMES[read_as]}; a gyro has {SLOWEST_HZ:g} to {FASTEST_HZ:g} Hz"
    units = _fitting(session, read_as, hz)
    options = " or ".join(f"--time-unit {unit} ({hz * _factor(read_as, unit):.4g} Hz)" for unit in units)
    do = f"if they are {' or '.join(NAMES[unit] for unit in units)}, use {options}" if units else OTHER_COLUMN
    if read_as not in units and max(rates_hz) >= SLOWEST_HZ * (1.0 - WITHIN):
        do += f"; --time-unit {read_as}, if it is {hz:.3g} Hz"
    return (SessionFinding("clock_unit", says, do, is_error=not is_stated),)


OTHER_COLUMN = "name the column of the time with --columns, or write it in seconds"


def _is_whole(t_s: Floats) -> bool:
    finite_s = t_s[np.isfinite(t_s)]
    return bool(np.all(finite_s == np.rint(finite_s)))


def _factor(read_as: str, unit: str) -> float:
    """Factor of the sample rate if the times are in another unit."""
    return 1e3 ** (TIME_UNITS.index(unit) - TIME_UNITS.index(read_as))


def _fitting(session: Session, read_as: str, hz: float) -> list[str]:
    """Other units that give a sample rate of a gyro; best match to the host clock or to usual rates first."""

    def distance(unit: str) -> float:
        return abs(float(np.log(hz * _factor(read_as, unit) / USUAL_HZ)))

    def is_usual(unit: str) -> bool:
        rate_hz = hz * _factor(read_as, unit)
        return SLOWEST_HZ * (1.0 - WITHIN) <= rate_hz <= FASTEST_HZ * (1.0 + WITHIN)

    units = sorted((unit for unit in TIME_UNITS if unit != read_as and is_usual(unit)), key=distance)
    pace = _pace(session)
    by_host = [] if pace is None else [unit for unit in units if _is_near(pace / _factor(read_as, unit))]
    return by_host or units


def _is_near(pace: float) -> bool:
    return 1.0 / SAME_PACE < pace < SAME_PACE


def _pace(session: Session) -> float | None:
    """Device seconds per second of the host clock; None without one."""
    spans_s = _spans_s(session)
    return None if spans_s is None else spans_s[0] / spans_s[1]


def _spans_s(session: Session) -> Sequence[float] | None:
    """Duration by the device clock and by the host clock, s; None if unknown."""
    if session.t_host_s is None:
        return None
    is_timed = np.isfinite(session.t_device_s) & np.isfinite(session.t_host_s)
    if np.count_nonzero(is_timed) < 2:
        return None
    device_s, host_s = (float(np.ptp(times[is_timed])) for times in (session.t_device_s, session.t_host_s))
    return (device_s, host_s) if host_s > 0.0 else None


def _host_pace(session: Session) -> tuple[SessionFinding, ...]:
    """Warning if the two clocks run at different paces; a replay may do so rightly."""
    spans_s = _spans_s(session)
    if spans_s is None or min(spans_s) < PACE_LEAST_S or abs(spans_s[0] / spans_s[1] - 1.0) <= PACE_ERROR:
        return ()
    says = f"the device counted {spans_s[0]:.4g} s while the host counted {spans_s[1]:.4g} s"
    return (SessionFinding("clock_pace", says, "unless it is a replay, one of them is wrong, and yaw with it"),)
