"""Times from a sample rate, columns that are no clock, and rates from the angle of each sample."""

from collections.abc import Sequence
from itertools import accumulate, pairwise

import numpy as np

from gyrodrift.columns.times import PER_S, is_hms
from gyrodrift.values.arrays import Floats, Integers
from gyrodrift.values.constants import DELTA_GAP_PERIODS, DELTA_GAP_S

COUNTERS = (1 << 8, 1 << 16, 1 << 32)
WRAP_PART = 4
"""A counter that goes back has wrapped if it then moved by less than this part of its range."""

LEAST_STEPS, COUNTER_SHARE, ROUNDING = 20, 0.95, 1e-3
"""Least number of steps that show a counter, the share of them that are 1, and their rounding in seconds."""


def paced(samples: int, counts: Sequence[int] | Integers | None, sample_rate_hz: float) -> Floats:
    """Times of samples at a rate, s, shape (n,); with a counter, lost samples take their time.

    A missing count is -1.
    """
    if counts is None or samples < LEAST_STEPS:
        return np.arange(samples) / sample_rate_hz
    filled = list(accumulate(map(int, counts), lambda before, after: after if after >= 0 else before + 1))
    steps = [_counted(after - before) for before, after in pairwise(filled)]
    usual = max(float(np.median(steps)), 1.0)
    return np.array(list(accumulate(steps, initial=0))) / (usual * sample_rate_hz)


def _counted(step: int) -> int:
    """Step of a counter that may wrap; 1 after a restart."""
    if step < 0:
        step = next((step + wrap for wrap in COUNTERS if 0 < step + wrap < wrap // WRAP_PART), 1)
    return max(step, 1)


def clock_problem(t_s: Floats, unit: str, *, is_labeled: bool) -> str:
    """Why numbers are no clock in this unit, and what to state instead; empty if they may be.

    unit
        `s`, `ms`, `us` or `ns`; others are stated for a reason.
    is_labeled
        Whether a label says that they are a clock, and no counter.
    """
    per_s = PER_S.get(f"t_{unit}")
    steps = np.diff(t_s) * (per_s or 0)
    if per_s is None or len(steps) < LEAST_STEPS:
        return ""
    if not is_labeled and np.mean(np.abs(steps - 1.0) < ROUNDING) > COUNTER_SHARE:
        do = f"call it seq and state --sample-rate HZ, or --time-unit {unit} if it does count {unit}"
        return f"steps by 1 in each row, so it is a counter and no clock; {do}"
    if unit in {"s", "ms"} and is_hms(t_s.tolist()):
        form = "HHMMSS" if unit == "s" else "HHMMSSmmm"
        return f"jumps by 40 at each minute, so it is a time of day as {form}; state --time-unit hms"
    return ""


def rates_of_deltas(t_s: Floats, delta_deg: Floats) -> tuple[Integers, Floats]:
    """Indices of the last row of each time, and mean rates in deg/s, for the angles since the previous row.

    The angles of equal times add up. The angle after a gap is that of one sample, so its rate is that over the usual
    period, as in `link.clocks`.
    """
    is_last = np.append(np.diff(t_s) != 0.0, [True])
    rows = np.flatnonzero(is_last & np.isfinite(t_s))
    step_deg = np.diff(np.cumsum(np.nan_to_num(delta_deg))[rows], prepend=0.0)
    counts, step_s = np.diff(rows, prepend=-1), np.diff(t_s[rows], prepend=np.nan)
    is_forward = step_s > 0.0
    period_s = float(np.median(step_s[is_forward] / counts[is_forward])) if is_forward.any() else np.nan
    usual_s = counts * period_s
    is_gap = ~is_forward | (step_s > np.maximum(DELTA_GAP_S, DELTA_GAP_PERIODS * usual_s))
    return rows, step_deg / np.where(is_gap, usual_s, step_s)
