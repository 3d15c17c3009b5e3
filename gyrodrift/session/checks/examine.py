"""All checks of a recording, in their order of dependence."""

from dataclasses import dataclass

import numpy as np

from gyrodrift.facts.session_facts import SessionFacts
from gyrodrift.session.calibrated import calibrated
from gyrodrift.session.checks.clock_unit import clock_unit_findings
from gyrodrift.session.checks.finding import SessionFinding
from gyrodrift.session.checks.gravity import acceleration_findings, axis_findings
from gyrodrift.session.checks.rate_unit import rate_findings
from gyrodrift.session.checks.restarts import one_clock
from gyrodrift.session.checks.stated import AS_WRITTEN, ReadingOptions
from gyrodrift.session.session import Session
from gyrodrift.values.errors import DataError


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
        return clock_unit_findings(session, is_stated=bool(stated.time_unit))


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
        findings += acceleration_findings(facts, is_stated=bool(stated.accel_unit))
        findings += axis_findings(facts)
    return ExaminedSession(facts, tuple(findings))
