"""One clock for a recording whose clock restarts, steps or stands still.

A step back by more than a few periods is a restart if the samples continue from there, as in `link.clocks.device`. If
they continue from before the step, one stamp was damaged. If the same samples come again, a link or a logger repeated
them. After a restart the times continue one period later.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from gyrodrift.session.checks.finding import SessionFinding
from gyrodrift.session.session import Session, unwrapped
from gyrodrift.values.arrays import Floats, Mask
from gyrodrift.values.constants import REPEATED_PERIODS

NEXT_PERIODS = 4.0
"""A sample continues a previous one within these periods."""

SET_S, SET_SHARE = 3600.0, 10.0
"""A clock was set if it steps forward by more than an hour and ten times the rest of the recording."""

SET_AGAINST_HOST_S, HOST_SHARE = 60.0, 0.1
"""A clock was also set if it steps by more than a minute while the host clock advances by less than 10 % of it."""

MOST_RESTARTS = 0.05
"""Largest share of samples with restarts; with more the column is no clock."""

REGULAR_RESTARTS, REGULAR_WITHIN = 4, 0.1
"""From this number of restarts on, parts of equal length to this share are no restarts of a device."""

SAME_ROWS = 5
"""This many samples with equal times and rates are a repetition."""

ENCODER_JUMP_DEG = 10.0
"""An encoder that jumps by more at a restart has restarted too."""

LEAST_SAMPLES = 20
"""Least number of samples for a check."""

COARSE_SHARE, SOME_SHARE = 0.45, 0.05
"""Shares of samples with the previous stamp and another rate: too coarse for a clock, and enough for a warning."""


@dataclass(frozen=True, slots=True)
class OneClock:
    """A session whose times go forward, as far as possible."""

    session: Session
    findings: tuple[SessionFinding, ...] = ()


@dataclass(frozen=True, slots=True)
class _Cuts:
    """Rows at which a clock restarts, and rows whose stamp is damaged."""

    restarts: list[int]
    damaged: list[int]


COLUMN = (
    "name the column of the whole time with --columns, or all columns that add up to it (LABEL=t_s, LABEL2=+t_ns), or"
    " state the rate of the samples with --sample-rate HZ"
)
DIGITS = (
    "if another column has the rest of the time, add it (--columns 'LABEL=t_s, LABEL2=+t_ms, ...'); if the samples are"
    " evenly timed, state their rate with --sample-rate HZ; else write their times with all digits"
)


def one_clock(session: Session) -> OneClock:
    """The session on one clock, with the findings."""
    samples = len(session.t_device_s)
    if samples < LEAST_SAMPLES:
        return OneClock(session)
    steps_s = np.diff(session.t_device_s)
    forward_s = steps_s[(steps_s > 0.0) & np.isfinite(steps_s)]
    is_same = (steps_s == 0.0) & (np.diff(session.rate_dps) != 0.0)
    if np.mean(is_same) > COARSE_SHARE or not len(forward_s):
        return _by_host(session, forward_s)
    period_s = float(np.median(forward_s))
    cuts = _cuts(session, period_s)
    if len(cuts.restarts) > MOST_RESTARTS * samples or _is_regular(cuts.restarts):
        says = f"its times restart {len(cuts.restarts)} times in {samples} samples: they are no clock, or a part of one"
        return OneClock(session, (SessionFinding("clock_unit", says, COLUMN, is_error=True),))
    findings = [*_restart_findings(session, cuts)]
    if np.mean(is_same) > SOME_SHARE:
        says = f"{np.count_nonzero(is_same)} of its {samples} samples have the time of the previous sample"
        findings.append(SessionFinding("clock_stamps", f"{says}, and a filter skips them", DIGITS))
    return OneClock(_joined(session, cuts, period_s), tuple(findings))


def _is_regular(restarts: list[int]) -> bool:
    """Whether a clock restarts again and again after the same number of samples, as the part of a second does."""
    lengths = np.diff(restarts)
    return len(restarts) >= REGULAR_RESTARTS and bool(np.ptp(lengths) <= max(1.0, REGULAR_WITHIN * np.median(lengths)))


def _by_host(session: Session, forward_s: Floats) -> OneClock:
    """Use host times instead of stamps that stand still or are too coarse; an error without host times."""
    samples, host_s = len(session.t_device_s), session.t_host_s
    if len(forward_s):
        says = f"its times have steps of {np.median(forward_s):.4g} s, for {samples / (len(forward_s) + 1):.3g} samples"
    elif len(np.unique(session.t_device_s)) == 1:
        says = f"its clock never runs: all {samples} times are {session.t_device_s[0]:g} s"
    else:
        says = f"its {samples} times never go forward"
    if host_s is None or np.mean(np.diff(host_s) > 0.0) < 1.0 - COARSE_SHARE:
        return OneClock(session, (SessionFinding("clock_stamps", says, DIGITS, is_error=True),))
    finding = SessionFinding("clock_stamps", f"{says}; the times of logging are used (t_host_s)")
    return OneClock(session.timed(host_s), (finding,))


def _cuts(session: Session, period_s: float) -> _Cuts:
    t_s = session.t_device_s
    steps_s = np.diff(t_s)
    is_back = steps_s < -REPEATED_PERIODS * period_s
    odd = 1 + np.flatnonzero(is_back | _is_set(session, steps_s))
    cuts = _Cuts([], [])
    for row in odd.tolist():
        before_s = t_s[row - 1 - (row - 1 in cuts.damaged)]
        if row in cuts.damaged or (row - 1 in cuts.damaged and _goes_on(t_s[row] - before_s, period_s)):
            continue
        if row + 1 < len(t_s) and _goes_on(t_s[row + 1] - before_s, period_s):
            cuts.damaged.append(row)
        elif row >= 2 and t_s[row] < t_s[row - 1] and _goes_on(t_s[row] - t_s[row - 2], period_s):
            cuts.damaged.append(row - 1)
        elif not _is_repetition(session, row):
            cuts.restarts.append(row)
    return cuts


def _is_set(session: Session, steps_s: Floats) -> Mask:
    """Mask of forward steps that are longer than any gap in a recording."""
    forward_s = np.where(steps_s > 0.0, steps_s, 0.0)
    rest_s = float(np.nansum(forward_s)) - forward_s
    is_set: Mask = (forward_s > SET_S) & (forward_s > SET_SHARE * rest_s)
    if session.t_host_s is not None:
        is_set |= (forward_s > SET_AGAINST_HOST_S) & (np.diff(session.t_host_s) < HOST_SHARE * forward_s)
    return is_set


def _goes_on(step_s: float, period_s: float) -> bool:
    return bool(0.0 < step_s <= NEXT_PERIODS * period_s)


def _is_repetition(session: Session, row: int) -> bool:
    """Whether the samples from a row on repeat earlier ones, and newer samples follow."""
    t_s, rate_dps = session.t_device_s, session.rate_dps
    count = min(SAME_ROWS, len(t_s) - row)
    newest_s = np.nanmax(t_s[:row])
    for first in np.flatnonzero(t_s[:row] == t_s[row]).tolist():
        is_same = np.array_equal(t_s[first : first + count], t_s[row : row + count])
        if is_same and np.array_equal(rate_dps[first : first + count], rate_dps[row : row + count], equal_nan=True):
            after_s = t_s[row:]
            backward_steps = np.flatnonzero(np.diff(after_s) < 0.0)
            end = int(backward_steps[0]) + 1 if len(backward_steps) else len(after_s)
            return bool(np.nanmax(after_s[:end]) > newest_s)
    return False


def _joined(session: Session, cuts: _Cuts, period_s: float) -> Session:
    """Join the parts: each starts one period after the previous part."""
    if not (cuts.restarts or cuts.damaged):
        return session
    t_s = session.t_device_s.copy()
    encoder_deg = None if session.encoder_deg is None else session.encoder_deg.copy()
    for row in cuts.restarts:
        last = row - 1 - (row - 1 in cuts.damaged)
        t_s[row:] += t_s[last] + period_s - t_s[row]
        if encoder_deg is not None and abs(encoder_deg[row] - encoder_deg[last]) > ENCODER_JUMP_DEG:
            encoder_deg = unwrapped(encoder_deg)
            encoder_deg[row:] += encoder_deg[last] - encoder_deg[row]
    restarts_s = tuple(t_s[cuts.restarts].tolist())
    joined = replace(session.timed(t_s), encoder_deg=encoder_deg, restarts_s=restarts_s)
    return joined.rows(np.delete(np.arange(len(t_s)), cuts.damaged)) if cuts.damaged else joined


def _restart_findings(session: Session, cuts: _Cuts) -> Iterator[SessionFinding]:
    t_s = session.t_device_s
    if cuts.restarts:
        row = cuts.restarts[0]
        count_text = f", the first of {len(cuts.restarts)} times" if len(cuts.restarts) > 1 else ""
        rest_s = _seconds_after(t_s, cuts)
        says = f"its clock restarts at sample {row + 1}{count_text}, from {t_s[row - 1]:.6g} to {t_s[row]:.6g} s"
        yield SessionFinding("restarts", f"{says}; the {rest_s:.4g} s after it continue one period later, as in serve")
    if cuts.damaged:
        row = cuts.damaged[0]
        says = f"{len(cuts.damaged)} of its times are invalid, the first {t_s[row]:.6g} s at sample {row + 1}"
        yield SessionFinding("restarts", f"{says}; these samples are left out")


def _seconds_after(t_s: Floats, cuts: _Cuts) -> float:
    """Duration after the first restart, s."""
    ends = [*cuts.restarts[1:], len(t_s)]
    return float(sum(t_s[end - 1] - t_s[row] for row, end in zip(cuts.restarts, ends, strict=True)))
