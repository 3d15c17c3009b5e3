"""A session in one row: what is compared at a glance over many of them."""

from dataclasses import dataclass

import numpy as np

from gyrodrift.describe.values import RestSource, SessionDescription
from gyrodrift.describe.yaw import YawHistory, mean_absolute


@dataclass(frozen=True, slots=True)
class SessionRow:
    """Of a session; None where it does not say.

    bias_dps
        Mean rate over all that an encoder says was rest, deg/s.
    raw_error_deg, corrected_error_deg
        Mean absolute yaw error of the plain integral and of the filter, deg.
    """

    name: str
    minutes: float
    rate_hz: float | None
    missing: int
    bias_dps: float | None
    walk_deg_rts: float | None
    raw_error_deg: float | None
    corrected_error_deg: float | None


def row_of(name: str, description: SessionDescription, yaw: YawHistory | None) -> SessionRow:
    """The row of a session."""
    known = yaw if yaw is not None and yaw.has_reference else None
    return SessionRow(
        name=name,
        minutes=description.duration_s / 60.0,
        rate_hz=description.rate_hz,
        missing=description.gaps.missing,
        bias_dps=bias_at_rest(description),
        walk_deg_rts=None if description.allan is None else description.allan.angle_random_walk_deg_rts,
        raw_error_deg=None if known is None else mean_absolute(known.raw_error_deg),
        corrected_error_deg=None if known is None else mean_absolute(known.corrected_error_deg),
    )


def bias_at_rest(description: SessionDescription) -> float | None:
    """Mean rate at rest, long rests counting more, deg/s; None where no encoder says that there was any."""
    stretches = description.stretches if description.still_by is RestSource.ENCODER else ()
    lengths_s = [one.end_s - one.start_s for one in stretches]
    if not sum(lengths_s):
        return None
    return float(np.average([one.mean_dps for one in stretches], weights=lengths_s))
