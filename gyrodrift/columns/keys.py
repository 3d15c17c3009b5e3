"""Several senders in one stream: a column that names them, or two clocks that run side by side.

A value or a label that alternates among few while rows are samples is a key, such as a node or the name of a sensor. It
is neither a counter nor a clock.
"""

from collections import Counter, defaultdict
from collections.abc import Sequence
from itertools import pairwise
from statistics import median

from gyrodrift.columns.fields import is_number, is_whole

MOST_KEYS, MOST_NAMED = 16, 100
LEAST_ROWS, LEAST_TIMES = 8, 3
"""Rows, and times that each key occurs, that show a key."""

CHANGES_SHARE = 0.2
"""Share of rows before which a key changes; a state of the device changes seldom."""

LEAST_SHARE = 0.2
"""Share of the rows of the rarest key, times the number of keys."""

PREDICTED, CONTEXT = 0.8, 2
UNEXPLAINED = 0.5
"""Share of numbers that the CONTEXT numbers before must predict, and share of the wrong guesses by the commonest one
alone that may remain. Senders take turns; the last digit of a rate at rest does not."""

COUNTED_FROM = 4
"""More whole numbers than this that count up and wrap are a short counter."""

CHAIN_SHARE = 0.2
LOST_SHARE = 0.02
"""Least share of the rows of a clock, and largest one of the rows that belong to neither clock."""

EVEN, EVEN_SHARE = 3.0, 0.9
"""Steps of a clock are even if this share differs from their median by at most this factor."""

APART = 5.0
"""Distance of the levels of two senders, in their scatter from sample to sample."""


def keys_of(texts: Sequence[str], *, is_named: bool = False) -> tuple[str, ...]:
    """Distinct keys of a column, in their order; empty if the column is none.

    texts
        The fields of the column as they are written, one per row.
    is_named
        Whether a label says that the column names a sender, which may then be rare.
    """
    counts = Counter(texts)
    if is_named and 2 <= len(counts) <= MOST_NAMED and min(counts.values()) >= LEAST_TIMES:
        return tuple(counts)
    if len(texts) < LEAST_ROWS or not 2 <= len(counts) <= MOST_KEYS or min(counts.values()) < LEAST_TIMES:
        return ()
    changes = sum(before != after for before, after in pairwise(texts))
    if changes < CHANGES_SHARE * len(texts) or min(counts.values()) * len(counts) < LEAST_SHARE * len(texts):
        return ()
    if all(map(is_number, counts)):
        is_key = all(map(is_whole, counts)) and _take_turns(texts) and not _counts_up(texts)
        return tuple(counts) if is_key else ()
    return tuple(counts)


def _counts_up(texts: Sequence[str]) -> bool:
    """Whether whole numbers count up and wrap."""
    distinct = sorted({float(text) for text in texts})
    if len(distinct) <= COUNTED_FROM or any(after - before != 1.0 for before, after in pairwise(distinct)):
        return False
    steps = Counter((float(after) - float(before)) % len(distinct) for before, after in pairwise(texts))
    return steps[1.0] >= PREDICTED * (len(texts) - 1)


def _take_turns(texts: Sequence[str]) -> bool:
    """Whether the numbers before a number predict it."""
    followers: defaultdict[tuple[str, ...], Counter[str]] = defaultdict(Counter)
    for end in range(CONTEXT, len(texts)):
        followers[tuple(texts[end - CONTEXT : end])][texts[end]] += 1
    right = sum(max(counts.values()) for counts in followers.values()) / (len(texts) - CONTEXT)
    by_commonest = max(Counter(texts).values()) / len(texts)
    return right >= PREDICTED and 1.0 - right <= UNEXPLAINED * (1.0 - by_commonest)


def has_two_senders(times: Sequence[float], values: Sequence[float] = ()) -> bool:
    """Whether the rows are those of two senders, without a column that names them.

    Either the clock jumps back and forth between two running clocks. Or the steps of the clock alternate, and the
    values of every other row have another level.

    Parameters
    ----------
    times
        Times of the rows, in any unit.
    values
        Rates of the rows; empty if they are unknown.
    """
    return len(times) >= LEAST_ROWS and (_has_two_clocks(times) or _has_two_levels(times, values))


def _has_two_clocks(times: Sequence[float]) -> bool:
    chains: list[list[float]] = [[times[0]]]
    switches, lost, last = 0, 0, 0
    for time in times[1:]:
        before = [index for index, chain in enumerate(chains) if chain[-1] <= time]
        if not before and len(chains) == 2:
            lost += 1
            continue
        if not before:
            chains.append([])
        index = min(before, key=lambda i: time - chains[i][-1]) if before else 1
        chains[index].append(time)
        switches += index != last
        last = index
    return (
        len(chains) == 2
        and lost <= LOST_SHARE * len(times)
        and switches >= CHANGES_SHARE * len(times)
        and all(len(chain) >= CHAIN_SHARE * len(times) and _is_even(chain) for chain in chains)
    )


def _is_even(times: Sequence[float]) -> bool:
    steps = [after - before for before, after in pairwise(times)]
    if not steps:
        return False
    usual = median(steps)
    even = sum(usual / EVEN <= step <= usual * EVEN for step in steps)
    return even >= EVEN_SHARE * len(steps)


def _has_two_levels(times: Sequence[float], values: Sequence[float]) -> bool:
    if len(values) != len(times):
        return False
    steps = [after - before for before, after in pairwise(times)]
    if median(steps[::2]) == median(steps[1::2]):
        return False
    first, second = values[::2], values[1::2]
    scatter = max(median(abs(after - before) for before, after in pairwise(rows)) for rows in (first, second))
    between = median(abs(after - before) for before, after in pairwise(values))
    return between > APART * scatter and abs(median(first) - median(second)) > APART * scatter
