"""Reference angles that are read more rarely than the gyro: each is held until the next one, in all rows between.

A row then states the newest reading, which is up to a sample older than the row. It is assumed that readings come at
even times, or at any time between two samples.
"""

from dataclasses import replace
from itertools import pairwise

import numpy as np

from gyrodrift.diagnose.recording.numbering import number_samples
from gyrodrift.diagnose.recording.outliers import granularity
from gyrodrift.session.session import Session
from gyrodrift.values.arrays import Floats, Integers, Mask

MANY_STEPS, HELD_SHARE, MOVES = 4.0, 0.5, 20
"""A held angle changes by more than so many of its steps, and by none in the next sample. At least this share of its
large changes stops so, and there are at least so many of them. Chosen: hardly any change stops at once if the angle is
read with each sample. Most changes do if it is held, even at half of the rate and with scatter."""

REST = 3.0
"""Length from which on an equal angle is a rest with readings in it, in distances of readings in motion."""

NEXT = 1.7
"""Largest distance of two readings in a row, in usual distances: up to 1.5 with scatter; near 2 one lacks between."""

INNER = (1.0, 99.0)
"""Percentiles of the distances from even times; a few readings outside of them do not count."""

EVEN, WITH_SAMPLES = 1.2, 0.05
"""Spread between INNER percentiles, in samples, up to which the readings are even, and below which they are taken with
the samples. Readings at even times appear within one sample behind them: a fifth more allows for scatter. Readings that
are taken with the samples always appear equally late."""


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
