"""What a diagnosis begins with: sessions read, put right where they say how, parted at their outages, and checked."""

from pathlib import Path
from typing import NamedTuple

from gyrodrift.diagnose.recording.checks import check_recording
from gyrodrift.diagnose.recording.numbering import backlog_of
from gyrodrift.diagnose.recording.outages import between_outages
from gyrodrift.diagnose.recording.recording import Recording, recording_of
from gyrodrift.session.calibrated import calibration_of, with_calibration
from gyrodrift.session.checks.examine import ExaminedSession, clock_findings
from gyrodrift.session.checks.stated import AS_WRITTEN, ReadingOptions
from gyrodrift.session.files import load_session


class CheckedSession(NamedTuple):
    """What is left of a session after the checks: none where it was refused, several where it had outages.

    remarks
        What was found, each a sentence.
    """

    recordings: tuple[Recording, ...]
    remarks: tuple[str, ...]


def checked_session(path: Path, reading: ReadingOptions = AS_WRITTEN) -> CheckedSession:
    """A session as recordings that went through the checks, its rates put right by the calibration that it keeps.

    Of a damaged one, which `session.files.damages_of` tells before, what is whole is read.
    `reading` is what a person states of columns and units.

    Raises
    ------
    DataError
        Where it cannot be read, has no encoder, or times that are not in the unit that they are taken for.
    """
    session = reading.applied(load_session(path, reading.columns, allow_damage=True))
    clock = ExaminedSession(session, clock_findings(session, reading))
    clock.refuse_errors(str(path))
    remarks = [f"{session.name}: {remark}" for remark in (*session.remarks, *clock.warnings)]
    calibration = calibration_of(session)
    if calibration is not None:
        session = with_calibration(session, calibration)
        how = f"is compared with its calibration of {calibration.date} applied, as a filter takes it"
        remarks.append(f"{session.name}: {how}")
    if waited := backlog_of(session):
        session = session.part(waited, len(session.t_device_s))
        remarks.append(f"{session.name}: its first {waited} samples had waited and came at once; they are left out")
    parts = between_outages(session)
    checked = [check_recording(recording_of(part)) for part in parts.sessions]
    recordings = tuple(one.recording for one in checked if one.recording is not None)
    return CheckedSession(recordings, (*remarks, *parts.remarks, *(said for one in checked for said in one.remarks)))
