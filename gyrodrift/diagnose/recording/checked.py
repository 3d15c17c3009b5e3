"""What a diagnosis begins with: sessions read, put right where they say how, parted at their outages, and checked."""

from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.recording.checks import LEAST_S, check_recording
from gyrodrift.diagnose.recording.numbering import backlog_of, numbered
from gyrodrift.diagnose.recording.recording import Recording, recording_of
from gyrodrift.session.calibrated import calibration_of, with_calibration
from gyrodrift.session.checks.examine import ExaminedSession, clock_findings
from gyrodrift.session.checks.stated import AS_WRITTEN, ReadingOptions
from gyrodrift.session.files import load_session
from gyrodrift.session.session import Session

OUTAGE_S, MANY_APART = 0.2, 10.0
"""An outage lasts longer than this, and than so many times the usual distance of what is known: a link that loses every
tenth sample never loses ten in a row, and a reference may be slower than the gyro."""

BREAK_S, AROUND = 1.0, 200
"""Two clocks that go apart by more than this at once have been set, or the device was gone: among so many samples after
it none came as early as one of those before. Behind a host that was only busy the next ones do."""

ENOUGH = 0.5
"""Share of a session that its parts hold at least; where a link fails that often, that is what there is to be seen."""


class Parts(NamedTuple):
    """Sessions without an outage, and what is to be said of that; nothing where it is the session as it was."""

    sessions: tuple[Session, ...]
    remarks: tuple[str, ...] = ()


class _Piece(NamedTuple):
    """Rows of a session, from one to before another, between which nothing is missing for long."""

    first: int
    end: int
    seconds: float


class _Pieces(NamedTuple):
    """Those of a stretch of one clock, with what is missing between them."""

    pieces: list[_Piece]
    outages: int
    missing_s: float


def between_outages(session: Session) -> Parts:
    """The parts of a session of LEAST_S and more; the session as it is where nothing interrupts it, or too much.

    Raises
    ------
    DataError
        Where it has fewer than two samples.
    """
    breaks = _breaks(session)
    stretches = [_pieces_of(session, first, end) for first, end in pairwise([0, *breaks, len(session.rate_dps)])]
    pieces = [piece for stretch in stretches for piece in stretch.pieces]
    kept = [piece for piece in pieces if piece.seconds >= LEAST_S]
    kept_s, pieces_s = sum(piece.seconds for piece in kept), sum(piece.seconds for piece in pieces)
    outages, missing_s = sum(one.outages for one in stretches), sum(one.missing_s for one in stretches)
    if not (breaks or outages) or not kept or kept_s < ENOUGH * (pieces_s + missing_s):
        return Parts((session,))
    said = [_missing(missing_s, outages)] if outages else []
    said += ["the device began anew, or a clock was set" + _times(len(breaks))] if breaks else []
    remark = f"{session.name}: {', and '.join(said)}; {_what_counts(len(kept), pieces_s - kept_s)}"
    return Parts(_named([session.part(piece.first, piece.end) for piece in kept]), (remark,))


def _breaks(session: Session) -> list[int]:
    """Rows with which a clock begins anew beside the other one, or beside the usual distance of two samples."""
    t_s = session.t_device_s
    if len(t_s) < 2:
        return []
    usual_s = float(np.median(np.diff(t_s)))
    late_s = (usual_s * np.arange(len(t_s)) if session.t_host_s is None else session.t_host_s) - t_s
    known = np.flatnonzero(np.isfinite(late_s))
    late_s, apart_s = late_s[known], max(BREAK_S, MANY_APART * usual_s)
    jumps = 1 + np.flatnonzero(np.abs(np.diff(late_s)) > apart_s)
    return [int(known[row]) for row in jumps.tolist() if abs(_step_s(late_s, row)) > apart_s]


def _step_s(late_s: Floats, row: int) -> float:
    """By how much what waits least is later from a row on than before it."""
    return float(late_s[row : row + AROUND].min() - late_s[max(0, row - AROUND) : row].min())


def _pieces_of(session: Session, first: int, end: int) -> _Pieces:
    """Of the rows from one to before another; one piece of no length where they are too few to have a distance."""
    stretch = session.part(first, end)
    whole = _Pieces([_Piece(first, end, 0.0)], 0, 0.0)
    if stretch.encoder_deg is None or end - first < 2:
        return whole
    found = numbered(stretch)
    spans_s = float(stretch.t_device_s[found.place[-1]] - stretch.t_device_s[found.place[0]])
    is_known = (np.isfinite(stretch.rate_dps) & np.isfinite(stretch.encoder_deg))[found.place]
    if np.count_nonzero(is_known) < 2 or not spans_s > 0.0:
        return whole
    number, rows, samples = found.number[is_known], first + found.place[is_known], int(found.number[-1]) + 1
    period_s = spans_s / (samples - 1)
    gaps = np.diff(number, prepend=-1, append=samples)
    outages = np.flatnonzero(gaps > max(OUTAGE_S / period_s, MANY_APART * float(np.median(gaps))))
    pieces = [
        _Piece(int(rows[one]), int(rows[after - 1]) + 1, float(number[after - 1] - number[one] + 1) * period_s)
        for one, after in pairwise([0, *outages.tolist(), len(number)])
        if one < after
    ]
    return _Pieces(pieces, len(outages), float((gaps[outages] - 1).sum()) * period_s)


def _named(parts: list[Session]) -> tuple[Session, ...]:
    """Each has a name of its own where there are several."""
    if len(parts) == 1:
        return tuple(parts)
    return tuple(replace(part, name=f"{part.name}, part {number}") for number, part in enumerate(parts, 1))


def _missing(missing_s: float, outages: int) -> str:
    return f"rates or angles are missing for {missing_s:.1f} s" + ("" if outages == 1 else f" in {outages} pieces")


def _times(count: int) -> str:
    return "" if count == 1 else f" {count} times"


def _what_counts(parts: int, too_short_s: float) -> str:
    what = "the rest is one session" if parts == 1 else f"the {parts} parts of the rest are taken as sessions"
    but = f", without {too_short_s:.1f} s in parts of less than {LEAST_S:.0f} s" if too_short_s > 0.0 else ""
    return what + but


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
