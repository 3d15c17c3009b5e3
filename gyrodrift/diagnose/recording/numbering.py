"""Index on an even grid of samples for each row of a session: by its counter, or by its clock if it has none.

A clock may state arrival times. Samples that were taken evenly arrive in bunches behind a radio or a busy host.
Therefore a late stamp counts as missing samples only if all stamps after it are late, too. After a bunch that had to
wait, the stamps are on time again.
"""

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import minimum_filter1d

from gyrodrift.session.session import Session
from gyrodrift.values.arrays import Floats, Integers, Mask
from gyrodrift.values.errors import DataError

WRAP = 1 << 16
"""Values of a 16-bit counter, by definition the width on the wire. A counter that stays below may have wrapped."""

AROUND = 200
"""Samples in which at least one stamp is on time. Chosen: during so few samples a clock drifts by less than a
period."""

SCATTER = 0.2
"""Share of a period that is subtracted from a lasting delay before it is rounded to missing samples. Chosen: the
scatter of stamps."""

BLOCK = 50
"""Samples over which the mean period is taken. Chosen: it is longer than a bunch."""

ROUNDS = 3
"""Number of passes. Every pass takes the period that the pass before has fitted. Chosen: the period of the first
numbers may be wrong, that of the second is near."""

WAITED, NEAR = 20.0, 3.0
"""Least backlog at the start, and largest backlog at which it counts as over, in periods. Chosen: above the length of a
bunch, and above the scatter of stamps."""

EVEN = 0.01
"""Standard deviation of stamps about an even grid, in periods, that is added against the logarithm of zero. Chosen:
more even stamps are equally good."""


@dataclass(frozen=True, slots=True)
class SampleNumbers:
    """Grid index and row of every kept sample, both of shape (kept,).

    sample
        Index on the grid, rising from 0.
    row
        Row of the sample in the session.
    repeated, disordered
        Number of samples that came twice, and number of those that came after a later sample.
    """

    sample: Integers
    row: Integers
    repeated: int
    disordered: int


def number_samples(session: Session) -> SampleNumbers:
    """Number the samples of a session.

    Raises
    ------
    DataError
        If fewer than two samples have different numbers.
    """
    seq = _counter_of(session)
    number = _by_times(session) if seq is None else _by_counter(seq)
    disordered = int(np.count_nonzero(np.diff(number) < 0))
    number = number - number.min()
    if (np.diff(number) > 0).all():
        kept, row = number, np.arange(len(number))
    else:
        kept, row = np.unique(number, return_index=True)
    if len(kept) < 2:
        raise DataError(f"{session.name}: has {len(kept)} samples; at least 2 are needed")
    return SampleNumbers(kept - kept[0], row, len(number) - len(kept), disordered)


def _by_times(session: Session) -> Integers:
    """(n,) grid indices by the stamps; a repeated row has the index of the row before it."""
    is_new = ~_repeats_row(session)
    numbers: Integers = numbers_by_clock(session.t_device_s[is_new])[np.cumsum(is_new) - 1]
    return numbers


def _repeats_row(session: Session) -> Mask:
    """(n,) whether a row repeats the row before it, with stamp and values.

    Stamps that are coarser than the samples are equal, too. But then the values of some equal stamps differ.
    """
    t_s, values = session.t_device_s, [session.rate_dps, session.encoder_deg]
    is_same_time: Mask = np.concatenate([[False], np.diff(t_s) == 0.0])
    is_same = is_same_time.copy()
    for column in values:
        if column is not None:
            is_same[1:] &= (column[1:] == column[:-1]) | (np.isnan(column[1:]) & np.isnan(column[:-1]))
    return is_same if (is_same == is_same_time).all() else np.zeros(len(t_s), bool)


def backlog_of(session: Session) -> int:
    """Number of samples at the start that had waited for the host, and arrived at once.

    Their stamps do not state when they were taken. It is 0 with a counter, which numbers them, and 0 with a clock that
    does not depend on the arrivals.
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
    return end if -late[end] > max(WAITED, 0.5 * end) else 0  # at twice the pace, samples count as arrived at once


def numbers_by_clock(t_s: Floats) -> Integers:
    """(n,) grid indices of samples by their stamps, rising from 0."""
    steps_s = np.diff(t_s)
    rising_s = steps_s[steps_s > 0.0]
    if not len(rising_s):
        return np.arange(len(t_s))
    usual_s = float(np.median(rising_s))
    usual_s = float(np.mean(rising_s[np.abs(rising_s - usual_s) < 0.5 * usual_s]))  # the mean averages rounded stamps
    # The usual step is the period of a session that lacks samples. The pace is that of samples that arrive unevenly.
    candidates = [_numbers_from(t_s, period_s) for period_s in (usual_s, _pace_s(t_s)) if period_s > 0.0]
    return min(candidates, key=lambda candidate: candidate[0])[1]


def _numbers_from(t_s: Floats, period_s: float) -> tuple[float, Integers]:
    """Cost of the numbering that begins with a period, and the numbers, (n,).

    The cost, in nats, is that of Gaussian stamps about an even grid, plus the logarithm of n for every gap.
    """
    number = _with_gaps(t_s, period_s)
    for _ in range(ROUNDS - 1):
        period_s = float(np.polyfit(number, t_s, 1)[0])
        if period_s <= 0.0:
            break
        number = _with_gaps(t_s, period_s)
    slope_s, offset_s = np.polyfit(number, t_s, 1)
    scatter = float(np.std(t_s - slope_s * number - offset_s)) / max(abs(float(slope_s)), np.finfo(float).tiny)
    gaps = int(np.count_nonzero(np.diff(number) > 1))
    return float(len(t_s) * np.log(scatter + EVEN) + gaps * np.log(len(t_s))), number


def _with_gaps(t_s: Floats, period_s: float) -> Integers:
    """(n,) grid indices, with a gap at every step after which the least delay of the stamps has grown for good.

    The least delays of AROUND samples before and after the step are compared. A sample that waited is late, but the
    samples after it are less late. After missing samples all stamps are late.
    """
    late = (t_s - t_s[0]) / period_s - np.arange(len(t_s))
    least_to_come = minimum_filter1d(late, AROUND, origin=-(AROUND // 2), mode="nearest")
    missing = np.zeros(len(t_s), np.int64)
    total, after = 0, 0
    for index in np.flatnonzero(np.diff(t_s) > 1.6 * period_s) + 1:  # from 1.6 periods on a sample may be missing
        late[after:index] -= total
        after = int(index)
        least_before = late[max(0, index - AROUND) : index].min()
        missing[index] = max(0, round(least_to_come[index] - total - least_before - SCATTER))
        total += int(missing[index])
    return np.arange(len(t_s)) + np.cumsum(missing)


def _pace_s(t_s: Floats) -> float:
    """Median over the session of the mean period of BLOCK samples, s."""
    block = min(BLOCK, len(t_s) - 1)
    return float(np.median(t_s[block:] - t_s[:-block])) / block


def _counter_of(session: Session) -> Integers | None:
    """Counter of the samples, (n,); None unless every sample has it."""
    return None if session.seq is None or (session.seq < 0).any() else session.seq


def _by_counter(seq: Integers) -> Integers:
    """(n,) grid indices by a counter, unwrapped if it may have wrapped."""
    steps = np.diff(seq)
    if seq.max() < WRAP:
        steps = (steps + WRAP // 2) % WRAP - WRAP // 2
    return np.concatenate([[0], np.cumsum(steps)])
