"""All checks of a recording, in the order in which they need each other."""

from dataclasses import dataclass

import numpy as np

from gyrodrift.errors import DataError
from gyrodrift.session.calibrated import calibrated
from gyrodrift.session.checks.clock_unit import clock_unit_findings
from gyrodrift.session.checks.finding import SessionFinding
from gyrodrift.session.checks.rate_unit import rate_findings
from gyrodrift.session.checks.restarts import one_clock
from gyrodrift.session.checks.stated import AS_WRITTEN, ReadingOptions
from gyrodrift.session.session import Session


@dataclass(frozen=True, slots=True)
class ExaminedSession:
    """A session on one clock, and what the checks found."""

    session: Session
    findings: tuple[SessionFinding, ...]

    @property
    def warnings(self) -> list[str]:
        """What is told beside a result."""
        return [str(finding) for finding in self.findings if not finding.is_error]

    def refuse_errors(self, name: str) -> None:
        """See that nothing contradicts what the numbers are taken for.

        Raises
        ------
        DataError
            With all that does, one line each.
        """
        errors = [f"{name}: {finding}" for finding in self.findings if finding.is_error]
        if errors:
            raise DataError("\n".join(errors))


def clock_findings(session: Session, stated: ReadingOptions) -> tuple[SessionFinding, ...]:
    """What is wrong with the unit of the times of a session that is as it was stated."""
    with np.errstate(all="ignore"):
        return clock_unit_findings(session, is_stated=bool(stated.time_unit))


def examined(session: Session, stated: ReadingOptions = AS_WRITTEN, *, is_still: bool = False) -> ExaminedSession:
    """Check a session as `serve` checks a stream.

    Parameters
    ----------
    session
        By the units that were stated.
    stated
        What a person stated of its units.
    is_still
        Whether the device did not move, whatever its encoder says.
    """
    with np.errstate(all="ignore"):  # a recording may hold numbers of any size
        clock = one_clock(session)
        found = list(clock.findings)
        if not any(finding.is_error for finding in found):
            found += clock_findings(clock.session, stated)
        if not any(finding.is_error for finding in found):
            right = calibrated(clock.session)
            found += rate_findings(right, is_stated=stated.states_rate, is_still=is_still)
    return ExaminedSession(clock.session, tuple(found))
