"""Which sample of an even grid each row of a session is: by its counter, or by its clock where it has none.

A clock may say when samples arrived: in bunches behind a radio or a busy host, though they were taken evenly. Samples
are missing only where all that follow are later, too: after a bunch that had to wait they are not.
"""

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import minimum_filter1d

from gyrodrift.arrays import Floats, Integers
from gyrodrift.errors import DataError
from gyrodrift.session.session import Session

WRAP = 1 << 16
"""Counters on the wire have 16 bits; one that never went beyond may have wrapped."""

AROUND = 200
"""Samples among whose stamps there is one that did not wait; in so many a clock does not drift by a period."""

SCATTER = 0.2
"""Of a period, by which stamps that scatter may look later for good."""

BLOCK = 50
"""Samples over which a pace is taken: a bunch is shorter."""

ROUNDS = 3
"""Numberings, each by the period that the one before gives."""

WAITED, NEAR = 20.0, 3.0
"""A backlog at the start is of more than the first, in periods; it is over where what is left is no more than the
second."""

EVEN = 0.01
"""Standard deviation of stamps about their numbers, in periods, that is as good as none."""


@dataclass(frozen=True, slots=True)
class Numbered:
    """Numbers of the samples that are kept, rising from 0, and their places in the session.

    repeated, disordered
        How many samples came twice, or after a later one.
    """

    number: Integers
    place: Integers
    repeated: int
    disordered: int


def numbered(session: Session) -> Numbered:
    """Number the samples of a session.

    Raises
    ------
    DataError
        Where fewer than two have a number.
    """
    seq = _counter_of(session)
    number = numbers_by_clock(session.t_device_s) if seq is None else _by_counter(seq)
    disordered = int(np.count_nonzero(np.diff(number) < 0))
    number = number - number.min()
    if (np.diff(number) > 0).all():
        kept, place = number, np.arange(len(number))
    else:
        kept, place = np.unique(number, return_index=True)
    if len(kept) < 2:
        raise DataError(f"{session.name}: has {len(kept)} samples; there is nothing to see")
    return Numbered(kept - kept[0], place, len(number) - len(kept), disordered)


def backlog_of(session: Session) -> int:
    """How many samples at the start had waited for a host that was not there yet, and came at once.

    Their stamps say nothing of when they were taken. With a counter, or a clock that the arrivals do not touch, nothing
    has to be known of them.
    """
    t_s = session.t_device_s
    half = len(t_s) // 2
    if _counter_of(session) is not None or half <= BLOCK:
        return 0
    pace_s = _pace_s(t_s[half:])
    if not pace_s > 0.0:
        return 0
    late = (t_s[:half] - t_s[0]) / pace_s - np.arange(half)
    end = int(np.argmax(late <= late.min() + NEAR))
    return end if -late[end] > max(WAITED, 0.5 * end) else 0  # samples that came at twice the pace came at once


def numbers_by_clock(t_s: Floats) -> Integers:
    """(n,) numbers of samples by their stamps, rising from 0."""
    steps_s = np.diff(t_s)
    rising_s = steps_s[steps_s > 0.0]
    if not len(rising_s):
        return np.arange(len(t_s))
    usual_s = float(np.median(rising_s))
    usual_s = float(np.mean(rising_s[np.abs(rising_s - usual_s) < 0.5 * usual_s]))  # of stamps that are rounded, too
    # Some lack samples and some come unevenly: the usual step is the period of the first, the usual pace of the second.
    tried = [_numbers_from(t_s, period_s) for period_s in (usual_s, _pace_s(t_s)) if period_s > 0.0]
    return min(tried, key=lambda one: one[0])[1]


def _numbers_from(t_s: Floats, period_s: float) -> tuple[float, Integers]:
    """How many nats a numbering costs that begins with a period, by its holes and by what stamps are off; and it."""
    number = _with_holes(t_s, period_s)
    for _ in range(ROUNDS - 1):
        period_s = float(np.polyfit(number, t_s, 1)[0])
        if period_s <= 0.0:
            break
        number = _with_holes(t_s, period_s)
    slope_s, offset_s = np.polyfit(number, t_s, 1)
    off = float(np.std(t_s - slope_s * number - offset_s)) / max(abs(float(slope_s)), np.finfo(float).tiny)
    holes = int(np.count_nonzero(np.diff(number) > 1))
    return float(len(t_s) * np.log(off + EVEN) + holes * np.log(len(t_s))), number


def _with_holes(t_s: Floats, period_s: float) -> Integers:
    """Numbers with a hole wherever the least late of the samples to come are later than the least late of those before.

    Who waits is late and the next ones are less so; where samples are missing, all that come are later.
    """
    late = (t_s - t_s[0]) / period_s - np.arange(len(t_s))
    least_to_come = minimum_filter1d(late, AROUND, origin=-(AROUND // 2), mode="nearest")
    missing = np.zeros(len(t_s), np.int64)
    total, after = 0, 0
    for place in np.flatnonzero(np.diff(t_s) > 1.6 * period_s) + 1:  # from 1.6 periods on a sample may be missing
        late[after:place] -= total
        after = int(place)
        least_before = late[max(0, place - AROUND) : place].min()
        missing[place] = max(0, round(least_to_come[place] - total - least_before - SCATTER))
        total += int(missing[place])
    return np.arange(len(t_s)) + np.cumsum(missing)


def _pace_s(t_s: Floats) -> float:
    """Usual distance of two samples over BLOCK of them, s."""
    block = min(BLOCK, len(t_s) - 1)
    return float(np.median(t_s[block:] - t_s[:-block])) / block


def _counter_of(session: Session) -> Integers | None:
    """The counter, where every sample has one."""
    return None if session.seq is None or (session.seq < 0).any() else session.seq


def _by_counter(seq: Integers) -> Integers:
    steps = np.diff(seq)
    if seq.max() < WRAP:
        steps = (steps + WRAP // 2) % WRAP - WRAP // 2
    return np.concatenate([[0], np.cumsum(steps)])
