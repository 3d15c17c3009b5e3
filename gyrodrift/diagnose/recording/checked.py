"""Read sessions as recordings for a diagnosis: apply their calibration, split them at outages, and check them."""

from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np

from gyrodrift.diagnose.recording.checks import LEAST_S, check_recording
from gyrodrift.diagnose.recording.numbering import backlog_of, number_samples
from gyrodrift.diagnose.recording.outliers import granularity
from gyrodrift.diagnose.recording.recording import Recording, recording_of
from gyrodrift.facts.session_facts import SessionFacts
from gyrodrift.session.calibrated import calibration_of, with_calibration
from gyrodrift.session.checks.examine import ExaminedSession, clock_findings
from gyrodrift.session.checks.stated import AS_WRITTEN, ReadingOptions, session_as_stated
from gyrodrift.session.foreign.reference import question_of
from gyrodrift.session.session import Session
from gyrodrift.values.arrays import Floats, Integers, Mask
from gyrodrift.values.errors import DataError

MANY_STEPS, HELD_SHARE, MOVES = 4.0, 0.5, 20
"""A held angle changes by more than so many of its steps, and by none in the next sample. At least this share of its
large changes stops so, and there are at least so many of them. Chosen: hardly any change stops at once if the angle is
read with each sample. Most changes do if it is held, even at half of the rate and with scatter."""

REST = 3.0
"""Length from which on an equal angle is a rest with readings in it, in distances of readings in motion. Chosen: twice
the largest distance in motion."""

NEXT = 1.7
"""Largest distance of two readings in a row, in usual distances: up to 1.5 with scatter; near 2 one lacks between.
Chosen: between these two."""

INNER = (1.0, 99.0)
"""Percentiles of the distances from even times; a few readings outside of them do not count. Chosen: 1 % at either
end."""

EVEN, WITH_SAMPLES = 1.2, 0.05
"""Spread between INNER percentiles, in samples, up to which the readings are even, and below which they are taken with
the samples. Chosen: readings at even times appear within one sample behind them, and a fifth more allows for scatter.
Readings that are taken with the samples always appear equally late."""


def without_held_angles(session: Session) -> tuple[Session, str]:
    """Session whose angles count only where they are new, if its reference is slower than its gyro; and the remark.

    They are moved to the times of their samples. The session goes from its first to its last reading. A slow reference
    turns by many steps within a sample, and by none in the next. Without one the remark is empty.

    Raises
    ------
    DataError
        If fewer than two samples have different numbers.
    """
    angle_deg = session.encoder_deg
    if angle_deg is None or not len(_moves(angle_deg[np.isfinite(angle_deg)])):
        return session, ""
    numbers = number_samples(session)
    is_known = np.isfinite(angle_deg[numbers.row])
    row, sample = numbers.row[is_known], numbers.sample[is_known]
    angle_deg = angle_deg[row]
    moves = _moves(angle_deg)
    if not len(moves):
        return session, ""
    every = round(float(np.median(np.diff(moves))))
    is_read = _is_read(1 + np.flatnonzero(np.diff(angle_deg)), len(angle_deg), every)
    age = _ages(sample[is_read], sample[1 + moves])
    read_deg = np.full(len(session.t_device_s), np.nan)
    read_deg[row[is_read]] = angle_deg[is_read] + _turn_since_deg(sample[is_read], age, angle_deg[is_read])
    remark = f"{session.name}: its angle is new in one of {every} samples only; between them it counts as missing"
    if age.any():
        remark += ", and it is moved from the time of its reading to that of its sample"
    first, *_, last = np.flatnonzero(np.isfinite(read_deg)).tolist()
    return replace(session, encoder_deg=read_deg).part(first, last + 1), remark


def _moves(angle_deg: Floats) -> Integers:
    """(k,) indices before the large changes of an angle that is held; none if it is not held."""
    change_deg = np.abs(np.diff(angle_deg))
    moves = np.flatnonzero(change_deg[:-1] > MANY_STEPS * granularity(angle_deg))
    is_held = len(moves) >= MOVES and np.mean(change_deg[moves + 1] == 0.0) >= HELD_SHARE
    return moves if is_held else moves[:0]


def _is_read(new: Integers, rows: int, every: int) -> Mask:
    """(n,) rows with a reading: those with a new angle, and in rests, whose readings are equal, one of `every` rows."""
    is_read = np.zeros(rows, dtype=bool)
    is_read[new] = True
    for after, row in pairwise([0, *new.tolist(), rows]):
        if row - after > REST * every:
            is_read[row - every : after : -every] = True
    return is_read


