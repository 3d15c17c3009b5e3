"""Description of a session as values."""

from math import inf

import numpy as np

from gyrodrift.describe.allan import allan_of
from gyrodrift.describe.arrays import only, smallest_step
from gyrodrift.describe.host import host_clock
from gyrodrift.describe.rest import stationary_by_encoder, stationary_by_rate
from gyrodrift.describe.values import Allan, Encoder, Gaps, Rates, RestSource, SessionDescription, Stretch, Temperatures
from gyrodrift.session.session import Session
from gyrodrift.values.arrays import Floats

NORMAL_MAD = 1.4826
"""Standard deviation of a normal distribution over its median absolute deviation."""

GAP_PERIODS = 1.5
MOST_MISSING = 1e15

BREAK_S = 1.0
BREAK_PERIODS = 10.0
"""A time step longer than both ends a rest."""


def describe(session: Session) -> SessionDescription:
    """Describe a session, whatever its values are; the time is linear in its length."""
    with np.errstate(over="ignore", invalid="ignore"):  # a file may hold numbers of any size
        return _describe(session)


def _describe(session: Session) -> SessionDescription:
    times_s = only(session.t_device_s, np.isfinite(session.t_device_s))
    steps_s = np.diff(times_s)
    forward_s = only(steps_s, (steps_s > 0.0) & (steps_s < inf))
    period_s = float(np.median(forward_s)) if len(forward_s) else None
    rates_dps = only(session.rate_dps, np.isfinite(session.rate_dps))
    stretches, allan = ([], None) if period_s is None else _rest(session, period_s)
    return SessionDescription(
        samples=len(session.t_device_s),
        duration_s=float(forward_s.sum()),
        rate_hz=None if period_s is None else 1.0 / period_s,
        jitter_s=None if period_s is None else NORMAL_MAD * float(np.median(np.abs(forward_s - period_s))),
        gaps=_gaps(session, forward_s, period_s),
        steps_not_forward=len(session.t_device_s) - max(len(times_s), 1) + len(steps_s) - len(forward_s),
        rates_not_finite=len(session.rate_dps) - len(rates_dps),
        host=host_clock(session, period_s),
        temperature=_temperatures(session.temp_c),
        rate=Rates(*map(float, (rates_dps.min(), rates_dps.max(), rates_dps.mean()))) if len(rates_dps) else None,
        encoder=_encoder(session.encoder_deg),
        still_by=RestSource.RATE if session.encoder_deg is None else RestSource.ENCODER,
        stretches=tuple(stretches),
        allan=allan,
    )


def _gaps(session: Session, forward_s: Floats, period_s: float | None) -> Gaps:
    if period_s is None:
        return Gaps(0, 0, 0.0)
    gap_steps_s = forward_s[forward_s > GAP_PERIODS * period_s]
    if session.seq is None:
        missing = int((np.minimum(np.rint(gap_steps_s / period_s), MOST_MISSING) - 1.0).sum())
    else:
        counted = session.seq[session.seq >= 0]
        missing = int(np.maximum(np.diff(counted) - 1, 0).sum())
    return Gaps(len(gap_steps_s), missing, float(gap_steps_s.max(initial=0.0)))


def _temperatures(temp_c: Floats | None) -> Temperatures | None:
    finite_c = np.empty(0) if temp_c is None else temp_c[np.isfinite(temp_c)]
    if not len(finite_c):
        return None
    return Temperatures(*map(float, (finite_c.min(), finite_c.max(), finite_c[0], finite_c[-1])))


def _encoder(encoder_deg: Floats | None) -> Encoder | None:
    finite_deg = np.empty(0) if encoder_deg is None else encoder_deg[np.isfinite(encoder_deg)]
    if not len(finite_deg):
        return None
    return Encoder(float(finite_deg.min()), float(finite_deg.max()), smallest_step(finite_deg))


def _rest(session: Session, period_s: float) -> tuple[list[Stretch], Allan | None]:
    """Rests, and the Allan deviation of the longest one."""
    is_usable = np.isfinite(session.rate_dps) & np.isfinite(session.t_device_s)
    t_s, rate_dps = only(session.t_device_s, is_usable), only(session.rate_dps, is_usable)
    steps_s = np.diff(t_s, prepend=t_s[:1])
    is_break = (steps_s < 0.0) | (steps_s > max(BREAK_S, BREAK_PERIODS * period_s))
    if session.encoder_deg is None:
        runs = stationary_by_rate(rate_dps, is_break, period_s)
    else:
        runs = stationary_by_encoder(only(session.encoder_deg, is_usable), is_break, period_s)
    if not runs:
        return [], None
    first_s = float(session.t_device_s[np.isfinite(session.t_device_s)][0])
    stretches = [_stretch(t_s[start:end] - first_s, rate_dps[start:end]) for start, end in runs]
    longest = max(range(len(runs)), key=lambda i: stretches[i].end_s - stretches[i].start_s)
    return stretches, allan_of(stretches[longest], rate_dps[slice(*runs[longest])])


def _stretch(t_s: Floats, rate_dps: Floats) -> Stretch:
    return Stretch(float(t_s[0]), float(t_s[-1]), float(rate_dps.mean()), float(rate_dps.std()))
