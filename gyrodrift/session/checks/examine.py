"""All checks of a recording, in their order of dependence, and the findings about its readings."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from gyrodrift.columns.accel_axes import AGREES, TurningAxisCheck
from gyrodrift.columns.sizes import FREE_SHARE, SAMPLE_RATES_HZ, gravity_unit, is_gravity
from gyrodrift.facts.readings import JudgedReadings
from gyrodrift.facts.session_facts import SessionFacts
from gyrodrift.session.calibrated import calibrated
from gyrodrift.session.checks.finding import SessionFinding
from gyrodrift.session.checks.rate_unit import rate_findings, recorded_samples
from gyrodrift.session.checks.restarts import one_clock
from gyrodrift.session.checks.stated import AS_WRITTEN, TIME_UNITS, ReadingOptions, time_factor
from gyrodrift.session.session import Session
from gyrodrift.values.arrays import Floats
from gyrodrift.values.constants import STANDARD_GRAVITY_MPS2
from gyrodrift.values.errors import DataError
from gyrodrift.values.words import counted

NAMES = {"s": "seconds", "ms": "milliseconds", "us": "microseconds", "ns": "nanoseconds", "days": "days"}

SLOWEST_HZ, FASTEST_HZ = SAMPLE_RATES_HZ

WITHIN = 0.1
"""Share by which a sample rate may exceed these limits."""

USUAL_HZ = 100.0

PACE_ERROR = 0.2
"""A larger relative difference between two clocks is no clock drift."""

PACE_LEAST_S = 2.0
LEAST_STEPS = 20
"""Least number of time steps for a check."""

SAME_PACE = 3.0

OTHER_COLUMN = "name the column of the time with --columns, or state the rate of the samples with --sample-rate HZ"

UPSIDE_DOWN = -0.7
"""Median of the z component over the length: z points down by 135° of tilt or more."""

MOST_NAMED = 3
"""Number of hangs that are named one by one."""


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
    unit = NAMES.get(read_as, read_as)
    says = f"its times make {hz:.3g} Hz, if they are {unit}; a gyro has {SLOWEST_HZ:g} to {FASTEST_HZ:g} Hz"
    units = _fitting(session, read_as, hz)
    options = " or ".join(f"--time-unit {unit} ({hz * _factor(read_as, unit):.4g} Hz)" for unit in units)
    do = f"if they are {' or '.join(NAMES[unit] for unit in units)}, use {options}" if units else OTHER_COLUMN
    if read_as not in units and SLOWEST_HZ * (1.0 - WITHIN) <= max(rates_hz) < USUAL_HZ:
        do += f"; --time-unit {read_as}, if it is {hz:.3g} Hz"
    return (SessionFinding("clock_unit", says, do, is_error=not is_stated),)


def _is_whole(t_s: Floats) -> bool:
    finite_s = t_s[np.isfinite(t_s)]
    return bool(np.all(finite_s == np.rint(finite_s)))


def _factor(read_as: str, unit: str) -> float:
    """Factor of the sample rate if the times are in another unit."""
    return 1.0 / time_factor(read_as, unit)


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


def acceleration_findings(facts: SessionFacts, *, is_stated: bool) -> Iterator[SessionFinding]:
    """Findings about the accelerations of a session in m/s²; none without them.

    is_stated
        Whether the user states their unit.
    """
    session = facts.session
    forces = np.empty((0, 3)) if session.accel_mps2 is None else session.accel_mps2
    forces = forces[np.isfinite(forces).all(axis=1)]
    if not len(forces):
        return
    length_mps2 = float(np.median(np.linalg.norm(forces, axis=1)))
    if is_gravity(length_mps2):
        yield from _direction(forces, length_mps2)
    elif not is_stated:
        yield _unit(length_mps2, length_mps2 / session.accel_scale)


def _unit(length_mps2: float, length: float) -> SessionFinding:
    """Finding about accelerations whose median length is not gravity; `length` is in the unit of the file."""
    if unit := gravity_unit(length):
        says = f"accelerations have a median length of {length:.4g}, which is gravity in {unit}"
        return SessionFinding("accel_unit", says, f"use --accel-unit {unit}")
    if length_mps2 < FREE_SHARE * STANDARD_GRAVITY_MPS2:
        says = (
            f"accelerations have a median length of {length_mps2:.4g} m/s²: gravity is missing, so the tilt is unknown"
        )
        return SessionFinding("accel_gravity", says, "record the accelerometer itself, not linear acceleration")
    says = f"accelerations have a median length of {length_mps2:.4g} m/s², gravity is 9.81"
    return SessionFinding("accel_unit", says, f"use --accel-unit lsb/{length:.4g} if they are counts")


def _direction(forces: Floats, length_mps2: float) -> Iterator[SessionFinding]:
    z_mps2 = float(np.median(forces[:, 2]))
    if z_mps2 < UPSIDE_DOWN * length_mps2:
        says = f"z measures {z_mps2:.3g} m/s²: the sensor is upside down, or it reports gravity with the opposite sign"
        yield SessionFinding("accel_sign", says, "if it stands upright, invert ax, ay and az with --columns")


def axis_findings(facts: SessionFacts) -> Iterator[SessionFinding]:
    """Finding about an axis that turns instead of z, or about swapped or inverted axes of the accelerometer."""
    session = facts.session
    if session.gyro_dps is not None and (session.accel_mps2 is None or np.isnan(session.accel_mps2).all()):
        fields = TurningAxisCheck().take(recorded_samples(session))
        if fields is not None:
            yield SessionFinding("axis_differs", fields["reason"], fields["hint"])
    axes = facts.axes_agreement
    if axes is not None and axes.residual > AGREES >= axes.best_residual:
        says = f"gravity turns another way than the gyro says; it fits if {axes.named}"
        yield SessionFinding("accel_axes", says, f"name the columns of the acceleration {axes.spec}")


@dataclass(frozen=True, slots=True)
class ExaminedSession:
    """Facts of a session on one clock, and the findings of the checks."""

    facts: SessionFacts
    findings: tuple[SessionFinding, ...]

    @property
    def session(self) -> Session:
        """The session on one clock."""
        return self.facts.session

    @property
    def warnings(self) -> list[str]:
        """Findings that are no errors."""
        return [str(finding) for finding in self.findings if not finding.is_error]

    def refuse_errors(self, name: str) -> None:
        """Check that no finding is an error.

        Raises
        ------
        DataError
            With a line per error.
        """
        errors = [f"{name}: {finding}" for finding in self.findings if finding.is_error]
        if errors:
            raise DataError("\n".join(errors))


def clock_findings(session: Session, stated: ReadingOptions) -> tuple[SessionFinding, ...]:
    """Findings about the time unit of a session whose stated units are applied."""
    with np.errstate(all="ignore"):
        return clock_unit_findings(session, is_stated=bool(stated.time_unit or stated.sample_rate_hz))


def examined(session: Session, stated: ReadingOptions = AS_WRITTEN, *, is_still: bool = False) -> ExaminedSession:
    """Check a session as `serve` checks a stream.

    Parameters
    ----------
    session
        With the stated units applied.
    stated
        Units that the user stated.
    is_still
        Whether the device did not move, regardless of its encoder.
    """
    with np.errstate(all="ignore"):  # a recording may hold numbers of any size
        clock = one_clock(session)
        facts, findings = SessionFacts(clock.session), list(clock.findings)
        if not any(finding.is_error for finding in findings):
            findings += clock_findings(clock.session, stated)
        if not any(finding.is_error for finding in findings):
            corrected = SessionFacts(calibrated(clock.session))
            findings += rate_findings(corrected, is_stated=stated.states_rate, is_still=is_still)
        if not any(finding.is_error for finding in findings):
            findings += reading_findings(facts.readings)
            facts = facts.measurements()
        findings += acceleration_findings(facts, is_stated=bool(stated.accel_unit))
        findings += axis_findings(facts)
    return ExaminedSession(facts, tuple(findings))


def reading_findings(readings: JudgedReadings) -> Iterator[SessionFinding]:
    """Warnings about the judged readings of a session; none for usual ones."""
    if readings.impossible:
        first, samples = readings.fields_of("impossible_reading")[0], counted(readings.impossible, "sample")
        says = f"{samples} such as {first['rate_dps']:.4g} deg/s cannot be: {first['hint']}"
        yield SessionFinding("impossible", says)
    if readings.clipped:
        first = readings.fields_of("clipped")[0]
        yield SessionFinding(
            "clipped", f"{counted(readings.clipped, 'sample')} read ±{first['limit_dps']:.5g} deg/s", first["hint"]
        )
    hangs = list(zip(readings.fields_of("rate_hangs"), readings.fields_of("rate_moves"), strict=True))
    for hang, end in hangs[:MOST_NAMED]:
        since = f"for {end['seconds']:.3g} s from {end['since_s']:.6g} s on"
        says = f"the rate was exactly {hang['rate_dps'] + 0.0:.5g} deg/s {since}"
        yield SessionFinding("stuck", says, hang["hint"])
    if len(hangs) > MOST_NAMED:
        yield SessionFinding("stuck", f"the rate was constant {len(hangs)} times, for {readings.hung_s:.3g} s in total")
