"""A session in one row of a table."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt

import numpy as np

from gyrodrift.describe.text import Group
from gyrodrift.describe.yaw import YawHistory, last_error, mean_absolute
from gyrodrift.facts.rests import RestSource
from gyrodrift.facts.session_facts import SessionFacts


@dataclass(frozen=True, slots=True)
class YawErrors:
    """Yaw errors of a session against its encoder, deg: mean absolute value, and the last value with its sign."""

    filter_name: str
    raw_mean_deg: float
    corrected_mean_deg: float
    raw_end_deg: float
    corrected_end_deg: float


@dataclass(frozen=True, slots=True)
class SessionRow:
    """A session in one row; None for values that it does not have.

    bias_dps
        Mean rate over all rests that the encoder shows, deg/s.
    walk_deg_rts, instability_dps
        Angle random walk in deg/√s and bias instability in deg/s.
    white_deg_rts
        Angle random walk in deg/√s if the scatter over the longest rest were white noise.
    odd
        Names of the values that deserve a second look.
    """

    name: str
    samples: int
    duration_s: float
    rate_hz: float | None
    gaps: int
    missing: int
    rests: int
    rest_s: float
    bias_dps: float | None
    walk_deg_rts: float | None
    white_deg_rts: float | None
    instability_dps: float | None
    errors: YawErrors | None
    odd: tuple[str, ...]


def row_of(name: str, description: SessionFacts, yaw: YawHistory | None, groups: Sequence[Group] = ()) -> SessionRow:
    """The row of a session; `groups` is its full text."""
    allan = description.allan
    return SessionRow(
        name=name,
        samples=description.samples,
        duration_s=description.duration_s,
        rate_hz=description.rate_hz,
        gaps=description.gaps.count,
        missing=description.gaps.missing,
        rests=len(description.stretches),
        rest_s=sum(rest.end_s - rest.start_s for rest in description.stretches),
        bias_dps=bias_at_rest(description),
        walk_deg_rts=None if allan is None else allan.angle_random_walk_deg_rts,
        white_deg_rts=_white_deg_rts(description),
        instability_dps=None if allan is None else allan.bias_instability_dps,
        errors=_errors(yaw),
        odd=tuple(dict.fromkeys(line.name for group in groups for line in group.lines if line.is_odd)),
    )


def _errors(yaw: YawHistory | None) -> YawErrors | None:
    if yaw is None or not yaw.has_reference:
        return None
    raw_deg, corrected_deg = yaw.raw_error_deg, yaw.corrected_error_deg
    means = (mean_absolute(raw_deg), mean_absolute(corrected_deg))
    return YawErrors(yaw.filter_name, *means, last_error(raw_deg), last_error(corrected_deg))


def _white_deg_rts(description: SessionFacts) -> float | None:
    if not description.stretches or not description.rate_hz:
        return None
    longest = max(description.stretches, key=lambda rest: rest.end_s - rest.start_s)
    return longest.std_dps / sqrt(description.rate_hz)


def bias_at_rest(description: SessionFacts) -> float | None:
    """Mean rate at rest weighted by duration, deg/s; None if no encoder shows a rest."""
    rests = description.stretches if description.still_by is RestSource.ENCODER else ()
    lengths_s = [rest.end_s - rest.start_s for rest in rests]
    if not sum(lengths_s):
        return None
    return float(np.average([rest.mean_dps for rest in rests], weights=lengths_s))
