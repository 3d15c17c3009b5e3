"""Gaps and restarts of a recorded session, by the rule of the filters."""

from collections.abc import Iterator

import numpy as np

from gyrodrift.filters.gaps import longest_step_s
from gyrodrift.session.session import Session
from gyrodrift.values.words import counted

NAMED = 3
"""Most gaps that a line names."""


def gaps_text(session: Session) -> str:
    """Sentence about the gaps of a session on one clock; empty without any."""
    with np.errstate(over="ignore", invalid="ignore"):  # a file may have any times
        steps_s = np.diff(session.t_device_s)
    forward_s = steps_s[(steps_s > 0.0) & np.isfinite(steps_s)]
    if not len(forward_s):
        return ""
    is_gap = steps_s > longest_step_s(float(np.median(forward_s)))
    begins_s, lengths_s = session.t_device_s[:-1][is_gap], steps_s[is_gap]
    parts = [*_gaps(begins_s.tolist(), lengths_s.tolist()), *_restarts(session.restarts_s)]
    if not parts:
        return ""
    return f"{' and '.join(parts)}: yaw is held there, and its uncertainty grows by what the device may have turned"


def _gaps(begins_s: list[float], lengths_s: list[float]) -> Iterator[str]:
    if begins_s:
        count = f"{counted(len(begins_s), 'gap')} without samples"
        named = [f"{length:.3g} s at {begin:.6g} s" for begin, length in zip(begins_s[:NAMED], lengths_s, strict=False)]
        yield f"{count} ({', '.join(named)}{', ...' if len(begins_s) > NAMED else ''})"


def _restarts(restarts_s: tuple[float, ...]) -> Iterator[str]:
    if restarts_s:
        later = f" and {len(restarts_s) - 1} times later" if len(restarts_s) > 1 else ""
        yield f"a gap of unknown length at the restart of its clock at {restarts_s[0]:.6g} s{later}"