def _ages(sample: Integers, moving: Integers) -> Floats:
    """(k,) ages of readings in the samples in which they appear, in samples: 0 to 1.

    sample, moving
        (k,) samples with a reading, and those of them in which the reference moves, whose readings are all new.
    """
    apart = np.diff(moving)
    is_next = apart < NEXT * np.median(apart)
    periods = np.where(is_next, 1.0, np.round(apart / _period(moving, is_next)))
    count = np.concatenate([[0.0], np.cumsum(periods)])
    period, begin = np.polyfit(count, moving, 1)
    first, last = np.percentile(moving - begin - period * count, INNER)
    if last - first < WITH_SAMPLES:
        return np.zeros(len(sample))
    if last - first > EVEN:
        return np.full(len(sample), 0.5)
    middle = begin + 0.5 * (first + last)  # of samples in which readings appear, half a sample old on average
    late = (sample - middle + 0.5 * period) % period - 0.5 * period
    age: Floats = np.clip(0.5 + late, 0.0, 1.0)
    return age


def _period(moving: Integers, is_next: Mask) -> float:
    """Mean distance of readings in motion, in samples: slope of lines with one slope, each with its own beginning."""
    motion = np.concatenate([[0], np.cumsum(~is_next)])
    sizes = np.bincount(motion)
    count = np.arange(len(moving)) - (np.bincount(motion, np.arange(len(moving))) / sizes)[motion]
    return float(count @ moving) / float(count @ count)


def _turn_since_deg(sample: Integers, age: Floats, angle_deg: Floats) -> Floats:
    """(k,) turn of the reference between a reading and its sample, degrees, at the rate from the last to the next."""
    time = np.pad(sample - age, 1, mode="edge")
    around_deg = np.pad(angle_deg, 1, mode="edge")
    turn_deg: Floats = age * (around_deg[2:] - around_deg[:-2]) / (time[2:] - time[:-2])
    return turn_deg


OUTAGE_S, MANY_APART = 0.2, 10.0
"""Least length of an outage: seconds, and median distances of samples that have both a rate and an angle. Chosen: a
link that loses every tenth sample rarely loses ten in a row. A reference may have a lower rate than the gyro."""

BREAK_S, AROUND = 1.0, 200
"""Step between two clocks that counts as a break: a clock was set, or the device began again.

The least delays of so many samples before and after the step are compared. Behind a busy host the delay returns to the
value before the step. Chosen: a clock that is set mostly steps by more, and AROUND is that of `numbering`.
"""

ENOUGH = 0.5
"""Least share of a session that its parts must hold, or it is not split. Chosen: if a link fails that often, the
outages are part of the session."""


class Parts(NamedTuple):
    """Parts of a session without an outage, and remarks on the split. An unsplit session has no remarks."""

    sessions: tuple[Session, ...]
    remarks: tuple[str, ...] = ()


class _Piece(NamedTuple):
    """Rows of a session from `first` to before `end`, without an outage between them, and their length in seconds."""

    first: int
    end: int
    seconds: float


class _Stretch(NamedTuple):
    """Pieces of a session between two breaks of its clock, with the number and the total length of the outages."""

    pieces: list[_Piece]
    outages: int
    missing_s: float


def between_outages(session: Session) -> Parts:
    """Parts of a session between its outages that last at least LEAST_S.

    The session is not split if it has no outage, or if the parts hold less than ENOUGH of it.

    Raises
    ------
    DataError
        If the session has fewer than two samples.
    """
    breaks = _breaks(session)
    stretches = [_stretch_of(session, first, end) for first, end in pairwise([0, *breaks, len(session.rate_dps)])]
    pieces = [piece for stretch in stretches for piece in stretch.pieces]
    kept = [piece for piece in pieces if piece.seconds >= LEAST_S]
    kept_s, pieces_s = sum(piece.seconds for piece in kept), sum(piece.seconds for piece in pieces)
    outages, missing_s = sum(stretch.outages for stretch in stretches), sum(stretch.missing_s for stretch in stretches)
    if not (breaks or outages) or not kept or kept_s < ENOUGH * (pieces_s + missing_s):
        return Parts((session,))
    events = [_missing(missing_s, outages)] if outages else []
    events += ["the device restarted, or a clock was set" + _times(len(breaks))] if breaks else []
    remark = f"{session.name}: {', and '.join(events)}; {_kept_words(len(kept), pieces_s - kept_s)}"
    return Parts(_named([session.part(piece.first, piece.end) for piece in kept]), (remark,))


def _breaks(session: Session) -> list[int]:
    """Rows at which the device clock steps against the host's clock; without host times against an even grid."""
    t_s = session.t_device_s
    if len(t_s) < 2:
        return []
    usual_s = float(np.median(np.diff(t_s)))
    late_s = (usual_s * np.arange(len(t_s)) if session.t_host_s is None else session.t_host_s) - t_s
    rows = np.flatnonzero(np.isfinite(late_s))
    late_s, least_step_s = late_s[rows], max(BREAK_S, MANY_APART * usual_s)
    jumps = 1 + np.flatnonzero(np.abs(np.diff(late_s)) > least_step_s)
    return [int(rows[jump]) for jump in jumps.tolist() if abs(_step_s(late_s, jump)) > least_step_s]


def _step_s(late_s: Floats, row: int) -> float:
    """Least delay of AROUND samples from a row on, minus the least delay of those before it, s."""
    return float(late_s[row : row + AROUND].min() - late_s[max(0, row - AROUND) : row].min())


