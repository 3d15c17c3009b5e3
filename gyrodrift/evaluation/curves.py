"""Yaw over time, thinned for a picture: what reports draw of a session."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.evaluation.dataset import LoadedSession


@dataclass(frozen=True, slots=True)
class YawCurves:
    """Minutes and reference in deg, shape (m,), and yaw in deg by several methods in their order, shape (k, m)."""

    minutes: Floats
    reference_deg: Floats
    yaw_deg: Floats

    @property
    def errors_deg(self) -> Floats:
        """Yaw less the reference, deg, shape (k, m)."""
        return self.yaw_deg - self.reference_deg


def yaw_curves(loaded: LoadedSession, yaws_deg: Sequence[Floats], points: int) -> YawCurves:
    """At most so many points of yaws over the samples of a session, each of shape (n,)."""
    at = loaded.reference.thinned(points)
    minutes = (loaded.t_s[at] - loaded.t_s[0]) / 60.0
    return YawCurves(minutes, loaded.reference.reference_deg[at], np.array([yaw_deg[at] for yaw_deg in yaws_deg]))
