"""Check of second sources: whether each of them agrees with restlevel here."""

from gyrodrift.doctor.evidence import DeviceEvidence, checks_of
from gyrodrift.doctor.finding import DeviceFinding, ok, warning
from gyrodrift.filters.restlevel_filter import RESTLEVEL
from gyrodrift.filters.run import FilterRun
from gyrodrift.session.aids import aids_by_row
from gyrodrift.session.session import Session
from gyrodrift.values.aid import AidStatus

Sources = dict[str, AidStatus]

ADVICE = "Check its sign, its unit and its delay, and whether another device sends under its name."


def sources_of(session: Session) -> Sources | None:
    """How each second source agrees at the end of a session; None without any."""
    if not session.aids:
        return None
    run, by_row = FilterRun(RESTLEVEL, RESTLEVEL.params()), aids_by_row(session.aids)
    differing: Sources = {}
    for row, sample in enumerate(session.filter_samples()):
        run.step(*sample)
        for aid in by_row.get(row, ()):
            run.aid(aid)
            differing |= {name: status for name, status in run.aids.items() if status.differs}
    return run.aids | differing


def _sources(evidence: DeviceEvidence) -> Sources | None:
    return None if evidence.facts is None else sources_of(evidence.facts.session)


def second_sources(_evidence: DeviceEvidence, sources: Sources) -> DeviceFinding | None:
    """Whether the second sources agree with the gyro."""
    wrong = {name: status.differs for name, status in sources.items() if status.differs}
    if wrong:
        listed = "; ".join(f"{name}: {differs}" for name, differs in wrong.items())
        return warning(f"A second source contradicts the gyro and is left out: {listed}.", ADVICE, float(len(wrong)))
    names = ", ".join(f"{name} (weight {status.weight:.2f})" for name, status in sources.items())
    return ok(f"The second sources agree with the gyro: {names}.", float(len(sources)))


CHECKS = checks_of(_sources, second_sources)