def _stretch_of(session: Session, first: int, end: int) -> _Stretch:
    """Pieces of the rows from `first` to before `end`; a single piece of length 0 if too few samples are complete."""
    stretch = session.part(first, end)
    whole = _Stretch([_Piece(first, end, 0.0)], 0, 0.0)
    if stretch.encoder_deg is None or end - first < 2:
        return whole
    numbers = number_samples(stretch)
    spans_s = float(stretch.t_device_s[numbers.row[-1]] - stretch.t_device_s[numbers.row[0]])
    is_known = (np.isfinite(stretch.rate_dps) & np.isfinite(stretch.encoder_deg))[numbers.row]
    if np.count_nonzero(is_known) < 2 or not spans_s > 0.0:
        return whole
    sample, rows, samples = numbers.sample[is_known], first + numbers.row[is_known], int(numbers.sample[-1]) + 1
    period_s = spans_s / (samples - 1)
    gaps = np.diff(sample, prepend=-1, append=samples)
    outages = np.flatnonzero(gaps > max(OUTAGE_S / period_s, MANY_APART * float(np.median(gaps))))
    pieces = [
        _Piece(int(rows[start]), int(rows[stop - 1]) + 1, float(sample[stop - 1] - sample[start] + 1) * period_s)
        for start, stop in pairwise([0, *outages.tolist(), len(sample)])
        if start < stop
    ]
    return _Stretch(pieces, len(outages), float((gaps[outages] - 1).sum()) * period_s)


def _named(parts: list[Session]) -> tuple[Session, ...]:
    """Sessions with the number of the part in their names; a single part keeps its name."""
    if len(parts) == 1:
        return tuple(parts)
    return tuple(replace(part, name=f"{part.name}, part {number}") for number, part in enumerate(parts, 1))


def _missing(missing_s: float, outages: int) -> str:
    return f"rates or angles are missing for {missing_s:.1f} s" + ("" if outages == 1 else f" in {outages} pieces")


def _times(count: int) -> str:
    return "" if count == 1 else f" {count} times"


def _kept_words(parts: int, too_short_s: float) -> str:
    """End of the remark on a split: the number of parts, and the seconds in parts that are too short."""
    use = "the rest is one session" if parts == 1 else f"the {parts} parts of the rest are taken as sessions"
    lost = f", without {too_short_s:.1f} s in parts of less than {LEAST_S:.0f} s" if too_short_s > 0.0 else ""
    return use + lost


def _missing_numbers(session: Session) -> list[str]:
    """Remark on rates and angles that are not numbers; empty without any."""
    columns = {"rates": session.rate_dps, "angles": session.encoder_deg}
    missing = {
        name: int(np.count_nonzero(~np.isfinite(values))) for name, values in columns.items() if values is not None
    }
    words = [f"{count} of {len(session.rate_dps)} {name}" for name, count in missing.items() if count]
    return [f"{session.name}: {' and '.join(words)} are not numbers, and count as missing"] if words else []


class CheckedSession(NamedTuple):
    """Recordings of a session that passed the checks: none if it was refused, several if it was split at outages.

    remarks
        A sentence for every finding.
    """

    recordings: tuple[Recording, ...]
    remarks: tuple[str, ...]


def checked_session(path: Path, reading: ReadingOptions = AS_WRITTEN) -> CheckedSession:
    """Read a session, apply the calibration that it keeps, split it at outages, and check its parts.

    The intact part of a damaged file is read; `session.files.damages_of` reports the damage.

    reading
        Columns and units that the user states.

    Raises
    ------
    DataError
        If the file cannot be read, has no encoder, or its times have an implausible unit.
    """
    session = session_as_stated(path, reading)
    clock = ExaminedSession(SessionFacts(session), clock_findings(session, reading))
    clock.refuse_errors(str(path))
    if session.encoder_deg is None:
        of_table = "name its reference angle with --columns, as in 'time=t_s, gz=rate:rads, angle=encoder:rad'"
        how = question_of(path) or of_table
        raise DataError(f"{path}: has no encoder, so its true motion is unknown; {how}")
    remarks = [f"{session.name}: {remark}" for remark in (*session.remarks, *clock.warnings)]
    calibration = calibration_of(session)
    if calibration is not None:
        session = with_calibration(session, calibration)
        how = f"is compared with its calibration of {calibration.date} applied, as a filter takes it"
        remarks.append(f"{session.name}: {how}")
    remarks += _missing_numbers(session)
    session, held_remark = without_held_angles(session)
    remarks += [held_remark] if held_remark else []
    if waited := backlog_of(session):
        session = session.part(waited, len(session.t_device_s))
        remarks.append(f"{session.name}: its first {waited} samples had waited and came at once; they are ignored")
    parts = between_outages(session)
    checked = [check_recording(recording_of(part)) for part in parts.sessions]
    recordings = tuple(part.recording for part in checked if part.recording is not None)
    of_checks = (remark for part in checked for remark in part.remarks)
    return CheckedSession(recordings, (*remarks, *parts.remarks, *of_checks))
