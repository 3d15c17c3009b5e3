"""Stretches of a session in which rates or angles are missing: what lies between them counts as sessions of their own.

A host that was busy for two seconds, a cable that came off, markers that a camera lost: how it moved meanwhile nobody
knows, and a straight line across would be the largest error of all. Single samples that a link loses are no outage.
"""

from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from gyrodrift.arrays import Integers
from gyrodrift.diagnose.recording.checks import LEAST_S
from gyrodrift.diagnose.recording.numbering import numbered
from gyrodrift.session.session import Session

OUTAGE_S, MANY_APART = 0.2, 10.0
"""An outage lasts longer than this, and than so many times the usual distance of what is known: a link that loses every
tenth sample never loses ten in a row, and a reference may be slower than the gyro."""

ENOUGH = 0.5
"""Share of a session that its parts hold at least; where a link fails that often, that is what there is to be seen."""


class Parts(NamedTuple):
    """Sessions without an outage, and what is to be said of that; nothing where it is the session as it was."""

    sessions: tuple[Session, ...]
    remarks: tuple[str, ...] = ()


class _Known(NamedTuple):
    """Samples that have a rate and an angle, of as many as there should be.

    number, place
        Of each: its number among all, and its place in the session, shape (n,).
    samples
        How many there should be.
    """

    number: Integers
    place: Integers
    samples: int
    period_s: float

    def seconds(self, first: int, end: int) -> float:
        """From one of them to before another."""
        return float(self.number[end - 1] - self.number[first] + 1) * self.period_s


def between_outages(session: Session) -> Parts:
    """The parts of a session of LEAST_S and more; the session as it is where it has no outage, or too many.

    Raises
    ------
    DataError
        Where it has fewer than two samples.
    """
    known = _known(session)
    if known is None:
        return Parts((session,))
    gaps = np.diff(known.number, prepend=-1, append=known.samples)
    outages = np.flatnonzero(gaps > max(OUTAGE_S / known.period_s, MANY_APART * float(np.median(gaps))))
    pieces = [(first, end) for first, end in pairwise([0, *outages.tolist(), len(known.number)]) if first < end]
    kept = [piece for piece in pieces if known.seconds(*piece) >= LEAST_S]
    kept_s = sum(known.seconds(*piece) for piece in kept)
    if not len(outages) or kept_s < ENOUGH * known.samples * known.period_s:
        return Parts((session,))
    parts = [session.part(int(known.place[first]), int(known.place[end - 1]) + 1) for first, end in kept]
    missing_s = float((gaps[outages] - 1).sum()) * known.period_s
    too_short_s = sum(known.seconds(*piece) for piece in pieces) - kept_s
    return Parts(_named(parts), (_remark(session.name, missing_s, len(outages), len(parts), too_short_s),))


def _known(session: Session) -> _Known | None:
    """None where they are too few to have a distance."""
    if session.encoder_deg is None:
        return None
    found = numbered(session)
    number, place = found.number, found.place
    is_known = np.isfinite(session.rate_dps[place]) & np.isfinite(session.encoder_deg[place])
    spans_s = float(session.t_device_s[place[-1]] - session.t_device_s[place[0]])
    if np.count_nonzero(is_known) < 2 or not spans_s > 0.0:
        return None
    return _Known(number[is_known], place[is_known], int(number[-1]) + 1, spans_s / int(number[-1]))


def _named(parts: list[Session]) -> tuple[Session, ...]:
    """Each has a name of its own where there are several."""
    if len(parts) == 1:
        return tuple(parts)
    return tuple(replace(part, name=f"{part.name}, part {number}") for number, part in enumerate(parts, 1))


def _remark(name: str, missing_s: float, outages: int, parts: int, too_short_s: float) -> str:
    pieces = "" if outages == 1 else f" in {outages} pieces"
    what = "the rest is one session" if parts == 1 else f"the {parts} parts of the rest are taken as sessions"
    but = f", without {too_short_s:.1f} s in parts of less than {LEAST_S:.0f} s" if too_short_s > 0.0 else ""
    return f"{name}: rates or angles are missing for {missing_s:.1f} s{pieces}; {what}{but}"
